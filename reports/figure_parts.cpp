#include "reports/figure_parts.hpp"

#include <fmt/format.h>

#include <iterator>
#include <map>
#include <set>

#include "reports/figures.hpp"
#include "vv/curves.hpp"
#include "vv/norms.hpp"

namespace mpm::reports {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr double tame_ratio = 30.0;  // an extreme beyond this times the next tamer one is off the axis

/// The scene a run was asked for; nothing when the verdict does not hold it.
const Scene* scene_of(const vv::CaseVerdict& verdict, const vv::RunVerdict& run) {
  for (const vv::RunRequest& request : verdict.definition.runs)
    if (request.parameters == run.parameters) return &request.scene;
  return nullptr;
}

/// Parameters that vary among the runs and are not already shown by panels, series or refinement.
std::vector<std::string> unshown_parameters(const std::vector<const vv::RunVerdict*>& runs,
                                            const vv::FigureRequest& request) {
  std::vector<std::string> names;
  if (runs.empty()) return names;
  for (const auto& [pointer, first] : runs.front()->parameters) {
    if (pointer == request.panels || pointer == request.series || pointer == request.over) continue;
    const bool varies =
        std::any_of(runs.begin(), runs.end(), [&, p = pointer, f = first](const vv::RunVerdict* run) {
          const vv::Json* value = value_of(run->parameters, p);
          return !value || *value != f;
        });
    if (varies) names.push_back(pointer);
  }
  return names;
}

int look_number(const vv::Json& value, const std::string& label, std::vector<std::string>& seen) {
  if (value == "mpm") return 0;
  if (value == "ugimp") return 1;
  if (value == "cpgimp") return 2;
  const auto found = std::find(seen.begin(), seen.end(), label);
  const auto number = static_cast<int>(found - seen.begin());
  if (found == seen.end()) seen.push_back(label);
  // The first three looks belong to the schemes.
  return number + 3;
}

/// "<i>h</i> = 20 mm" and "<i>h</i> = 10 mm" make "<i>h</i> = 20, 10 mm".
std::string joined(std::string list, std::string next) {
  const std::string symbol = "<i>h</i> = ", unit = " mm";
  if (list.starts_with(symbol) && list.ends_with(unit) && next.starts_with(symbol)) {
    list.resize(list.size() - unit.size());
    next.erase(0, symbol.size());
  }
  return list + ", " + next;
}

}  // namespace

std::string spaced(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '_' || c == '.'; }, ' ');
  return text;
}

std::string capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::optional<double> length_of(const vv::Json& value) {
  if (value.is_number()) return value.get<double>();
  if (!value.is_string()) return std::nullopt;
  const std::string text = value.get<std::string>();
  std::size_t end = 0;
  double number = 0.0;
  try {
    number = std::stod(text, &end);
  } catch (const std::exception&) {
    return std::nullopt;
  }
  while (end < text.size() && text[end] == ' ') ++end;
  const std::string unit = text.substr(end);
  if (unit == "mm") return number * 1e-3;
  if (unit == "cm") return number * 1e-2;
  if (unit == "m") return number;
  return std::nullopt;
}

const vv::Json* value_of(const Parameters& parameters, const std::string& pointer) {
  for (const auto& [name, value] : parameters)
    if (name == pointer) return &value;
  return nullptr;
}

bool selected(const vv::RunVerdict& run, const std::vector<vv::Selector>& where) {
  return std::all_of(where.begin(), where.end(), [&run](const vv::Selector& selector) {
    const vv::Json* value = value_of(run.parameters, selector.parameter);
    return value &&
           std::find(selector.values.begin(), selector.values.end(), *value) != selector.values.end();
  });
}

