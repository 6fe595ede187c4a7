#include "reports/validation_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "reports/figure_parts.hpp"
#include "reports/figures.hpp"
#include "reports/typography.hpp"
#include "vv/norms.hpp"

namespace mpm::reports {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr double band_opacity = 0.2;
constexpr double lone_width = 400.0;        // of a picture with one column [pt]
constexpr double full_width = 482.0;        // of any other [pt]
constexpr std::size_t many_points = 60;     // of a measured curve: then it has a band in place of bars
constexpr double difference_height = 0.62;  // of the panel below, relative to the one above
constexpr double absence_height = 0.36;     // of a frame in its place
constexpr double abscissa_margin = 0.06;    // of the measured range, on either side
constexpr double near_one = 1.5;            // ratios no farther off have lines of 20 % beside them

const Color uncertainty_color{0.35, 0.35, 0.35, band_opacity};
const Color measured_color{0.1, 0.1, 0.1, 0.14};
const Color between_color{0.45, 0.45, 0.45, 0.16};
const Color absent_color{0.6, 0.6, 0.6, 1.0};

Color translucent(Color color) {
  color.alpha = band_opacity;
  return color;
}

// ---- curve files
// ------------------------------------------------------------------------------------------------

/// "[Bui08, Figure 3]"; of numbers that came by way of others, by whom.
std::string source_of(const vv::CurveFile& file) {
  std::string source = file.citation;
  if (!file.place.empty()) source += (source.empty() ? "" : ", ") + file.place;
  if (!file.by_way_of.empty()) source += " by way of " + file.by_way_of;
  return source.empty() ? "" : "[" + escaped(source) + "]";
}

std::string empty_slot(const vv::CurveFile& file) {
  return "no measurement: slot <i>" + escaped(file.id) + "</i> is empty";
}

/// "kN/m^2" in markup: "kN/m²".
std::string unit_markup(const std::string& unit) {
  std::string markup = unit == "deg" ? "°" : escaped(unit);
  for (const auto& [plain, raised] : {std::pair{"^2", "²"}, {"^3", "³"}})
    if (const std::size_t at = markup.find(plain); at != std::string::npos) markup.replace(at, 2, raised);
  return markup;
}

std::string in_unit(const std::string& words, const std::string& unit) {
  return unit.empty() || unit == "1" ? words : words + " [" + unit_markup(unit) + "]";
}

/// How a column is shown: in the unit of its file, under its own name.
Quantity shown_column(const vv::CurveColumn& column) {
  // A place of a measurement is no height unless its name says so.
  const bool place = column.name.ends_with("position");
  const std::string words = place ? spaced(column.name) : words_of_curve(column.name).words;
  return {1.0 / vv::si_of_unit(column.unit), in_unit(words, column.unit)};
}

/// The words of a column in the middle of a sentence, without a unit.
std::string name_of_column(const vv::CurveColumn& column) { return escaped(spaced(column.name)); }

/// Whose uncertainty the bars of measured points are: "± 2<i>u</i>, reading only".
std::string words_of_uncertainty(const vv::CurveColumn& column) {
  const bool read = column.digitisation.stated(), measured = column.experimental.stated();
  if (read && measured) return " ± 2<i>u</i> of experiment and reading";
  if (read) return " ± 2<i>u</i>, reading only";
  return measured ? " ± 2<i>u</i> of the experiment" : ", uncertainty not stated";
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

/// A frame that says why nothing stands in it.
Panel nothing_panel(const std::string& why) {
  Panel panel;
  panel.absence = why;
  return panel;
}

// ---- comparison
// --------------------------------------------------------------------------------------------------

const vv::CurveComparison* comparison_of(const vv::RunVerdict& run, const std::string& measurement) {
  for (const vv::CurveComparison& comparison : run.comparisons)
    if (comparison.measurement == measurement) return &comparison;
  return nullptr;
}

bool has_points(const vv::CurveComparison* comparison) {
  return comparison && comparison->agreement != vv::Agreement::no_measurement &&
         comparison->agreement != vv::Agreement::not_compared && !comparison->abscissa.empty();
}

/// Twice what a run's own curve is uncertain by.
double twice_own(const vv::CurveComparison& c, std::size_t i) {
  return 2.0 * std::hypot(c.u_numerical.at(i), c.u_input.at(i));
}

/// One measurement and the runs that one pair of panels shows, in the units of the file.
struct Compared {
  const vv::Measurement& measurement;
  std::vector<Member> members;
  std::size_t abscissa;  ///< column
  Quantity x, y;

  const vv::CurveFile& file() const { return *measurement.file; }
  const vv::CurveColumn& ordinate() const { return file().columns.at(measurement.column); }
  const vv::Curve* curve(const Member& m) const { return curve_of(*m.run, measurement.curve, "run"); }
  const vv::CurveComparison* result(const Member& m) const { return comparison_of(*m.run, measurement.id); }
  bool judged(const Member& m) const { return has_points(result(m)); }
  std::vector<Member> judged_members() const {
    std::vector<Member> chosen;
    std::copy_if(members.begin(), members.end(), std::back_inserter(chosen),
                 [this](const Member& m) { return judged(m); });
    return chosen;
  }
};

/// u_D of every row of the file: that of a comparison, which knows the slope, or the ordinate's alone where
/// no run's curve reaches.
std::vector<double> measured_uncertainty(const Compared& compared) {
  const std::vector<double> x = compared.file().column(compared.abscissa);
  const std::vector<double> y = compared.file().column(compared.measurement.column);
  const vv::CurveColumn& column = compared.ordinate();
  std::vector<double> u(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) {
    u[i] = std::hypot(column.digitisation.of(y[i]), column.experimental.of(y[i]));
    for (const Member& member : compared.judged_members()) {
      const vv::CurveComparison& c = *compared.result(member);
      const auto at = std::find(c.abscissa.begin(), c.abscissa.end(), x[i]);
      if (at == c.abscissa.end()) continue;
      u[i] = c.u_measured.at(static_cast<std::size_t>(at - c.abscissa.begin()));
      break;
    }
  }
  return u;
}

PlotCurve measured_points(const Compared& compared) {
  PlotCurve points;
  points.label = "measured" + words_of_uncertainty(compared.ordinate());
  if (compared.file().rows.size() > many_points) points.label += ", shaded";
  const std::string source = source_of(compared.file());
  if (!source.empty()) points.label += " " + source;
  points.x = scaled(compared.file().column(compared.abscissa), compared.x.factor);
  points.y = scaled(compared.file().column(compared.measurement.column), compared.y.factor);
  points.bars = scaled(measured_uncertainty(compared), 2.0 * compared.y.factor);
  points.look.color = ink;
  points.look.marker = MarkerShape::circle;
  points.look.marker_size = points.x.size() > many_points ? 2.0 : 3.4;
  points.look.filled = true;
  points.layer = 5;
  return points;
}

/// What of a curve stands over the range, ends included.
void cut_to(const Range& range, PlotCurve& curve) {
  std::vector<double> x, y;
  const auto add = [&](double px, double py) {
    x.push_back(px);
    y.push_back(py);
  };
  const auto inside = [&range](double v) { return v >= range.lower && v <= range.upper; };
  for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
    const double here = curve.x[i];
    if (i > 0 && inside(here) != inside(curve.x[i - 1])) {
      const double before = curve.x[i - 1];
      const double edge = std::min(here, before) < range.lower ? range.lower : range.upper;
      add(edge, curve.y[i - 1] + (curve.y[i] - curve.y[i - 1]) * (edge - before) / (here - before));
    }
    if (inside(here)) add(here, curve.y[i]);
  }
  curve.x = std::move(x);
  curve.y = std::move(y);
}

/// The measured abscissae with a margin; of an empty slot, those of the runs' curves.
Range abscissa_range(const Compared& compared) {
  std::vector<Extent> extents;
  if (!compared.file().rows.empty())
    extents = {extent_of(compared.file().column(compared.abscissa), compared.x.factor)};
  else
    for (const Member& member : compared.members)
      if (const vv::Curve* curve = compared.curve(member))
        extents.push_back(extent_of(curve->x, compared.x.factor));
  const Extent all = tame_extent(extents);
  Range range = all.widened(abscissa_margin);
  if (!all.empty() && all.lower >= 0.0) range.lower = std::max(range.lower, 0.0);
  return range;
}

/// Holds the tame series with some room. Zero is part of it when it is near.
Range ordinate_range(const std::vector<Extent>& extents) {
  Extent tame = tame_extent(extents);
  if (tame.empty()) return {0.0, 1.0};
  const double span = tame.upper - tame.lower;
  const bool from_zero = tame.lower >= 0.0 && tame.lower < 0.5 * span;
  if (from_zero) tame.include(0.0);
  Range range = tame.widened(0.07);
  if (from_zero) range.lower = 0.0;
  return range;
}

/// The run's curve where it was compared, with twice its own uncertainty; empty if that is nothing.
Band own_band(const Compared& compared, const Member& member) {
  const vv::CurveComparison& c = *compared.result(member);
  Band band{"", translucent(line_look(member).color), scaled(c.abscissa, compared.x.factor), {}, {}};
  double largest = 0.0;
  for (std::size_t i = 0; i < c.abscissa.size(); ++i) {
    const double reach = twice_own(c, i);
    largest = std::max(largest, reach);
    band.lower.push_back((c.simulated.at(i) - reach) * compared.y.factor);
    band.upper.push_back((c.simulated.at(i) + reach) * compared.y.factor);
  }
  return largest > 0.0 ? band : Band{};
}

/// The label of bands: on the only one, or on a grey sample of several in the colours of their runs.
void label_bands(std::vector<Band>& bands, const std::string& label, const std::string& place) {
  if (bands.empty()) return;
  if (bands.size() == 1)
    bands.front().label = label;
  else
    bands.push_back({label + " in its colour, " + place, uncertainty_color, {}, {}, {}});
}

void include_band(Extent& extent, const Band& band) {
  for (const std::vector<double>* side : {&band.lower, &band.upper})
    for (const double value : *side) extent.include(value);
}

/// A run's whole curve over the abscissae shown; pale if others are compared and it is not.
PlotCurve whole_curve(const Compared& compared, const Member& member, const Range& abscissae, bool pale) {
  const vv::Curve& curve = *compared.curve(member);
  Look look = line_look(member);
  if (pale) {
    look.color = tint(look.color, 0.45);
    look.line_width = 0.8;
  }
  PlotCurve line{member.series + (pale ? ", not compared" : ""), look, scaled(curve.x, compared.x.factor),
                 scaled(curve.y, compared.y.factor), layer_of(look)};
  cut_to(abscissae, line);
  return line;
}

/// Puts a band in place of error bars so many that they would hide what lies behind them.
void shade_bars(Panel& panel, PlotCurve& points) {
  Band band{"", measured_color, points.x, {}, {}};
  for (std::size_t i = 0; i < points.y.size(); ++i) {
    band.lower.push_back(points.y[i] - points.bars[i]);
    band.upper.push_back(points.y[i] + points.bars[i]);
  }
  points.bars.clear();
  panel.bands.insert(panel.bands.begin(), std::move(band));
}

/// Of points with the ends of their error bars.
Extent extent_with_bars(const PlotCurve& points) {
  Extent extent;
  for (std::size_t i = 0; i < points.y.size(); ++i) {
    extent.include(points.y[i] - points.bars[i]);
    extent.include(points.y[i] + points.bars[i]);
  }
  return extent;
}

/// The measured points and the runs' curves.
Panel upper_panel(const Compared& compared, const std::string& title) {
  Panel panel;
  panel.title = title;
  panel.x.range = abscissa_range(compared);
  panel.y.label = compared.y.label;
  std::vector<Extent> extents;
  if (!compared.file().rows.empty()) {
    panel.curves = {measured_points(compared)};
    extents = {extent_with_bars(panel.curves.front())};
  }
  const bool some_judged = !compared.judged_members().empty();
  for (const Member& member : compared.members) {
    if (!compared.curve(member)) continue;
    const bool judged = compared.judged(member);
    PlotCurve line = whole_curve(compared, member, panel.x.range, some_judged && !judged);
    Extent& extent = extents.emplace_back(extent_of(line.y));
    panel.curves.push_back(std::move(line));
    if (!judged) continue;
    if (Band band = own_band(compared, member); !band.x.empty()) {
      include_band(extent, band);
      panel.bands.push_back(std::move(band));
    }
  }
  label_bands(panel.bands, "± 2<i>u</i> of a run", "above");
  for (PlotCurve& curve : panel.curves)
    if (curve.bars.size() > many_points) shade_bars(panel, curve);
  panel.y.range = ordinate_range(extents);
  panel.notes = notes_on_runs(compared.members, [&](const Member& m) { return !compared.curve(m); });
  return panel;
}

std::string percent(double share) { return number_markup(100.0 * share, 2) + " %"; }

/// "71 % of points inside 2<i>u</i><sub>val</sub>, <i>C</i> = 0.043, excess 1.9 % of the largest height".
std::string numbers_of(const vv::CurveComparison& c, const Compared& compared) {
  const std::string largest = " of the largest " + name_of_column(compared.ordinate());
  std::string words =
      fmt::format("{:.0f} % of {} points inside 2<i>u</i><sub>val</sub>, <i>C</i> = {}", 100.0 * c.inside,
                  c.abscissa.size(), number_markup(c.distance.comprehensive, 2));
  if (c.excess > 0.0) words += ", excess " + percent(c.excess) + largest;
  words += "; 2<i>u</i><sub>val</sub> is " + percent(c.level) + (c.excess > 0.0 ? " of it" : largest);
  if (c.agreement == vv::Agreement::inconclusive)
    words += ", asked for at most " + percent(compared.measurement.accuracy);
  return words;
}

/// What the panel below says in words: the numbers of every run, or why it has none.
std::vector<std::string> words_below(const Compared& compared) {
  std::vector<std::string> notes;
  const bool several = compared.members.size() > 1;
  for (const Member& member : compared.members) {
    const vv::CurveComparison* c = compared.result(member);
    if (!c || c->agreement == vv::Agreement::no_measurement) continue;
    const std::string words = has_points(c) ? numbers_of(*c, compared) : escaped(c->lack);
    notes.push_back(several ? member.series + ", " + vv::name_of(c->agreement) + ": " + words
                            : capitalised(words));
  }
  if (compared.file().used_for_calibration)
    notes.push_back("The model was adjusted to this measurement: it is no test of it.");
  return notes;
}

/// The verdict that all have in common; of different ones, what the panel shows.
std::string title_below(const Compared& compared) {
  std::set<std::string> verdicts;
  for (const Member& member : compared.judged_members())
    verdicts.insert(vv::name_of(compared.result(member)->agreement));
  return verdicts.size() == 1 ? capitalised(*verdicts.begin()) : "Simulated minus measured";
}

/// Why there is no difference to show.
std::string why_no_difference(const Compared& compared) {
  if (compared.file().missing) return capitalised(empty_slot(compared.file()));
  std::string reasons;
  for (const Member& member : compared.members) {
    const vv::CurveComparison* c = compared.result(member);
    if (!c) continue;
    const std::string who = compared.members.size() > 1 ? member.series + ": " : "Not compared: ";
    const std::string lack = c->lack.empty() ? "no reason is given" : escaped(c->lack);
    reasons += (reasons.empty() ? "" : "\n") + who + lack;
  }
  return reasons.empty() ? "None of these runs is compared with it." : reasons;
}

/// Simulated minus measured of one run.
PlotCurve difference_of(const Compared& compared, const Member& member) {
  const vv::CurveComparison& c = *compared.result(member);
  Look look = look_of_series(member.look);
  look.marker_size = std::max(look.marker_size, 3.0);
  if (c.abscissa.size() > many_points) look.marker = MarkerShape::none;
  PlotCurve line{member.series, look, scaled(c.abscissa, compared.x.factor), {}, 2};
  for (std::size_t i = 0; i < c.abscissa.size(); ++i)
    line.y.push_back((c.simulated.at(i) - c.measured.at(i)) * compared.y.factor);
  return line;
}

/// What it may be without being an error of the model: 2 u_val on either side of zero.
Band validation_band(const Compared& compared, const Member& member, const Color& color) {
  const vv::CurveComparison& c = *compared.result(member);
  const std::vector<double> upper = scaled(c.u_validation, 2.0 * compared.y.factor);
  return {"", color, scaled(c.abscissa, compared.x.factor), scaled(upper, -1.0), upper};
}

/// The frame in which the difference would stand if there were one.
Panel no_difference_panel(const Compared& compared) {
  Panel panel = nothing_panel(why_no_difference(compared));
  panel.hatched = compared.file().missing;
  panel.title = panel.hatched ? "Measured" : "Simulated minus measured";
  panel.height = absence_height;
  return panel;
}

/// The differences of the runs over the abscissae of the panel above.
Panel lower_panel(const Compared& compared, const Range& abscissae) {
  const std::vector<Member> judged = compared.judged_members();
  if (judged.empty()) return no_difference_panel(compared);
  Panel panel;
  panel.height = difference_height;
  panel.title = title_below(compared);
  panel.x = {compared.x.label, Scale::linear, abscissae, {}};
  panel.y.label = in_unit("difference", compared.ordinate().unit);
  Look zero;
  zero.line_width = 0.6;
  panel.curves.push_back({"", zero, {abscissae.lower, abscissae.upper}, {0.0, 0.0}, 0});
  std::vector<Extent> extents;
  for (const Member& member : judged) {
    PlotCurve line = difference_of(compared, member);
    Band band = validation_band(compared, member,
                                judged.size() == 1 ? uncertainty_color : translucent(line.look.color));
    include_band(extents.emplace_back(extent_of(line.y)), band);
    panel.curves.push_back(std::move(line));
    panel.bands.push_back(std::move(band));
  }
  label_bands(panel.bands, "± 2<i>u</i><sub>val</sub> of a run", "below");
  panel.y.range = tame_extent(extents).widened(0.1);
  panel.notes = words_below(compared);
  return panel;
}

/// What the panels of a measurement are called: the file's title where there is room, else the measurement's
/// id.
std::string title_of(const vv::Measurement& measurement, const std::string& panel, bool alone) {
  const double room = alone ? 320.0 : 170.0;  // beside the tag [pt]
  const std::string before = panel.empty() ? "" : panel + ": ";
  const std::string whole = before + escaped(measurement.file->title);
  if (!measurement.file->title.empty() && text_width(whole, title_size) <= room) return whole;
  const std::string brief = escaped(spaced(measurement.id));
  return before + (panel.empty() ? capitalised(brief) : brief);
}

const vv::Measurement* measurement_of(const vv::Case& definition, const std::string& id) {
  for (const vv::Measurement& measurement : definition.measurements)
    if (measurement.id == id && measurement.file) return &measurement;
  return nullptr;
}

/// A label for the legend of a picture so wide; one that does not fit stands in a note, a brief one for it.
std::string fitted(const std::string& label, const std::string& brief, double width,
                   std::vector<std::string>& notes) {
  if (text_width(label) + 36.0 <= width - 2 * outer_margin) return label;
  notes.push_back(capitalised(label));
  return brief;
}

void fit_labels(Plot& plot) {
  for (Panel& panel : plot.panels)
    for (PlotCurve& curve : panel.curves)
      if (curve.label.starts_with("measured"))
        curve.label = fitted(curve.label, "measured", plot.width, panel.notes);
}

// ---- pairs
// ------------------------------------------------------------------------------------------------------

/// The pairs of one unit, and how they are shown.
struct PairGroup {
  std::string unit;
  std::vector<const vv::PairsVerdict*> pairs;
};

const vv::PairedPrediction* prediction_of(const vv::Case& definition, const std::string& id) {
  for (const vv::PairedPrediction& prediction : definition.pairs)
    if (prediction.id == id) return &prediction;
  return nullptr;
}

/// The unit of the measured column of its file; none without a file.
std::string unit_of(const vv::Case& definition, const vv::PairsVerdict& pairs) {
  const vv::PairedPrediction* prediction = prediction_of(definition, pairs.id);
  const bool known = prediction && prediction->file && prediction->column < prediction->file->columns.size();
  return known ? prediction->file->columns[prediction->column].unit : "1";
}

std::vector<PairGroup> groups_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request) {
  std::vector<PairGroup> groups;
  for (const std::string& id : request.pairs)
    for (const vv::PairsVerdict& pairs : verdict.pairs) {
      if (pairs.id != id) continue;
      const std::string unit = unit_of(verdict.definition, pairs);
      auto group =
          std::find_if(groups.begin(), groups.end(), [&unit](const PairGroup& g) { return g.unit == unit; });
      if (group == groups.end()) group = groups.insert(groups.end(), {unit, {}});
      group->pairs.push_back(&pairs);
    }
  return groups;
}

