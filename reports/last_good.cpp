#include "reports/last_good.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/field.hpp"
#include "reports/figure_parts.hpp"
#include "reports/figures.hpp"
#include "vv/field_map.hpp"

namespace mpm::reports {
namespace {

constexpr Color ring_color{0.80, 0.0, 0.10, 1.0};
constexpr const char* ring_label = "the particle that the failure was noticed at";

bool has_last_good(const vv::RunVerdict& run) {
  return run.record.last_good && run.record.failure.empty() && !run.record.completed();
}

Look ring_look() {
  Look look;
  look.color = ring_color;
  look.marker = MarkerShape::circle;
  look.marker_size = 9.0;
  return look;
}

/// The number of the particle in its state; nothing if the failure has none.
bool has_particle(const vv::Record& record) {
  return record.outcome.particle >= 0 &&
         record.outcome.particle < static_cast<std::int64_t>(record.last_good->fields.mass.size());
}

Range span_of(const std::vector<double>& place, const std::vector<double>& half) {
  Extent extent;
  for (std::size_t p = 0; p < place.size(); ++p) {
    extent.include(place[p] - half[p]);
    extent.include(place[p] + half[p]);
  }
  return extent.widened(0.02);
}

std::string stamp_of_run(const vv::Record& record) {
  return fmt::format("{}  ·  revision {}  ·  input {}", escaped(record.case_id), escaped(record.revision),
                     escaped(record.input_hash));
}

Picture field_picture(const vv::Record& record) {
  FieldPlot plot;
  FieldPanel panel;
  panel.map = vv::map_of(*record.last_good, "speed");
  const vv::FieldMap& map = *panel.map;
  plot.x = span_of(map.x, map.half_x);
  plot.y = span_of(map.y, map.half_y);
  const Extent speeds = extent_of(map.value);
  const Quantity unit = shown_unit(map.unit, speeds.empty() ? 1.0 : speeds.reach());
  plot.scale.label = "speed [" + unit.label + "]";
  plot.scale.factor = unit.factor;
  plot.scale.range = {0.0, speeds.empty() || speeds.upper <= 0.0 ? 1.0 : speeds.upper * unit.factor};
  if (has_particle(record)) {
    const auto p = static_cast<std::size_t>(record.outcome.particle);
    panel.lines.push_back({ring_label, ring_look(), {map.x[p]}, {map.y[p]}});
  }
  plot.panels.push_back(std::move(panel));
  plot.width = 400.0;
  plot.stamp = stamp_of_run(record);
  return draw(plot);
}

Picture column_picture(const vv::Record& record) {
  const ParticleFields& fields = record.last_good->fields;
  Plot plot;
  Panel panel;
  const Extent height = extent_of(fields.position), speed = extent_of(fields.velocity);
  const Quantity unit = shown_unit("m/s", speed.empty() ? 1.0 : speed.reach());
  panel.x.label = "velocity [" + unit.label + "]";
  panel.y.label = "height [m]";
  panel.y.range = height.widened(0.04);
  panel.x.range = extent_of(fields.velocity, unit.factor).widened(0.06);
  PlotCurve curve{"particles", look_of_series(0), {}, fields.position, 0};
  for (const double velocity : fields.velocity) curve.x.push_back(velocity * unit.factor);
  panel.curves.push_back(curve);
  if (has_particle(record)) {
    const auto p = static_cast<std::size_t>(record.outcome.particle);
    panel.curves.push_back({ring_label, ring_look(), {curve.x[p]}, {curve.y[p]}, 1});
  }
  plot.panels.push_back(std::move(panel));
  plot.width = 340.0;
  plot.stamp = stamp_of_run(record);
  return draw(plot);
}

}  // namespace

FailedRun failed_run_to_draw(const vv::CampaignVerdict& verdict) {
  FailedRun found;
  for (const vv::CaseVerdict& c : verdict.cases) {
    if (c.status == vv::CaseStatus::not_run || !c.definition.classification) continue;
    for (const vv::RunVerdict& run : c.runs) {
      if (!has_last_good(run)) continue;
      if (run.record.last_good->fields.dimension == 2) return {&c, &run};
      if (!found.run) found = {&c, &run};
    }
  }
  return found;
}

Picture last_good_picture(const FailedRun& failed) {
  const vv::Record& record = failed.run->record;
  return record.last_good->fields.dimension == 2 ? field_picture(record) : column_picture(record);
}

std::string last_good_caption(const FailedRun& failed) {
  const vv::Record& record = failed.run->record;
  const std::string run = name_of_run(failed.run->parameters);
  std::string text = fmt::format(
      "{}, {}: the last state seen in which nothing was wrong, at <i>t</i> = {} s. The run ended: {}{}",
      escaped(failed.verdict->definition.title), run, number_markup(record.last_good->time, 3),
      name_of_ending(record), place_of_ending(record));
  if (has_particle(record)) text += fmt::format(", particle {} (ringed)", record.outcome.particle);
  if (std::isfinite(record.outcome.value)) text += ", value " + number_markup(record.outcome.value, 3);
  return text + ".";
}

}  // namespace mpm::reports