std::vector<Member> members_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request) {
  std::vector<const vv::RunVerdict*> runs;
  for (const vv::RunVerdict& run : verdict.runs)
    if (selected(run, request.where)) runs.push_back(&run);
  const std::vector<std::string> unshown = unshown_parameters(runs, request);
  std::vector<std::string> seen;
  std::vector<Member> members;
  for (const vv::RunVerdict* run : runs) {
    Member member;
    member.run = run;
    member.scene = scene_of(verdict, *run);
    if (const vv::Json* value = value_of(run->parameters, request.panels))
      member.panel = name_of_parameter(request.panels, *value);
    const vv::Json* series = value_of(run->parameters, request.series);
    if (series) member.series = name_of_parameter(request.series, *series);
    for (const std::string& pointer : unshown)
      if (const vv::Json* value = value_of(run->parameters, pointer))
        member.series += (member.series.empty() ? "" : ", ") + name_of_parameter(pointer, *value);
    if (member.series.empty()) member.series = "simulation";
    member.look = look_number(series && unshown.empty() ? *series : vv::Json(), member.series, seen);
    const vv::Json* over = value_of(run->parameters, request.over);
    if (over) member.over = name_of_parameter(request.over, *over);
    if (member.scene && member.scene->cell_size > 0.0)
      member.cell_size = member.scene->cell_size;
    else if (over)
      member.cell_size = length_of(*over).value_or(nan_value);
    members.push_back(std::move(member));
  }
  return members;
}

std::vector<Member> in_panel(const std::vector<Member>& members, const std::string& panel) {
  std::vector<Member> chosen;
  std::copy_if(members.begin(), members.end(), std::back_inserter(chosen),
               [&panel](const Member& member) { return member.panel == panel; });
  return chosen;
}

const vv::Curve* curve_of(const vv::RunVerdict& run, const std::string& name, const std::string& source) {
  for (const vv::Curve& curve : run.curves)
    if (curve.name == name && curve.source == source) return &curve;
  return nullptr;
}

double metric_of(const vv::RunVerdict& run, const std::string& metric) {
  const auto found = run.metrics.find(metric);
  return found == run.metrics.end() ? nan_value : found->second;
}

std::string place_of_ending(const vv::Record& record) {
  if (!record.failure.empty()) return "";
  return fmt::format(" at step {}, <i>t</i>\u00a0=\u00a0{:.3g}\u00a0s", record.outcome.step,
                     record.outcome.time);
}

std::vector<std::string> notes_on_runs(const std::vector<Member>& members,
                                       const std::function<bool(const Member&)>& missing) {
  struct Note {
    std::string subject, what, where;
  };
  std::vector<Note> notes;
  for (const Member& member : members) {
    const bool completed = member.run->record.completed();
    if (completed && !missing(member)) continue;
    const std::string verb = completed ? " completed" : " did not complete";
    const std::string what =
        completed ? "what is drawn here was not measured" : name_of_ending(member.run->record);
    if (member.over.empty()) {
      notes.push_back(
          {member.series + verb, what + (completed ? "" : place_of_ending(member.run->record)), ""});
      continue;
    }
    // Over a refinement, steps and times differ from run to run and would fill the page.
    const auto same = std::find_if(notes.begin(), notes.end(), [&](const Note& n) {
      return n.subject == member.series + verb && n.what == what;
    });
    if (same == notes.end())
      notes.push_back({member.series + verb, what, member.over});
    else
      same->where = joined(same->where, member.over);
  }
  std::vector<std::string> texts;
  for (const Note& note : notes)
    texts.push_back(note.subject + (note.where.empty() ? "" : " (" + note.where + ")") + ": " + note.what);
  return texts;
}

std::string stamp_of(const vv::CaseVerdict& verdict, const std::vector<Member>& members) {
  if (members.empty()) return escaped("mpmvv · " + verdict.definition.id);
  std::set<std::string> revisions;
  std::string inputs;
  for (const Member& member : members) {
    if (!member.run->record.revision.empty()) revisions.insert(member.run->record.revision);
    inputs += member.run->record.input_hash + "\n";
  }
  std::string revision;
  for (const std::string& name : revisions) revision += (revision.empty() ? "" : ", ") + name.substr(0, 20);
  const std::string input = members.size() == 1
                                ? "input " + members.front().run->record.input_hash
                                : fmt::format("inputs of {} runs {}", members.size(), vv::hash_of(inputs));
  return escaped(fmt::format("mpmvv · {} · run at revision {} · {}", verdict.definition.id,
                             revision.empty() ? "unknown" : revision, input));
}

Extent extent_of(const std::vector<double>& values, double factor) {
  Extent extent;
  for (const double value : values) extent.include(value * factor);
  return extent;
}