/// What is measured: the name of the column if all pairs have one in common.
std::string subject_of(const vv::Case& definition, const PairGroup& group) {
  std::set<std::string> names;
  for (const vv::PairsVerdict* pairs : group.pairs) {
    const vv::PairedPrediction* prediction = prediction_of(definition, pairs->id);
    const bool known =
        prediction && prediction->file && prediction->column < prediction->file->columns.size();
    names.insert(known ? name_of_column(prediction->file->columns[prediction->column]) : "");
  }
  return names.size() == 1 ? *names.begin() : "";
}

bool positive(const vv::Pair& pair) {
  return pair.measured > 0.0 && pair.predicted > 0.0 && std::isfinite(pair.measured) &&
         std::isfinite(pair.predicted);
}

/// "exact factors: bias 0.43 (0.40–0.46), scatter 0.12, 18 tests".
std::string label_of(const vv::PairsVerdict& pairs) {
  const std::string title = escaped(pairs.title.empty() ? spaced(pairs.id) : pairs.title);
  if (!pairs.lack.empty()) return title + ": " + escaped(pairs.lack);
  const vv::ModelFactor& f = pairs.factor;
  return fmt::format("{}: bias {:.2f} ({:.2f}–{:.2f}), scatter {:.2f}, {} tests", title, f.bias, f.bias_low,
                     f.bias_high, f.scatter, pairs.pairs.size());
}

