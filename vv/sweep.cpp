#include "vv/sweep.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

#include "vv/run_groups.hpp"

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

/// Whether a key of the scene that is left to its default is named, or something in such a place.
bool names_absent_key(const std::string& parameter, const Subject& subject) {
  if (!parameter.starts_with(subject.pointer + "/")) return false;
  try {
    const Json::json_pointer place = below(subject, parameter);
    return !subject.text.contains(place) && subject.text.contains(place.parent_pointer()) &&
           subject.text.at(place.parent_pointer()).is_object();
  } catch (const Json::exception&) {  // not a JSON pointer
    return false;
  }
}

/// Whether one of two JSON pointers is the other or lies below it.
bool overlap(const std::string& one, const std::string& other) {
  return at_or_below(one, other) || at_or_below(other, one);
}

/// Refuses a `parameter` that one of the `taken` changes too. `found` describes it.
void require_untaken(const std::string& pointer, const std::string& parameter, const std::string& found,
                     const std::vector<std::string>& taken) {
  for (const std::string& other : taken) {
    if (overlap(parameter, other)) {
      throw Refusal(pointer, "a parameter that no other axis changes",
                    found + ", which " + other + " changes too");
    }
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
  require_untaken(pointer, parameter, found, taken);
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

/// A text on one line, short enough for a legend, that no earlier variant has.
std::string read_variant_name(const JsonPlace& place, const std::vector<Variant>& earlier) {
  constexpr std::size_t longest = 60;
  const std::string name = place.text();
  const auto characters = static_cast<std::size_t>(std::count_if(
      name.begin(), name.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
  const bool broken =
      std::any_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; });
  if (characters > longest || broken) place.refuse("a name of at most 60 characters on one line");
  if (contains(names_of(earlier), name)) {
    place.refuse("a name that no other variant of the axis has", ", which an earlier one has");
  }
  return name;
}

/// What a variant puts at a place: instead of a value there, or of a key's default.
void read_setting(const std::string& parameter, const JsonPlace& value, const Subject& subject,
                  const std::vector<std::string>& taken, Variant& variant) {
  const std::string found = describe(Json(parameter));
  if (names_absent_key(parameter, subject)) {
    require_untaken(value.pointer(), parameter, found, taken);
  } else {
    require_own_value(value.pointer(), parameter, found, subject, taken);
  }
  for (const auto& [other, own] : variant.set) {
    if (overlap(parameter, other)) {
      throw Refusal(value.pointer(), "a parameter that the variant sets once", found + " beside " + other);
    }
  }
  variant.set.emplace_back(parameter, value.value());
}

void read_removal(const JsonPlace& place, const Subject& subject, const std::vector<std::string>& taken,
                  Variant& variant) {
  const std::string parameter = place.text();
  require_own_value(place.pointer(), parameter, describe(place.value()), subject, taken);
  for (const auto& [other, own] : variant.set) {
    if (overlap(parameter, other)) place.refuse("a value that the variant does not set", " beside " + other);
  }
  for (const std::string& other : variant.remove) {
    if (overlap(parameter, other)) place.refuse("each value once", " beside " + other);
  }
  variant.remove.push_back(parameter);
}

/// Reads a variant; `taken` are the parameters that earlier axes change.
Variant read_variant(const JsonPlace& place, const Subject& subject, const std::vector<std::string>& taken,
                     const std::vector<Variant>& earlier) {
  place.allow_only({"name", "set", "remove"});
  Variant variant{.name = read_variant_name(place["name"], earlier), .set = {}, .remove = {}};
  for (const auto& [parameter, value] : place["set"].members())
    read_setting(parameter, value, subject, taken, variant);
  if (const JsonPlace removals = place["remove"]; removals.present()) {
    for (const JsonPlace& removal : removals.some_elements()) read_removal(removal, subject, taken, variant);
  }
  for (const Variant& other : earlier) {
    if (variant.remove == other.remove &&
        std::is_permutation(variant.set.begin(), variant.set.end(), other.set.begin(), other.set.end()))
      place["set"].refuse("what no other variant of the axis sets", ", as \"" + other.name + "\" has it");
  }
  return variant;
}

/// Reads an axis of variants, which two may change the same parameter since no run has both.
SweepAxis read_variants(const JsonPlace& place, const Subject& subject, const std::vector<SweepAxis>& earlier,
                        std::vector<std::string>& taken) {
  place.allow_only({"name", "variants"});
  SweepAxis axis;
  axis.parameter = place["name"].identifier();
  if (std::any_of(earlier.begin(), earlier.end(),
                  [&](const SweepAxis& other) { return other.parameter == axis.parameter; })) {
    place["name"].refuse("a name that no other axis has", ", which an earlier one has");
  }
  for (const JsonPlace& variant : place["variants"].some_elements()) {
    axis.variants.push_back(read_variant(variant, subject, taken, axis.variants));
    axis.values.emplace_back(axis.variants.back().name);
  }
  for (const Variant& variant : axis.variants) {
    for (const auto& [parameter, value] : variant.set) taken.push_back(parameter);
    taken.insert(taken.end(), variant.remove.begin(), variant.remove.end());
  }
  return axis;
}

/// Reads an axis; `taken` are the parameters that `earlier` axes change, to which its own are added.
SweepAxis read_sweep_axis(const JsonPlace& place, const Subject& subject,
                          const std::vector<SweepAxis>& earlier, std::vector<std::string>& taken) {
  if (place["name"].present() || place["variants"].present())
    return read_variants(place, subject, earlier, taken);
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

std::string chosen_pointer(const std::vector<SweepAxis>& sweep, const Choice& choice, std::size_t axis) {
  return axis_pointer(axis) + (sweep[axis].variants.empty() ? "/values/" : "/variants/") +
         std::to_string(choice[axis]);
}

/// Puts the value with index `chosen` of an axis into the subject, and what follows along. What a variant
/// removes stays, so that the places of what comes after it do too.
void put(const SweepAxis& axis, std::size_t chosen, Subject& subject) {
  if (!axis.variants.empty()) {
    for (const auto& [parameter, value] : axis.variants[chosen].set)
      subject.text[below(subject, parameter)] = value;
    return;
  }
  subject.text.at(below(subject, axis.parameter)) = axis.values[chosen];
  for (const Follower& follower : axis.with) {
    subject.text.at(below(subject, follower.parameter)) = follower.values[chosen];
  }
}

/// Takes out what the chosen variants remove, from behind.
void remove(const std::vector<const Variant*>& variants, Subject& subject) {
  std::vector<Json::json_pointer> places;
  for (const Variant* variant : variants) {
    for (const std::string& parameter : variant->remove) places.push_back(below(subject, parameter));
  }
  const auto index_of = [](const Json::json_pointer& place) {
    const std::string& last = place.back();
    const bool is_index = last.find_first_not_of("0123456789") == std::string::npos;
    return is_index ? std::stoll(last) : -1;
  };
  std::stable_sort(places.begin(), places.end(),
                   [&](const auto& a, const auto& b) { return index_of(a) > index_of(b); });
  for (const Json::json_pointer& place : places) {
    Json& parent = subject.text.at(place.parent_pointer());
    if (parent.is_array()) {
      parent.erase(static_cast<std::size_t>(index_of(place)));
    } else {
      parent.erase(place.back());
    }
  }
}

/// Puts one value of one axis into the subject, as if there were no other axis.
void put_alone(const SweepAxis& axis, std::size_t chosen, Subject& subject) {
  put(axis, chosen, subject);
  if (!axis.variants.empty()) remove({&axis.variants[chosen]}, subject);
}

/// Where in the case file the value stands that a variant puts at or above `pointer`; `variant_pointer` is
/// its own place.
std::string source_in_variant(const std::string& pointer, const Variant& variant,
                              const std::string& variant_pointer) {
  for (const auto& [parameter, value] : variant.set) {
    if (!at_or_below(pointer, parameter)) continue;
    return (Json::json_pointer(variant_pointer + "/set") / parameter).to_string() +
           pointer.substr(parameter.size());
  }
  return "";
}

/// Where in the case file the value stands that an axis puts at or above `pointer`, with the part of
/// `pointer` below it; empty if it puts none there.
std::string source_of(const std::string& pointer, const std::vector<SweepAxis>& sweep, const Choice& choice,
                      std::size_t axis) {
  if (!sweep[axis].variants.empty()) {
    return source_in_variant(pointer, sweep[axis].variants[choice[axis]],
                             chosen_pointer(sweep, choice, axis));
  }
  if (const std::string& parameter = sweep[axis].parameter; at_or_below(pointer, parameter))
    return chosen_pointer(sweep, choice, axis) + pointer.substr(parameter.size());
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
    put_alone(sweep[axis], choice[axis], changed);
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
  const std::string chosen = sweep[axis].variants.empty() ? "a value" : "a variant";
  throw Refusal(chosen_pointer(sweep, choice, axis),
                chosen + " with which " + refusal.pointer() + " is " + refusal.expected(),
                describe(chosen_value(sweep, choice, axis)) + ", which makes it " + refusal.found());
}

/// What an axis makes of the subject in a run, in the words of a variant.
Json change_of(const SweepAxis& axis, std::size_t chosen) {
  Json set = Json::object(), remove = Json::array();
  if (axis.variants.empty()) {
    set[axis.parameter] = axis.values[chosen];
    for (const Follower& follower : axis.with) set[follower.parameter] = follower.values[chosen];
  } else {
    for (const auto& [parameter, value] : axis.variants[chosen].set) set[parameter] = value;
    for (const std::string& parameter : axis.variants[chosen].remove) remove.push_back(parameter);
  }
  return {{"set", set}, {"remove", remove}};
}

/// Takes the scene as written for one that cannot start, and keeps why.
void keep_refusal(const Refusal& refusal, const Subject& subject, RunRequest& run) {
  run.refusal = refusal.pointer() + ": expected " + refusal.expected() + ", found " + refusal.found();
  run.scene = read_checked(subject).scene;
}

RunRequest read_run(const Subject& subject, const std::vector<SweepAxis>& sweep, const Choice& choice,
                    bool refusals) {
  RunRequest run;
  Subject resolved = subject;
  std::vector<const Variant*> variants;
  for (std::size_t axis = 0; axis < sweep.size(); ++axis) {
    run.parameters.emplace_back(sweep[axis].parameter, chosen_value(sweep, choice, axis));
    run.changes.push_back(change_of(sweep[axis], choice[axis]));
    put(sweep[axis], choice[axis], resolved);
    if (!sweep[axis].variants.empty()) variants.push_back(&sweep[axis].variants[choice[axis]]);
  }
  remove(variants, resolved);
  try {
    CheckedSubject checked = read_checked(resolved);
    run.scene = std::move(checked.scene);
    run.motion = std::move(checked.motion);
    run.model_request = checked.model;
    run.element = std::move(checked.element);
  } catch (const Refusal& refusal) {
    if (!refusals) refuse_run(refusal, subject, sweep, choice);
    keep_refusal(refusal, subject, run);
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

/// Combinations that are not run.
class Omissions {
 public:
  Omissions(const JsonPlace& place, const std::vector<SweepAxis>& sweep) : place_(place), sweep_(sweep) {
    if (!place.present()) return;
    for (const JsonPlace& entry : place.some_elements()) {
      entries_.push_back(entry);
      omitted_.push_back(read_where(entry, sweep));
    }
    takes_away_.resize(entries_.size(), false);
  }

  /// Whether this combination is one of them.
  bool omit(const Choice& choice) {
    Parameters parameters;
    for (std::size_t axis = 0; axis < sweep_.size(); ++axis)
      parameters.emplace_back(sweep_[axis].parameter, chosen_value(sweep_, choice, axis));
    for (std::size_t k = 0; k < omitted_.size(); ++k) {
      if (!selects(omitted_[k], parameters)) continue;
      takes_away_[k] = true;
      return true;
    }
    return false;
  }

  /// To be called when every combination has been asked for.
  void require_sense(const std::vector<RunRequest>& left) const {
    for (std::size_t k = 0; k < entries_.size(); ++k)
      if (!takes_away_[k]) entries_[k].refuse("runs that no earlier entry takes away");
    if (left.empty()) place_.refuse("combinations that leave a run");
  }

 private:
  JsonPlace place_;
  const std::vector<SweepAxis>& sweep_;
  std::vector<JsonPlace> entries_;
  std::vector<std::vector<Selector>> omitted_;
  std::vector<bool> takes_away_;
};

}  // namespace

std::vector<SweepAxis> read_sweep(const JsonPlace& place, const Subject& subject) {
  std::vector<SweepAxis> sweep;
  if (!place.present()) return sweep;
  double runs = 1.0;
  std::vector<std::string> taken;
  for (const JsonPlace& axis : place.some_elements()) {
    sweep.push_back(read_sweep_axis(axis, subject, sweep, taken));
    runs *= static_cast<double>(sweep.back().values.size());
    if (runs > most_runs) place.refuse("at most 100000 runs");
  }
  return sweep;
}

std::vector<RunRequest> expand(const Subject& subject, const std::vector<SweepAxis>& sweep,
                               const JsonPlace& without, bool refusals) {
  std::vector<RunRequest> runs;
  Omissions omissions(without, sweep);
  Choice choice(sweep.size(), 0);
  do {
    if (!omissions.omit(choice)) runs.push_back(read_run(subject, sweep, choice, refusals));
  } while (advance(choice, sweep));
  omissions.require_sense(runs);
  return runs;
}

Subject with_value(const SweepAxis& axis, std::size_t chosen, const Subject& subject) {
  Subject changed = subject;
  put_alone(axis, chosen, changed);
  return changed;
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
  double coarser = std::numeric_limits<double>::infinity();
  for (const Json& value : values) {
    Subject changed = scene;
    const auto chosen = std::find(axis.values.begin(), axis.values.end(), value) - axis.values.begin();
    put_alone(axis, static_cast<std::size_t>(chosen), changed);
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