Extent tame_extent(std::vector<Extent> extents) {
  extents.erase(std::remove_if(extents.begin(), extents.end(), [](const Extent& e) { return e.empty(); }),
                extents.end());
  std::sort(extents.begin(), extents.end(),
            [](const Extent& a, const Extent& b) { return a.reach() < b.reach(); });
  Extent joined;
  double previous = 0.0;
  for (const Extent& extent : extents) {
    if (previous > 0.0 && extent.reach() > tame_ratio * previous) break;
    joined.include(extent.lower);
    joined.include(extent.upper);
    previous = extent.reach();
  }
  return joined;
}

Quantity shown_unit(const std::string& unit, double reach) {
  if (unit == "Pa") {
    if (reach < 100.0) return {1.0, "Pa"};
    if (reach < 2e7) return {1e-3, "kPa"};
    return reach < 2e10 ? Quantity{1e-6, "MPa"} : Quantity{1e-9, "GPa"};
  }
  if (unit == "m" || unit == "m/s") {
    if (reach < 1e-4) return {1e6, "µ" + unit};
    return reach < 1.0 ? Quantity{1e3, "m" + unit} : Quantity{1.0, unit};
  }
  if (unit == "-") return reach < 1.0 ? Quantity{100.0, "%"} : Quantity{1.0, "–"};
  return {1.0, escaped(unit)};
}

AxisWords words_of_curve(const std::string& name) {
  static const std::map<std::string, AxisWords> known{
      {"pressure", {"pressure", "Pa"}},
      {"settlement", {"settlement", "m"}},
      {"relative_settlement", {"settlement / width", "-"}},
      {"time", {"time <i>t</i>", "s"}},
      {"strain", {"strain <i>ε</i>", "-"}},
      {"position", {"height <i>x</i>", "m"}},
      {"initial_position", {"initial height <i>X</i>", "m"}},
      {"displacement", {"displacement <i>u</i>", "m"}},
      {"velocity", {"velocity <i>v</i>", "m/s"}},
      {"stress", {"stress <i>σ</i>", "Pa"}},
      {"stress_xx", {"stress <i>σ<sub>xx</sub></i>", "Pa"}},
      {"stress_yy", {"stress <i>σ<sub>yy</sub></i>", "Pa"}},
      {"stress_zz", {"stress <i>σ<sub>zz</sub></i>", "Pa"}},
      {"stress_xy", {"shear stress <i>σ<sub>xy</sub></i>", "Pa"}},
      {"q", {"deviatoric stress <i>q</i>", "Pa"}},
      {"p", {"mean stress <i>p</i>", "Pa"}},
  };
  const auto found = known.find(name);
  return found == known.end() ? AxisWords{escaped(spaced(name)), ""} : found->second;
}

const vv::Reading* reading_of(const vv::Case& definition, const std::string& metric) {
  for (const vv::Reading& reading : definition.readings)
    if (metric == vv::reading_prefix + reading.id) return &reading;
  return nullptr;
}

std::string si_unit_of(const std::string& metric, const vv::Case& definition) {
  if (const vv::Reading* reading = reading_of(definition, metric)) return vv::metric_of(*reading).unit;
  for (const vv::Metric& known : vv::metric_catalogue())
    if (known.name == metric) return known.unit;
  return "";
}

Quantity shown_metric(const std::string& metric, const vv::Case& definition, double reach) {
  const std::string unit = si_unit_of(metric, definition), name = name_of_metric(metric, definition);
  if (unit.empty() || unit == "-") return {1.0, name};
  const Quantity shown = shown_unit(unit, reach);
  return {shown.factor, name + " [" + shown.label + "]"};
}

Look line_look(const Member& member) {
  Look look = look_of_series(member.look);
  look.marker = MarkerShape::none;
  if (look.dash.empty()) look.line_width = 2.4;
  return look;
}

int layer_of(const Look& look) { return look.dash.empty() ? 0 : look.dash.size() > 2 ? 1 : 2; }

Look mark_look(MarkerShape shape, double size, const Color& color) {
  Look look;
  look.color = color;
  look.marker = shape;
  look.marker_size = size;
  look.filled = true;
  return look;
}

Look dashed_reference_look(std::size_t number) {
  static const std::vector<std::vector<double>> dashes{{5.0, 2.5}, {1.6, 1.6}, {8.0, 2.0, 1.6, 2.0}};
  Look look;
  const double grey = number % 2 == 0 ? 0.0 : 0.45;
  look.color = {grey, grey, grey, 1.0};
  look.line_width = 1.1;
  look.dash = dashes[number % dashes.size()];
  return look;
}

}  // namespace mpm::reports