std::string brief_label_of(const vv::PairsVerdict& pairs) {
  return escaped(pairs.title.empty() ? spaced(pairs.id) : pairs.title);
}

/// The extent with room on either side, on a logarithmic axis whose ends have at least this ratio.
Range logarithmic_room(const Extent& extent, double least_ratio) {
  if (extent.empty()) return {0.1, 10.0};
  const double middle = std::sqrt(extent.lower * extent.upper);
  const double half = std::max(std::sqrt(extent.upper / extent.lower) * 1.25, std::sqrt(least_ratio));
  return {middle / half, middle * half};
}

/// Labels without powers of ten, where the numbers are neither large nor small.
void label_plainly(Axis& axis) {
  if (axis.scale != Scale::logarithmic || axis.range.lower < 1e-3 || axis.range.upper > 2e4) return;
  for (const double value : logarithmic_ticks(axis.range).major)
    axis.ticks.emplace_back(value, fmt::format("{:g}", value));
}

/// A ratio of predicted to measured that has a line.
struct Guide {
  double ratio;
  std::string legend;
  Stroke stroke;
};

std::vector<Guide> guides_of(const Extent& ratios) {
  const bool near = ratios.empty() || (ratios.upper <= near_one && ratios.lower >= 1.0 / near_one);
  const Stroke beside{muted, 0.8, {4.0, 2.5}};
  std::vector<Guide> guides{{1.0, "predicted = measured", {ink, 1.0, {}}}};
  if (near)
    guides.insert(guides.end(), {{1.2, "± 20 %", beside}, {0.8, "± 20 %", beside}});
  else
    guides.insert(guides.end(), {{2.0, "factor of 2", beside}, {0.5, "factor of 2", beside}});
  return guides;
}

