#include "benchmarks/results.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "vv/json_reader.hpp"

namespace mpm::bench {
namespace {

using vv::JsonPlace;

constexpr const char* format = "mpmvv-bench-1";

/// The median goes by another name in every list.
Json json_of(Json start, const char* median_name, const Measured& measured) {
  start[median_name] = measured.value;
  start["low"] = measured.low;
  start["high"] = measured.high;
  return start;
}

Json json_of(const Limit& limit) {
  Json json = json_of({{"name", limit.name}, {"title", limit.title}}, "value", limit.rate);
  json["unit"] = limit.unit;
  return json;
}

Json json_of(const StepResult& step) {
  Json json = json_of({{"name", step.name},
                       {"scene", step.scene},
                       {"scheme", step.scheme},
                       {"order", step.order},
                       {"law", step.law},
                       {"precision", step.precision},
                       {"particles", step.particles},
                       {"threads", step.threads}},
                      "rate", step.rate);
  json["target"] = step.target ? Json(*step.target) : Json(nullptr);
  json["bytes"] = step.bytes;
  json["flops"] = step.flops;
  json["share_of_bandwidth"] = step.share_of_bandwidth;
  json["share_of_peak"] = step.share_of_peak;
  return json;
}

Json json_of(const KernelResult& kernel) { return json_of({{"name", kernel.name}}, "rate", kernel.rate); }

Json json_of(const RunResult& run) {
  return {{"name", run.name},
          {"title", run.title},
          {"threads", run.threads},
          {"particles", run.particles},
          {"steps", run.steps},
          {"seconds", run.seconds},
          {"settlement", run.settlement},
          {"ending", run.ending}};
}

Json json_of(const MemoryResult& memory) {
  return {{"scene", memory.scene},         {"law", memory.law},
          {"scheme", memory.scheme},       {"precision", memory.precision},
          {"particles", memory.particles}, {"bytes_per_particle", memory.bytes_per_particle}};
}

Json json_of(const StartUpResult& start) { return {{"scene", start.scene}, {"seconds", start.seconds}}; }

Json json_of(const FeatureCost& cost) {
  return json_of({{"what", cost.what},
                  {"particles", cost.particles},
                  {"time_step", cost.time_step},
                  {"bytes", cost.bytes}},
                 "step", cost.step);
}

Json json_of(const SpelledResult& spelled) {
  Json json =
      json_of({{"what", spelled.what}, {"of", spelled.of_with ? "with" : "without"}}, "ratio", spelled.ratio);
  json["bytes"] = spelled.bytes;
  json["same_bits"] = spelled.same_bits;
  json["verdict"] = name_of(spelled.verdict());
  return json;
}

Json json_of(const FeatureResult& feature) {
  Json json = json_of({{"name", feature.name},
                       {"title", feature.title},
                       {"without", json_of(feature.without)},
                       {"with", json_of(feature.with)}},
                      "ratio", feature.ratio);
  json["spelled"] = feature.spelled ? json_of(*feature.spelled) : Json(nullptr);
  return json;
}

template <class Entry>
Json array_of(const std::vector<Entry>& entries) {
  Json array = Json::array();
  for (const Entry& entry : entries) array.push_back(json_of(entry));
  return array;
}

Measured read_measured(const JsonPlace& place, const char* median_name) {
  const Measured measured{place[median_name].number(), place["low"].number(), place["high"].number()};
  if (!(measured.low <= measured.value && measured.value <= measured.high)) {
    place.refuse("a median between low and high");
  }
  return measured;
}

Limit read_limit(const JsonPlace& place) {
  return {place["name"].text(), place["title"].text(), place["unit"].text(), read_measured(place, "value")};
}

StepResult read_step(const JsonPlace& place) {
  StepResult step;
  step.name = place["name"].text();
  step.scene = place["scene"].text();
  step.scheme = place["scheme"].text();
  step.order = place["order"].text();
  step.law = place["law"].text();
  step.precision = place["precision"].text();
  step.particles = place["particles"].integer();
  step.threads = place["threads"].integer();
  step.rate = read_measured(place, "rate");
  const JsonPlace target = place["target"];
  if (!target.present() || !target.value().is_null()) step.target = target.number();
  step.bytes = place["bytes"].number();
  step.flops = place["flops"].number();
  step.share_of_bandwidth = place["share_of_bandwidth"].number();
  step.share_of_peak = place["share_of_peak"].number();
  return step;
}

KernelResult read_kernel(const JsonPlace& place) {
  return {place["name"].text(), read_measured(place, "rate")};
}

RunResult read_run(const JsonPlace& place) {
  return {.name = place["name"].text(),
          .title = place["title"].text(),
          .threads = place["threads"].integer(),
          .particles = place["particles"].integer(),
          .steps = place["steps"].integer(),
          .seconds = place["seconds"].number(),
          .settlement = place["settlement"].number(),
          .ending = place["ending"].text()};
}

MemoryResult read_memory(const JsonPlace& place) {
  return {.scene = place["scene"].text(),
          .law = place["law"].text(),
          .scheme = place["scheme"].text(),
          .precision = place["precision"].text(),
          .particles = place["particles"].integer(),
          .bytes_per_particle = place["bytes_per_particle"].number()};
}

StartUpResult read_start_up(const JsonPlace& place) {
  return {place["scene"].text(), place["seconds"].number()};
}

std::int64_t read_bytes(const JsonPlace& place) {
  if (!place.present() || !place.value().is_number_integer()) place.refuse("a whole number");
  return place.value().get<std::int64_t>();
}

FeatureCost read_feature_cost(const JsonPlace& place) {
  return {.what = place["what"].text(),
          .particles = place["particles"].integer(),
          .time_step = place["time_step"].number(),
          .bytes = read_bytes(place["bytes"]),
          .step = read_measured(place, "step")};
}

SpelledResult read_spelled(const JsonPlace& place) {
  return {.what = place["what"].text(),
          .of_with = place["of"].one_of({"with", "without"}) == "with",
          .ratio = read_measured(place, "ratio"),
          .bytes = read_bytes(place["bytes"]),
          .same_bits = place["same_bits"].flag()};
}

FeatureResult read_feature(const JsonPlace& place) {
  FeatureResult feature{.name = place["name"].text(),
                        .title = place["title"].text(),
                        .without = read_feature_cost(place["without"]),
                        .with = read_feature_cost(place["with"]),
                        .ratio = read_measured(place, "ratio"),
                        .spelled = std::nullopt};
  const JsonPlace spelled = place["spelled"];
  if (!spelled.present()) spelled.refuse("an object or null");
  if (!spelled.value().is_null()) feature.spelled = read_spelled(spelled);
  return feature;
}

template <class Read>
auto read_all(const JsonPlace& place, Read read) {
  std::vector<decltype(read(place))> entries;
  for (const JsonPlace& element : place.elements()) entries.push_back(read(element));
  return entries;
}

/// Entries are told apart by their names.
template <class Entry>
void require_own_names(const JsonPlace& place, const std::vector<Entry>& entries) {
  std::vector<std::string> names;
  for (const Entry& entry : entries) {
    if (vv::contains(names, entry.name)) place.refuse("every name once", ", " + entry.name + " twice");
    names.push_back(entry.name);
  }
}

Results read_all_of(const JsonPlace& place) {
  place["format"].one_of({format});
  Results results;
  results.revision = place["revision"].text();
  results.modified = place["modified"].flag();
  results.date = place["date"].text();
  results.compiler = place["compiler"].text();
  results.native = place["native"].flag();
  results.processor = place["machine"]["processor"].text();
  results.cores = place["machine"]["cores"].integer();
  results.repetitions = place["repetitions"].integer();
  results.seconds_each = place["seconds_each"].number();
  results.noise = place["noise"].number();
  results.limits = read_all(place["limits"], read_limit);
  results.steps = read_all(place["steps"], read_step);
  results.kernels = read_all(place["kernels"], read_kernel);
  results.runs = read_all(place["runs"], read_run);
  results.memory = read_all(place["memory"], read_memory);
  results.start_up = read_all(place["start_up"], read_start_up);
  if (place["features"].present()) results.features = read_all(place["features"], read_feature);
  require_own_names(place["limits"], results.limits);
  require_own_names(place["steps"], results.steps);
  require_own_names(place["kernels"], results.kernels);
  require_own_names(place["features"], results.features);
  return results;
}

std::string reason() { return errno != 0 ? std::strerror(errno) : "unknown reason"; }

std::filesystem::path beside(const std::filesystem::path& file) { return file.string() + ".part"; }

void write(const std::string& text, const std::filesystem::path& file) {
  std::error_code ignored;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), ignored);
  errno = 0;
  std::ofstream stream(beside(file), std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw ResultsError(file.string() + ": cannot write: " + reason());
}

}  // namespace

