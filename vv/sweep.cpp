#include "vv/sweep.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

namespace mpm::vv {
namespace {

/// Which value each axis of the sweep takes in a run.
using Choice = std::vector<std::size_t>;

/// More runs than this would be a slip, and would take days to simulate.
constexpr double most_runs = 1e5;

/// Whether `pointer` is `parent` itself or lies below it.
bool at_or_below(const std::string& pointer, const std::string& parent) {
  return pointer.starts_with(parent) && (pointer.size() == parent.size() || pointer[parent.size()] == '/');
}

/// A JSON pointer to something in the subject as written, relative to the subject.
Json::json_pointer below(const Subject& subject, const std::string& parameter) {
  return Json::json_pointer(parameter.substr(subject.pointer.size()));
}

bool names_value(const std::string& parameter, const Subject& subject) {
  if (!parameter.starts_with(subject.pointer + "/")) return false;
  try {
    return subject.text.contains(below(subject, parameter));
  } catch (const Json::exception&) {  // not a JSON pointer
    return false;
  }
}

/// Refuses a `parameter` that the subject does not have or that one of the `taken` changes too. `found`
/// describes it.
void require_own_value(const std::string& pointer, const std::string& parameter, const std::string& found,
                       const Subject& subject, const std::vector<std::string>& taken) {
  if (!names_value(parameter, subject)) {
    throw Refusal(pointer,
                  subject.is_element()
                      ? "a JSON pointer to a value the element test has, such as \"/element/path\""
                      : "a JSON pointer to a value the scene has, such as \"/scene/scheme\"",
                  found);
  }
  for (const std::string& other : taken) {
    if (at_or_below(parameter, other) || at_or_below(other, parameter)) {
      throw Refusal(pointer, "a parameter that no other axis changes",
                    found + ", which " + other + " changes too");
    }
  }
}

std::vector<Json> read_distinct_values(const JsonPlace& place) {
  std::vector<Json> values;
  for (const JsonPlace& value : place.some_elements()) {
    if (std::find(values.begin(), values.end(), value.value()) != values.end()) {
      value.refuse("each value once", " again");
    }
    values.push_back(value.value());
  }
  return values;
}

std::vector<Json> read_followers(const JsonPlace& place, std::size_t count) {
  std::vector<Json> values;
  for (const JsonPlace& value : place.some_elements()) values.push_back(value.value());
  if (values.size() != count) {
    place.refuse("an array of " + std::to_string(count) + ", one value for each of the axis's values");
  }
  return values;
}

/// Reads an axis; `taken` are the parameters that are changed so far, to which its own are added.
SweepAxis read_sweep_axis(const JsonPlace& place, const Subject& subject, std::vector<std::string>& taken) {
  place.allow_only({"parameter", "with", "values"});
  SweepAxis axis;
  axis.parameter = place["parameter"].text();
  require_own_value(place["parameter"].pointer(), axis.parameter, describe(place["parameter"].value()),
                    subject, taken);
  taken.push_back(axis.parameter);
  axis.values = read_distinct_values(place["values"]);
  if (!place["with"].present()) return axis;
  for (const auto& [parameter, values] : place["with"].members()) {
    require_own_value(values.pointer(), parameter, describe(Json(parameter)), subject, taken);
    taken.push_back(parameter);
    axis.with.push_back({parameter, read_followers(values, axis.values.size())});
  }
  if (axis.with.empty()) place["with"].refuse("an object with at least one parameter");
  return axis;
}

const Json& chosen_value(const std::vector<SweepAxis>& sweep, const Choice& choice, std::size_t axis) {
  return sweep[axis].values[choice[axis]];
}

std::string axis_pointer(std::size_t axis) { return "/sweep/" + std::to_string(axis); }

std::string chosen_pointer(const Choice& choice, std::size_t axis) {
  return axis_pointer(axis) + "/values/" + std::to_string(choice[axis]);
}

/// Puts the value with index `chosen` of an axis into the subject, and what follows along.
void put(const SweepAxis& axis, std::size_t chosen, Subject& subject) {
  subject.text.at(below(subject, axis.parameter)) = axis.values[chosen];
  for (const Follower& follower : axis.with) {
    subject.text.at(below(subject, follower.parameter)) = follower.values[chosen];
  }
}

/// Where in the case file the value stands that an axis puts at or above `pointer`, with the part of
/// `pointer` below it; empty if it puts none there.
std::string source_of(const std::string& pointer, const std::vector<SweepAxis>& sweep, const Choice& choice,
                      std::size_t axis) {
  if (const std::string& parameter = sweep[axis].parameter; at_or_below(pointer, parameter))
    return chosen_pointer(choice, axis) + pointer.substr(parameter.size());
  for (const Follower& follower : sweep[axis].with) {
    if (!at_or_below(pointer, follower.parameter)) continue;
    const Json::json_pointer values = Json::json_pointer(axis_pointer(axis) + "/with") / follower.parameter;
    return (values / choice[axis]).to_string() + pointer.substr(follower.parameter.size());
  }
  return "";
}

/// The first axis whose value makes the subject impossible even without the other axes; if none does alone,
/// the last.
std::size_t culprit(const Subject& subject, const std::vector<SweepAxis>& sweep, const Choice& choice) {
  for (std::size_t axis = 0; axis < sweep.size(); ++axis) {
    Subject changed = subject;
    put(sweep[axis], choice[axis], changed);
    try {
      read_checked(changed);
    } catch (const Refusal&) {
      return axis;
    }
  }
  return sweep.size() - 1;
}

/// Says which swept value is to blame for what is wrong with the subject of a run.
[[noreturn]] void refuse_run(const Refusal& refusal, const Subject& subject,
                             const std::vector<SweepAxis>& sweep, const Choice& choice) {
  for (std::size_t axis = 0; axis < sweep.size(); ++axis) {
    const std::string source = source_of(refusal.pointer(), sweep, choice, axis);
    if (!source.empty()) throw Refusal(source, refusal.expected(), refusal.found());
  }
  const std::size_t axis = culprit(subject, sweep, choice);
  throw Refusal(chosen_pointer(choice, axis),
                "a value with which " + refusal.pointer() + " is " + refusal.expected(),
                describe(chosen_value(sweep, choice, axis)) + ", which makes it " + refusal.found());
}

RunRequest read_run(const Subject& subject, const std::vector<SweepAxis>& sweep, const Choice& choice) {
  RunRequest run;
  Subject resolved = subject;
  for (std::size_t axis = 0; axis < sweep.size(); ++axis) {
    run.parameters.emplace_back(sweep[axis].parameter, chosen_value(sweep, choice, axis));
    put(sweep[axis], choice[axis], resolved);
  }
  try {
    CheckedSubject checked = read_checked(resolved);
    run.scene = std::move(checked.scene);
    run.motion = std::move(checked.motion);
    run.element = std::move(checked.element);
  } catch (const Refusal& refusal) {
    refuse_run(refusal, subject, sweep, choice);
  }
  run.scene_text = std::move(resolved.text);
  return run;
}

/// Moves on to the next combination, the last axis fastest; false after the last one.
bool advance(Choice& choice, const std::vector<SweepAxis>& sweep) {
  for (std::size_t axis = sweep.size(); axis-- > 0;) {
    if (++choice[axis] < sweep[axis].values.size()) return true;
    choice[axis] = 0;
  }
  return false;
}

const SweepAxis* find_axis(const std::vector<SweepAxis>& sweep, const std::string& parameter) {
  const auto axis =
      std::find_if(sweep.begin(), sweep.end(), [&](const SweepAxis& a) { return a.parameter == parameter; });
  return axis == sweep.end() ? nullptr : &*axis;
}

std::string swept_names(const std::vector<SweepAxis>& sweep) {
  if (sweep.empty()) return "a swept parameter, of which this case has none";
  std::vector<std::string> names;
  for (const SweepAxis& axis : sweep) names.push_back(axis.parameter);
  return "a swept parameter (" + listed(names) + ")";
}

Selector read_selector(const std::string& parameter, const JsonPlace& place,
                       const std::vector<SweepAxis>& sweep) {
  const SweepAxis* axis = find_axis(sweep, parameter);
  if (!axis) throw Refusal(place.pointer(), swept_names(sweep), "\"" + parameter + "\"");
  for (const JsonPlace& value : place.some_elements()) {
    if (std::find(axis->values.begin(), axis->values.end(), value.value()) == axis->values.end()) {
      std::vector<std::string> swept;
      for (const Json& candidate : axis->values) swept.push_back(describe(candidate));
      value.refuse("a value this parameter is swept over (" + listed(swept) + ")");
    }
  }
  return {parameter, read_distinct_values(place)};
}

}  // namespace

std::vector<SweepAxis> read_sweep(const JsonPlace& place, const Subject& subject) {
  std::vector<SweepAxis> sweep;
  if (!place.present()) return sweep;
  double runs = 1.0;
  std::vector<std::string> taken;
  for (const JsonPlace& axis : place.some_elements()) {
    sweep.push_back(read_sweep_axis(axis, subject, taken));
    runs *= static_cast<double>(sweep.back().values.size());
    if (runs > most_runs) place.refuse("at most 100000 runs");
  }
  return sweep;
}

std::vector<RunRequest> expand(const Subject& subject, const std::vector<SweepAxis>& sweep) {
  std::vector<RunRequest> runs;
  Choice choice(sweep.size(), 0);
  do {
    runs.push_back(read_run(subject, sweep, choice));
  } while (advance(choice, sweep));
  return runs;
}

const SweepAxis& read_axis(const JsonPlace& place, const std::vector<SweepAxis>& sweep) {
  const SweepAxis* axis = place.present() ? find_axis(sweep, place.text()) : nullptr;
  if (!axis) place.refuse(swept_names(sweep));
  return *axis;
}

std::vector<Selector> read_where(const JsonPlace& place, const std::vector<SweepAxis>& sweep) {
  std::vector<Selector> where;
  if (!place.present()) return where;
  for (const auto& [parameter, values] : place.members())
    where.push_back(read_selector(parameter, values, sweep));
  return where;
}

std::vector<Json> selected_values(const SweepAxis& axis, const std::vector<Selector>& where) {
  std::vector<Json> values = axis.values;
  for (const Selector& selector : where) {
    if (selector.parameter != axis.parameter) continue;
    std::erase_if(values, [&](const Json& value) {
      return std::find(selector.values.begin(), selector.values.end(), value) == selector.values.end();
    });
  }
  return values;
}

bool refines(const SweepAxis& axis, const std::vector<Json>& values, const Subject& scene) {
  Subject changed = scene;
  double coarser = std::numeric_limits<double>::infinity();
  for (const Json& value : values) {
    const auto chosen = std::find(axis.values.begin(), axis.values.end(), value) - axis.values.begin();
    put(axis, static_cast<std::size_t>(chosen), changed);
    const double cell_size = read_cell_size(changed);
    if (!(cell_size < coarser)) return false;
    coarser = cell_size;
  }
  return true;
}

std::string name_of(const RunRequest& run) {
  std::vector<std::string> values;
  for (const auto& [parameter, value] : run.parameters) values.push_back(parameter + " = " + describe(value));
  return listed(values);
}

std::string in_run(const RunRequest& run) {
  return run.parameters.empty() ? "" : " in the run with " + name_of(run);
}

}  // namespace mpm::vv