Look pair_look(std::size_t number) {
  Look look = look_of_series(static_cast<int>(number));
  look.line_width = 0.0;
  look.marker_size = std::max(look.marker_size, 4.2);
  return look;
}

/// What a group says below its first panel.
std::vector<std::string> notes_on_pairs(const vv::Case& definition, const PairGroup& group) {
  std::vector<std::string> notes;
  bool any = false;
  for (const vv::PairsVerdict* pairs : group.pairs) {
    const std::string title = brief_label_of(*pairs);
    any = any || (pairs->lack.empty() && !pairs->missing);
    const vv::PairedPrediction* prediction = prediction_of(definition, pairs->id);
    if (pairs->missing && prediction && prediction->file)
      notes.push_back(capitalised(title) + ": " + empty_slot(*prediction->file));
    std::string unpredicted;
    for (const std::string& name : pairs->unpredicted)
      unpredicted += (unpredicted.empty() ? "" : "; ") + escaped(name);
    if (!unpredicted.empty()) notes.push_back("Not predicted, " + title + ": " + unpredicted);
    const auto undrawn = std::count_if(pairs->pairs.begin(), pairs->pairs.end(),
                                       [](const vv::Pair& pair) { return !positive(pair); });
    if (undrawn > 0) notes.push_back(fmt::format("Not positive and not drawn, {}: {}", title, undrawn));
  }
  if (any)
    notes.push_back(
        "Bias: geometric mean of predicted / measured, in brackets its 95 % confidence interval. Scatter: "
        "standard deviation of the logarithms.");
  return notes;
}