SpelledResult::Verdict SpelledResult::verdict() const {
  if (ratio.high <= 1 + free_limit) return Verdict::within_limit;
  return ratio.low <= 1 + free_limit ? Verdict::within_noise : Verdict::beyond;
}

std::string name_of(SpelledResult::Verdict verdict) {
  using enum SpelledResult::Verdict;
  return verdict == within_limit ? "within_limit" : verdict == within_noise ? "within_noise" : "beyond";
}

Json json_of(const Results& results) {
  return {{"format", format},
          {"revision", results.revision},
          {"modified", results.modified},
          {"date", results.date},
          {"compiler", results.compiler},
          {"native", results.native},
          {"machine", {{"processor", results.processor}, {"cores", results.cores}}},
          {"repetitions", results.repetitions},
          {"seconds_each", results.seconds_each},
          {"noise", results.noise},
          {"limits", array_of(results.limits)},
          {"steps", array_of(results.steps)},
          {"kernels", array_of(results.kernels)},
          {"runs", array_of(results.runs)},
          {"memory", array_of(results.memory)},
          {"start_up", array_of(results.start_up)},
          {"features", array_of(results.features)}};
}

Results parse_results(const std::string& text, const std::string& file) {
  try {
    const Json json = vv::parse_json(text);
    return read_all_of(JsonPlace(&json, ""));
  } catch (const vv::Refusal& refusal) {
    throw ResultsError(file + ": " + refusal.what());
  }
}

Results read_results(const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& why) {
    throw ResultsError(file.string() + ": cannot read: " + why);
  };
  if (std::filesystem::is_directory(file)) refuse("it is a directory");
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) refuse(reason());
  std::ostringstream text;
  text << stream.rdbuf();
  return parse_results(text.str(), file.string());
}

void check_writable(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file)) {
    throw ResultsError(file.string() + ": cannot write: it is a directory");
  }
  write("", file);
  std::error_code ignored;
  std::filesystem::remove(beside(file), ignored);
}

void write_results(const Results& results, const std::filesystem::path& file) {
  write(json_of(results).dump(1) + "\n", file);
  std::error_code error;
  std::filesystem::rename(beside(file), file, error);
  if (error) throw ResultsError(file.string() + ": cannot write: " + error.message());
}

}  // namespace mpm::bench
