#include "vv/advised_case.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <optional>

#include "vv/curve_file.hpp"
#include "vv/json_reader.hpp"
#include "vv/measurement_reader.hpp"
#include "vv/record.hpp"
#include "vv/scene_reader.hpp"
#include "vv/sweep.hpp"

namespace mpm::vv {
namespace {

namespace fs = std::filesystem;

constexpr double room_of_the_same = 1.05, room_between = 1.5;

// ---- scene ----

Json::json_pointer below_scene(const std::string& pointer) {
  return Json::json_pointer(pointer.substr(std::string("/scene").size()));
}

[[noreturn]] void refuse(const std::string& pointer) {
  throw std::runtime_error("the case has no " + pointer + ", which the configuration changes");
}

/// Parents come before what lies in them, and of an array the front before the back.
std::vector<std::string> in_order(std::vector<std::string> places) {
  std::sort(places.begin(), places.end(), [](const std::string& one, const std::string& other) {
    return std::pair(one.size(), one) < std::pair(other.size(), other);
  });
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return places;
}

void erase(Json& scene, const Json::json_pointer& place) {
  Json& parent = scene.at(place.parent_pointer());
  if (parent.is_array())
    parent.erase(static_cast<std::size_t>(std::stoull(place.back())));
  else
    parent.erase(place.back());
}

/// Puts back what other configurations change: each is given by what it changes in the scene as measured.
void restore(Json& scene, const Json& measured, const std::vector<std::string>& configured) {
  const std::vector<std::string> places = in_order(configured);
  for (const std::string& pointer : places) {
    const Json::json_pointer place = below_scene(pointer);
    if (!measured.contains(place)) continue;
    if (!scene.contains(place.parent_pointer())) refuse(pointer);
    scene[place] = measured.at(place);
  }
  for (auto pointer = places.rbegin(); pointer != places.rend(); ++pointer) {
    const Json::json_pointer place = below_scene(*pointer);
    if (!measured.contains(place) && scene.contains(place)) erase(scene, place);
  }
}

/// The changes of a configuration as the one variant of an axis.
SweepAxis axis_of(const Json& changes, const Json& scene) {
  Variant variant{.name = "advised", .set = {}, .remove = {}};
  for (const auto& [pointer, value] : changes.at("set").items()) {
    if (!scene.contains(below_scene(pointer).parent_pointer())) refuse(pointer);
    variant.set.emplace_back(pointer, value);
  }
  for (const Json& entry : changes.at("remove")) {
    const std::string pointer = entry;
    if (!scene.contains(below_scene(pointer))) refuse(pointer);
    variant.remove.push_back(pointer);
  }
  return {.parameter = "advised", .values = {"advised"}, .with = {}, .variants = {variant}};
}

// ---- the reference curve ----

std::string si_unit_of(const std::string& dimension) {
  for (const char* unit : {"m", "s", "Pa", "kg/m^3", "m/s^2", "m/s", "deg", "N/m", "N/m^3"})
    if (dimension_of_unit(unit) == dimension) return unit;
  return "1";
}

std::string reference_id(const fs::path& file) { return file.stem().string() + "_reference"; }

const Json& request_of(const TradeMatch& match) {
  for (const Json& request : match.measured->definition.at("trades"))
    if (request.at("title") == match.title) return request;
  throw std::runtime_error("the measured case does not ask for the trade \"" + match.title + "\"");
}

Json column(const std::string& name, const std::string& dimension, const std::string& meaning,
            const std::string& experimental) {
  return {{"name", name},
          {"unit", si_unit_of(dimension)},
          {"meaning", meaning},
          {"digitisation", "none"},
          {"experimental", experimental}};
}

/// The curve that the trade's errors are distances from, as a curve file.
Json reference_curve(const TradeReference& reference, const CurveKind& kind, const TradeMatch& match,
                     const Advised& advised, const std::string& id) {
  const std::string abscissa = kind.name == "pressure" ? "settlement" : "abscissa";
  const std::string spread =
      reference.uncertainty > 0.0 ? fmt::format("{:.3g} %", 100.0 * reference.uncertainty) : "none";
  Json curve = {
      {"format", "mpmvv-curve/1"},
      {"id", id},
      {"title", match.title + ", simulated"},
      {"status", "present"},
      {"source",
       {{"citation", "mpmvv"},
        {"doi", nullptr},
        {"place", advised.measured},
        {"by_way_of", reference.source}}},
      {"origin", "simulated"},
      {"columns",
       {column(abscissa, kind.abscissa, "where the curve is read", "none"),
        column(kind.name, kind.ordinate, reference.source, spread)}},
      {"abscissa", abscissa},
      {"rows", Json::array()},
      {"licence", "none: computed"},
      {"used_for_calibration", false},
      {"notes",
       {"The uncertainty is half the range of the families of runs that the curve is the mean of."}}};
  for (std::size_t k = 0; k < reference.x.size(); ++k)
    curve["rows"].push_back({reference.x[k], reference.y[k]});
  curve["hash"] = hash_of_values(curve);
  return curve;
}

// ---- the case ----

/// Adds the entries of `more` whose id, or text, is not there.
void add_missing(const Json& more, Json& entries) {
  for (const Json& entry : more) {
    const auto same = [&](const Json& other) {
      return entry.is_object() ? entry.at("id") == other.at("id") : entry == other;
    };
    if (std::none_of(entries.begin(), entries.end(), same)) entries.push_back(entry);
  }
}

/// What the error is taken from is observed as in the measured case; the case's own probes and readings stay.
void add_observations(const Case& asked, const MeasuredCase& measured, Json& text) {
  for (const char* key : {"references", "probes", "snapshots", "cuts", "readings"}) {
    Json entries = measured.definition.value(key, Json::array());
    const bool named = std::string(key) != "snapshots" && std::string(key) != "cuts";
    if (named) add_missing(asked.text.value(key, Json::array()), entries);
    if (!entries.empty() || std::string(key) == "references") text[key] = entries;
  }
}

/// Whether a metric cannot be negative by what it is.
bool is_norm(const std::string& metric) {
  return metric.ends_with(".l1") || metric.ends_with(".l2") || metric.ends_with(".linf");
}

/// The gates that hold the error's magnitude to its bound.
Json promises(const std::string& metric, const Advised& advised, bool between) {
  const double room = between ? room_between : room_of_the_same;
  const std::string why =
      between ? "the problem lies between measured ones" : "another compiler may move the last digits";
  const double threshold = std::stod(fmt::format("{:.6g}", room * advised.point.bound()));
  const Json promise = {{"id", "promise"},
                        {"metric", metric},
                        {"at_most", threshold},
                        {"basis", "requirement"},
                        {"reason", fmt::format("{:.3g} was promised by {}; {} times that, since {}",
                                               advised.point.bound(), advised.measured, room, why)}};
  if (is_norm(metric)) return Json::array({promise});
  Json below = promise;
  below["id"] = "promise_below";
  below.erase("at_most");
  below["at_least"] = -threshold;
  return Json::array({promise, below});
}

/// The case's sweep without all axes but those of the problem, where none of its values was selected.
Json problem_sweep(const Case& asked, const TradeMatch& match) {
  Json sweep = Json::array();
  if (match.problems.size() < 2) return sweep;
  for (const Json& axis : asked.text.value("sweep", Json::array()))
    if (contains(match.swept, axis.value("parameter", axis.value("name", "")))) sweep.push_back(axis);
  return sweep;
}

Json case_text(const Case& asked, const TradeMatch& match, const Advised& advised, const std::string& id) {
  const Json& scene = match.problems.size() < 2 ? match.problems.front().scene : asked.text.at("scene");
  Json text = {{"id", id},
               {"title", asked.title + ", as advised"},
               {"description",
                fmt::format("The scene of {} with the configuration {}, advised for its {} by {}.", asked.id,
                            scope_of(advised.point.configuration), match.title, advised.measured)},
               {"scene", configured_scene(scene, *match.measured, match.configured, advised.changes)}};
  if (Json sweep = problem_sweep(asked, match); !sweep.empty()) text["sweep"] = std::move(sweep);
  add_observations(asked, *match.measured, text);
  return text;
}

/// What the axes of a curve of the case measure.
CurveKind kind_of(const std::string& curve, Json text, const Advised& advised, const fs::path& file) {
  text["gates"] = promises("completed", advised, false);  // without a gate it is no case
  const Case read = parse_case(text.dump(), file);
  for (CurveKind& kind : curve_kinds(read))
    if (kind.name == curve) return std::move(kind);
  throw std::runtime_error("a case cannot be compared with a curve " + curve);
}

/// Compares the run's curve with the reference, whose file it gives.
Json add_measurement(const TradeMatch& match, const Advised& advised, const fs::path& file, Json& text) {
  if (match.problems.size() > 1 || match.near().size() != 1)
    throw std::runtime_error(
        "the error is the distance of a curve, of which there is one a measured problem: " +
        std::string("say which with --problem"));
  const TradeVerdict& trade = *match.near().front();
  const CurveKind kind = kind_of(trade.error_name, text, advised, file);
  const Json request = request_of(match);
  Json measurement = {{"id", "reference"},
                      {"curve_file", reference_id(file) + ".json"},
                      {"curve", trade.error_name},
                      {"accuracy", advised.point.bound()},
                      {"reason", "what is promised has to be seen"}};
  if (request.contains("within")) measurement["within"] = request["within"];
  text["measurements"] = Json::array({measurement});
  return reference_curve(trade.reference, kind, match, advised, reference_id(file));
}

void require_free(const fs::path& file, bool force) {
  if (!force && fs::exists(file))
    throw std::runtime_error(file.string() + ": is there already, and is replaced only with --force");
}

std::string id_from(const fs::path& file) {
  const Json stem = file.stem().string();
  try {
    if (file.extension() == ".json") return JsonPlace(&stem, "").identifier();
  } catch (const Refusal&) {  // told below
  }
  throw std::runtime_error(
      file.string() +
      ": expected a name such as advised.json, a letter followed by letters, digits and underscores");
}

std::string text_of(const Json& json) { return json.dump(2) + "\n"; }

/// A directory beside the file for as long as this lives.
class TrialDirectory {
 public:
  explicit TrialDirectory(const fs::path& beside)
      : path_(beside.parent_path() / fmt::format(".mpmvv-{}", ::getpid())) {
    fs::create_directories(path_);
  }
  ~TrialDirectory() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TrialDirectory(const TrialDirectory&) = delete;
  TrialDirectory& operator=(const TrialDirectory&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Throws CaseError for what could not be read once it is written.
void require_readable(const Json& text, const std::optional<Json>& curve, const fs::path& file) {
  const TrialDirectory trial(file);
  if (curve) write_atomically(trial.path() / (reference_id(file) + ".json"), text_of(*curve));
  parse_case(text_of(text), trial.path() / file.filename());
}

}  // namespace

Json configured_scene(const Json& scene, const MeasuredCase& measured,
                      const std::vector<std::string>& configured, const Json& changes) {
  Json restored = scene;
  restore(restored, measured.scene, configured);
  return with_value(axis_of(changes, restored), 0, {"/scene", restored}).text;
}

void write_advised_case(const Case& asked, const TradeMatch& match, const Advised& advised,
                        const fs::path& file, bool force) {
  const fs::path curve_file = file.parent_path() / (reference_id(file) + ".json");
  const TradeVerdict& trade = *match.near().front();
  const bool of_curve = !trade.reference.x.empty();
  Json text = case_text(asked, match, advised, id_from(file));
  require_free(file, force);
  std::optional<Json> curve;
  if (of_curve) {
    require_free(curve_file, force);
    curve = add_measurement(match, advised, file, text);
  }
  const std::string metric = of_curve ? "measured.reference.l2" : trade.error_name;
  text["gates"] = promises(metric, advised, match.between());
  if (file.has_parent_path()) fs::create_directories(file.parent_path());
  require_readable(text, curve, file);
  if (curve) write_atomically(curve_file, text_of(*curve));
  write_atomically(file, text_of(text));
}

}  // namespace mpm::vv