/// The two panels of a group, and how far their values reach.
struct PairPanels {
  Panel both, ratio;
  Extent measured, predicted, ratios;
};

const Stroke bias_stroke{muted, 1.0, {1.5, 1.5}};

Look line_of(const Stroke& stroke) {
  Look look;
  look.color = stroke.color;
  look.line_width = stroke.width;
  look.dash = stroke.dash;
  return look;
}

void add_marks(PairPanels& panels, const vv::PairsVerdict& pairs, PlotCurve marks, double factor) {
  PlotCurve ratios = marks;
  for (const vv::Pair& pair : pairs.pairs) {
    if (!positive(pair)) continue;
    marks.x.push_back(pair.measured * factor);
    marks.y.push_back(pair.predicted * factor);
    ratios.x.push_back(marks.x.back());
    ratios.y.push_back(pair.predicted / pair.measured);
    panels.measured.include(marks.x.back());
    panels.predicted.include(marks.y.back());
    panels.ratios.include(ratios.y.back());
  }
  if (pairs.lack.empty()) {
    panels.ratio.curves.push_back({"bias", line_of(bias_stroke), {}, {}, 0});
    panels.ratio.levels.push_back(
        {pairs.factor.bias, "", "", {marks.look.color, bias_stroke.width, bias_stroke.dash}});
  }
  panels.both.curves.push_back(std::move(marks));
  panels.ratio.curves.push_back(std::move(ratios));
}

void set_pair_axes(PairPanels& panels, const std::string& subject, const std::string& unit) {
  Panel &both = panels.both, &ratio = panels.ratio;
  const std::string of = subject.empty() ? "" : " " + subject;
  Extent common = panels.measured;
  common.include(panels.predicted.lower);
  common.include(panels.predicted.upper);
  const Range range = logarithmic_room(common, 8.0);
  both.title = "Predicted beside measured";
  both.x = {in_unit("measured" + of, unit), Scale::logarithmic, range, {}};
  both.y = {in_unit("predicted" + of, unit), Scale::logarithmic, range, {}};
  ratio.title = "The ratio of both";
  ratio.x = {both.x.label, Scale::logarithmic, logarithmic_room(panels.measured, 8.0), {}};
  ratio.y = {"predicted / measured", Scale::logarithmic, {}, {}};
}

/// Lines of equal ratios; the axis of ratios grows to hold them.
void add_guides(PairPanels& panels) {
  const Range range = panels.both.x.range;
  for (const Guide& guide : guides_of(panels.ratios)) {
    // Between the places where it enters and leaves the frame.
    const double lower = std::max(range.lower, range.lower / guide.ratio),
                 upper = std::min(range.upper, range.upper / guide.ratio);
    panels.both.curves.push_back(
        {guide.legend, line_of(guide.stroke), {lower, upper}, {lower * guide.ratio, upper * guide.ratio}, 0});
    panels.ratio.levels.push_back({guide.ratio, "", guide.legend, guide.stroke});
    panels.ratios.include(guide.ratio);
  }
  panels.ratio.y.range = logarithmic_room(panels.ratios, 1.0);
}

/// Guides that are no round ratio have their own ticks.
void label_guides(Panel& ratio) {
  for (const LevelLine& level : ratio.levels) {
    const auto same = [&level](const auto& tick) { return tick.first == level.value; };
    if (level.legend.empty() || std::any_of(ratio.y.ticks.begin(), ratio.y.ticks.end(), same)) continue;
    ratio.y.ticks.emplace_back(level.value, fmt::format("{:g}", level.value));
  }
}

/// The frame of a group in which nothing is predicted: the first of its notes, and the others below it.
Panel unpredicted_panel(const PairGroup& group, std::vector<std::string> notes) {
  if (notes.empty()) notes = {"Nothing was predicted."};
  Panel panel = nothing_panel(notes.front());
  panel.hatched = std::all_of(group.pairs.begin(), group.pairs.end(),
                              [](const vv::PairsVerdict* pairs) { return pairs->missing; });
  panel.notes.assign(notes.begin() + 1, notes.end());
  return panel;
}

/// Predicted against measured, and the ratio of both.
std::vector<Panel> pair_panels(const vv::Case& definition, const PairGroup& group, double width) {
  PairPanels panels;
  std::vector<std::string> notes = notes_on_pairs(definition, group);
  for (std::size_t k = 0; k < group.pairs.size(); ++k) {
    const vv::PairsVerdict& pairs = *group.pairs[k];
    if (pairs.missing) continue;
    const std::string label = fitted(label_of(pairs), brief_label_of(pairs), width, notes);
    add_marks(panels, pairs, {label, pair_look(k), {}, {}, 3}, 1.0 / vv::si_of_unit(group.unit));
  }
  if (panels.measured.empty()) return {unpredicted_panel(group, std::move(notes))};
  panels.both.notes = std::move(notes);
  set_pair_axes(panels, subject_of(definition, group), group.unit);
  add_guides(panels);
  for (Panel* panel : {&panels.both, &panels.ratio}) {
    label_plainly(panel->x);
    label_plainly(panel->y);
  }
  label_guides(panels.ratio);
  return {panels.both, panels.ratio};
}

// ---- trend
// ------------------------------------------------------------------------------------------------------

/// A published curve and its columns for the two metrics of a panel.
struct Published {
  const vv::CurveFile* file = nullptr;
  std::size_t x = 0, y = 0;
};

std::vector<Published> published_beside(const vv::FigureRequest& request, std::size_t metric) {
  std::vector<Published> curves;
  for (const auto& file : request.published) {
    if (!file) continue;
    const std::size_t x = file->abscissa.value_or(0);
    if (x + 1 + metric < file->columns.size()) curves.push_back({file.get(), x, x + 1 + metric});
  }
  return curves;
}

/// The ordinate of a line at an abscissa, on the axes it is drawn on; NaN beyond its ends.
double on_line(const PlotCurve& line, double x, bool logarithmic) {
  for (std::size_t i = 0; i + 1 < line.x.size(); ++i) {
    const double a = line.x[i], b = line.x[i + 1];
    if (x < a || x > b) continue;
    if (x == a) return line.y[i];
    if (x == b) return line.y[i + 1];
    const double part = logarithmic ? std::log(x / a) / std::log(b / a) : (x - a) / (b - a);
    return logarithmic ? line.y[i] * std::pow(line.y[i + 1] / line.y[i], part)
                       : line.y[i] + part * (line.y[i + 1] - line.y[i]);
  }
  return nan_value;
}

/// Between the lowest and the highest of the lines, wherever at least two are defined.
Band between(const std::vector<PlotCurve>& lines, bool logarithmic) {
  Band band{"between the published curves", between_color, {}, {}, {}};
  std::set<double> places;
  for (const PlotCurve& line : lines) places.insert(line.x.begin(), line.x.end());
  for (const double x : places) {
    Extent extent;
    int defined = 0;
    for (const PlotCurve& line : lines) {
      const double y = on_line(line, x, logarithmic);
      defined += std::isfinite(y);
      extent.include(y);
    }
    band.x.push_back(x);
    band.lower.push_back(defined > 1 ? extent.lower : nan_value);
    band.upper.push_back(defined > 1 ? extent.upper : nan_value);
  }
  return band;
}

/// Published curves as lines; those that are no formula have their points on them.
std::vector<PlotCurve> published_lines(const std::vector<Published>& published, double x_factor,
                                       double y_factor, double width, std::vector<std::string>& notes) {
  std::vector<PlotCurve> lines;
  for (std::size_t k = 0; k < published.size(); ++k) {
    const vv::CurveFile& file = *published[k].file;
    if (file.rows.empty()) {
      notes.push_back(capitalised(empty_slot(file)));
      continue;
    }
    Look look = dashed_reference_look(k);
    if (file.origin != "formula") {
      look.marker = MarkerShape::square;
      look.marker_size = 2.6;
    }
    const std::string title = escaped(file.title.empty() ? spaced(file.id) : file.title),
                      source = source_of(file);
    const std::string brief = escaped(file.citation.empty() ? spaced(file.id) : file.citation);
    lines.push_back(
        {fitted(source.empty() ? title : title + " " + source, brief, width, notes), look,
         scaled(file.column(published[k].x), x_factor), scaled(file.column(published[k].y), y_factor), 1});
  }
  return lines;
}

/// A metric on one axis of a trend.
struct TrendAxis {
  std::string metric;
  Quantity shown;
};

/// The metric in the unit of the column beside it, if there is one.
TrendAxis trend_axis(const std::string& metric, const std::vector<Member>& members,
                     const vv::Case& definition, const std::vector<Published>& published,
                     std::size_t Published::*column) {
  if (!published.empty()) {
    const std::string& unit = published.front().file->columns[published.front().*column].unit;
    return {metric, {1.0 / vv::si_of_unit(unit), in_unit(name_of_metric(metric, definition), unit)}};
  }
  Extent reach;
  for (const Member& member : members) reach.include(metric_of(*member.run, metric));
  return {metric, shown_metric(metric, definition, reach.empty() ? 0.0 : reach.reach())};
}

/// The runs of one series; without points if none has both metrics.
PlotCurve trend_marks(const std::vector<Member>& members, const std::string& series, const TrendAxis& x,
                      const TrendAxis& y) {
  PlotCurve marks{series, {}, {}, {}, 3};
  for (const Member& member : members) {
    const double px = metric_of(*member.run, x.metric), py = metric_of(*member.run, y.metric);
    if (member.series != series || !std::isfinite(px) || !std::isfinite(py)) continue;
    marks.look = look_of_series(member.look);
    marks.x.push_back(px * x.shown.factor);
    marks.y.push_back(py * y.shown.factor);
  }
  marks.look.line_width = 0.0;
  marks.look.marker_size = std::max(marks.look.marker_size, 4.4);
  return marks;
}

/// Logarithmic axes if all the panel's curves are above zero.
void set_trend_ranges(Panel& panel) {
  Extent xs, ys;
  for (const PlotCurve& curve : panel.curves) {
    for (const double value : curve.x) xs.include(value);
    for (const double value : curve.y) ys.include(value);
  }
  const bool logarithmic = !xs.empty() && xs.lower > 0.0 && ys.lower > 0.0;
  for (const auto& [axis, extent] : {std::pair{&panel.x, xs}, {&panel.y, ys}}) {
    axis->scale = logarithmic ? Scale::logarithmic : Scale::linear;
    axis->range = logarithmic ? logarithmic_room(extent, 4.0) : extent.widened(0.08);
    label_plainly(*axis);
  }
}

Panel trend_panel(const std::vector<Member>& members, const vv::CaseVerdict& verdict,
                  const vv::FigureRequest& request, std::size_t number, double width) {
  const std::vector<Published> published = published_beside(request, number);
  const TrendAxis x = trend_axis(request.abscissa, members, verdict.definition, published, &Published::x),
                  y = trend_axis(request.metrics[number], members, verdict.definition, published,
                                 &Published::y);
  Panel panel;
  panel.x.label = x.shown.label;
  panel.y.label = y.shown.label;
  const std::vector<PlotCurve> lines =
      published_lines(published, x.shown.factor, y.shown.factor, width, panel.notes);
  panel.curves = lines;
  for (const std::string& series : distinct(members, [](const Member& m) { return m.series; }))
    if (PlotCurve marks = trend_marks(members, series, x, y); !marks.x.empty())
      panel.curves.push_back(std::move(marks));
  set_trend_ranges(panel);
  if (lines.size() > 1) panel.bands = {between(lines, panel.x.scale == Scale::logarithmic)};
  for (std::string& note : notes_on_runs(members, [&](const Member& m) {
         return !std::isfinite(metric_of(*m.run, x.metric) + metric_of(*m.run, y.metric));
       }))
    panel.notes.push_back(std::move(note));
  return panel;
}

// ---- measured curves on fields
// -----------------------------------------------------------------------------------

bool is_of_places(const vv::CurveFile& file, std::size_t x, std::size_t y) {
  return file.columns.at(x).dimension == "length" && file.columns.at(y).dimension == "length";
}

/// The moment at which a measured curve belongs: that of a cut's snapshot, else the last shown.
std::string moment_of_measurement(const vv::Case& definition, const vv::Measurement& measurement,
                                  const std::vector<std::string>& moments) {
  for (const vv::Cut& cut : definition.cuts)
    if (cut.id == measurement.curve && cut.snapshot >= 0 &&
        static_cast<std::size_t>(cut.snapshot) < definition.snapshots.size())
      return vv::moment_of(definition.snapshots[static_cast<std::size_t>(cut.snapshot)]);
  return moments.empty() ? "" : moments.back();
}

/// Black and white can be told from every colour of the field; marks tell the curves apart.
Look measured_look(std::size_t number) {
  static constexpr MarkerShape shapes[] = {MarkerShape::circle, MarkerShape::square, MarkerShape::triangle,
                                           MarkerShape::diamond};
  static const std::vector<std::vector<double>> dashes{{}, {5.0, 2.0}, {1.6, 1.6}, {7.0, 2.0, 1.6, 2.0}};
  Look look;
  look.color = black;
  look.line_width = 1.1;
  look.dash = dashes[number % dashes.size()];
  look.marker = shapes[number % std::size(shapes)];
  look.marker_size = 3.8;
  return look;
}

}  // namespace

Plot comparison_plot_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request) {
  Plot plot;
  const std::vector<Member> members = members_of(verdict, request);
  const std::vector<std::string> panels = distinct(members, [](const Member& m) { return m.panel; });
  const bool alone = request.measurements.size() * panels.size() <= 1;
  plot.stack = 2;
  plot.columns = alone ? 1 : 2;
  plot.width = alone ? lone_width : full_width;
  plot.frame_aspect = alone ? 0.55 : 0.75;
  plot.stamp = stamp_of(verdict, members);
  for (const std::string& id : request.measurements) {
    const vv::Measurement* measurement = measurement_of(verdict.definition, id);
    if (!measurement) continue;
    const vv::CurveFile& file = *measurement->file;
    const std::size_t abscissa = file.abscissa.value_or(0);
    for (const std::string& name : panels) {
      const Compared compared{*measurement, in_panel(members, name), abscissa,
                              shown_column(file.columns.at(abscissa)),
                              shown_column(file.columns.at(measurement->column))};
      Panel above = upper_panel(compared, title_of(*measurement, name, alone));
      Panel below = lower_panel(compared, above.x.range);
      if (!below.absence.empty()) above.x.label = compared.x.label;
      plot.panels.push_back(std::move(above));
      plot.panels.push_back(std::move(below));
    }
  }
  if (plot.panels.empty()) {
    plot.stack = 1;
    plot.panels = {nothing_panel(members.empty() ? "No run was selected for this figure."
                                                 : "No measurement was chosen for this figure.")};
  }
  fit_labels(plot);
  return plot;
}

Plot pairs_plot_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request) {
  Plot plot;
  plot.frame_aspect = 0.95;
  for (const PairGroup& group : groups_of(verdict, request))
    for (Panel& panel : pair_panels(verdict.definition, group, full_width))
      plot.panels.push_back(std::move(panel));
  if (plot.panels.empty()) plot.panels = {nothing_panel("There are no predictions for this figure.")};
  plot.columns = plot.panels.size() > 1 ? 2 : 1;
  if (plot.columns == 1) plot.frame_aspect = 0.3;
  plot.stamp = stamp_of(verdict, members_of(verdict, request));
  return plot;
}

Plot trend_plot_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request) {
  Plot plot;
  const std::vector<Member> members = members_of(verdict, request);
  const std::vector<std::string> panels = distinct(members, [](const Member& m) { return m.panel; });
  const bool alone = panels.size() * request.metrics.size() <= 1;
  plot.columns = alone ? 1 : 2;
  plot.width = alone ? lone_width : full_width;
  plot.frame_aspect = alone ? 0.7 : 0.9;
  plot.stamp = stamp_of(verdict, members);
  for (const std::string& name : panels)
    for (std::size_t k = 0; k < request.metrics.size(); ++k) {
      plot.panels.push_back(trend_panel(in_panel(members, name), verdict, request, k, plot.width));
      plot.panels.back().title = name;
    }
  if (plot.panels.empty()) plot.panels = {nothing_panel("No run was selected for this figure.")};
  return plot;
}

void add_measured_lines(FieldPlot& plot, const vv::CaseVerdict& verdict, const vv::FigureRequest& request,
                        const std::vector<const vv::RunVerdict*>& runs,
                        const std::vector<std::string>& moments) {
  Extent x{plot.x.lower, plot.x.upper}, y{plot.y.lower, plot.y.upper};
  for (std::size_t k = 0; k < request.measurements.size(); ++k) {
    const vv::Measurement* measurement = measurement_of(verdict.definition, request.measurements[k]);
    if (!measurement) continue;
    const vv::CurveFile& file = *measurement->file;
    const std::size_t abscissa = file.abscissa.value_or(0);
    const std::string title = escaped(file.title.empty() ? spaced(file.id) : file.title),
                      source = source_of(file);
    FieldLine line{
        "measured " + spaced(measurement->curve) + ": " + (source.empty() ? title : title + " " + source),
        measured_look(k),
        {},
        {}};
    const bool drawable = is_of_places(file, abscissa, measurement->column);
    if (file.rows.empty() || !drawable) {
      line.label = drawable ? capitalised(empty_slot(file)) : title + ": no curve of places, not drawn";
      line.look.color = absent_color;
      line.look.marker = MarkerShape::none;
      line.look.dash = {2.0, 4.0};
      plot.absent_lines.push_back(std::move(line));
      continue;
    }
    line.x = file.column(abscissa);
    line.y = file.column(measurement->column);
    for (const double value : line.x) x.include(value);
    for (const double value : line.y) y.include(value);
    const std::string moment = moment_of_measurement(verdict.definition, *measurement, moments);
    for (std::size_t r = 0; r < runs.size(); ++r)
      for (std::size_t m = 0; m < moments.size(); ++m)
        if (moments[m] == moment && selected(*runs[r], measurement->where))
          plot.panels.at(r * moments.size() + m).lines.push_back(line);
  }
  if (request.view) return;
  plot.x = {x.lower, x.upper};
  plot.y = {y.lower, y.upper};
}

}  // namespace mpm::reports
