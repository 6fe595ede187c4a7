#include "reports/performance.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "vv/json_reader.hpp"

namespace mpm::reports {
namespace {

namespace fs = std::filesystem;
using vv::JsonPlace;

constexpr const char* format = "mpmvv-bench-1";

double positive(const JsonPlace& place) {
  const double value = place.number();
  if (!(std::isfinite(value) && value > 0.0)) place.refuse("a number above 0");
  return value;
}

double not_negative(const JsonPlace& place) {
  const double value = place.number();
  if (!(std::isfinite(value) && value >= 0.0)) place.refuse("a number of at least 0");
  return value;
}

std::int64_t count(const JsonPlace& place) {
  if (!place.present() || !place.value().is_number_integer() || place.value() < 1)
    place.refuse("a whole number above 0");
  return place.value().get<std::int64_t>();
}

int small_count(const JsonPlace& place) {
  const int value = place.integer();
  if (value < 1) place.refuse("a whole number above 0");
  return value;
}

/// A key that must be there, but may say that there is no such number.
template <class Read>
std::optional<double> if_any(const JsonPlace& place, Read read) {
  if (place.present() && place.value().is_null()) return std::nullopt;
  return read(place);
}

Measured measured(const JsonPlace& place, const char* median) {
  const Measured value{positive(place[median]), positive(place["low"]), positive(place["high"])};
  if (value.low > value.median) place["low"].refuse("at most the " + std::string(median));
  if (value.high < value.median) place["high"].refuse("at least the " + std::string(median));
  return value;
}

Limit limit(const JsonPlace& place) {
  return {place["name"].text(), place["title"].text(), measured(place, "value"),
          place["unit"].one_of({"B/s", "flop/s", "particles/s"})};
}

StepRate step(const JsonPlace& place) {
  StepRate step;
  step.name = place["name"].text();
  step.scene = place["scene"].text();
  step.scheme = place["scheme"].text();
  step.order = place["order"].text();
  step.law = place["law"].text();
  step.precision = place["precision"].text();
  step.particles = count(place["particles"]);
  step.threads = small_count(place["threads"]);
  step.rate = measured(place, "rate");
  step.target = if_any(place["target"], positive);
  step.bytes = if_any(place["bytes"], positive);
  step.flops = if_any(place["flops"], positive);
  step.share_of_bandwidth = if_any(place["share_of_bandwidth"], not_negative);
  step.share_of_peak = if_any(place["share_of_peak"], not_negative);
  return step;
}

KernelRate kernel(const JsonPlace& place) { return {place["name"].text(), measured(place, "rate")}; }

TimedRun run(const JsonPlace& place) {
  TimedRun run;
  run.name = place["name"].text();
  run.title = place["title"].text();
  run.threads = small_count(place["threads"]);
  run.particles = count(place["particles"]);
  run.steps = count(place["steps"]);
  run.seconds = positive(place["seconds"]);
  if (place["settlement"].present())  // not every scene has a footing
    run.settlement = if_any(place["settlement"], [](const JsonPlace& p) { return p.number(); });
  run.ending = place["ending"].text();
  return run;
}

MemoryUse memory(const JsonPlace& place) {
  return {place["scene"].text(),     place["law"].text(),       place["scheme"].text(),
          place["precision"].text(), count(place["particles"]), positive(place["bytes_per_particle"])};
}

StartUp start_up(const JsonPlace& place) { return {place["scene"].text(), not_negative(place["seconds"])}; }

FeatureCost feature_cost(const JsonPlace& place) {
  return {place["what"].text(), count(place["particles"]), positive(place["time_step"]),
          count(place["bytes"]), measured(place, "step")};
}

SpelledDefault spelled_default(const JsonPlace& place) {
  return {.what = place["what"].text(),
          .of_with = place["of"].one_of({"with", "without"}) == "with",
          .ratio = measured(place, "ratio"),
          .bytes = count(place["bytes"]),
          .same_bits = place["same_bits"].flag(),
          .verdict = place["verdict"].one_of({"within_limit", "within_noise", "beyond"})};
}

FeaturePrice feature(const JsonPlace& place) {
  FeaturePrice feature{.name = place["name"].text(),
                       .title = place["title"].text(),
                       .without = feature_cost(place["without"]),
                       .with = feature_cost(place["with"]),
                       .ratio = measured(place, "ratio"),
                       .spelled = std::nullopt};
  const JsonPlace spelled = place["spelled"];
  if (!spelled.present()) spelled.refuse("an object or null");
  if (!spelled.value().is_null()) feature.spelled = spelled_default(spelled);
  return feature;
}

template <class Entry>
std::vector<Entry> entries(const JsonPlace& place, Entry (*read)(const JsonPlace&)) {
  std::vector<Entry> all;
  for (const JsonPlace& element : place.elements()) all.push_back(read(element));
  return all;
}

/// Names tell entries apart and find them again in another file.
void refuse_repeated_names(const JsonPlace& steps) {
  std::vector<std::string> taken;
  for (const JsonPlace& element : steps.elements()) {
    const std::string name = element["name"].text();
    if (vv::contains(taken, name))
      element["name"].refuse("a name of its own", ", which an earlier entry has");
    taken.push_back(name);
  }
}

Performance performance(const JsonPlace& root) {
  root["format"].one_of({format});  // before all else: nothing in another format need be as expected here
  Performance result;
  result.revision = root["revision"].text();
  result.modified = root["modified"].flag();
  result.date = root["date"].text();
  result.compiler = root["compiler"].text();
  result.native = root["native"].flag();
  const JsonPlace machine = root["machine"];
  result.processor = machine["processor"].text();
  result.cores = small_count(machine["cores"]);
  result.repetitions = small_count(root["repetitions"]);
  result.seconds_each = positive(root["seconds_each"]);
  result.noise = not_negative(root["noise"]);
  result.limits = entries(root["limits"], limit);
  result.steps = entries(root["steps"], step);
  refuse_repeated_names(root["steps"]);
  result.kernels = entries(root["kernels"], kernel);
  result.runs = entries(root["runs"], run);
  result.memory = entries(root["memory"], memory);
  result.start_up = entries(root["start_up"], start_up);
  if (root["features"].present()) result.features = entries(root["features"], feature);
  return result;
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream || fs::is_directory(file))
    throw std::runtime_error(file.string() +
                             ": expected a file of measurements, found none that can be read");
  return text;
}

}  // namespace

std::string Performance::full_revision() const {
  const bool says_so = revision.ends_with("-dirty");
  return revision + (modified && !says_so ? "-dirty" : "");
}

void PerformanceEvidence::drop_present_from_history() {
  std::erase_if(history, [this](const Performance& earlier) {
    return measured && earlier.date == measured->date && earlier.full_revision() == measured->full_revision();
  });
}

Performance read_performance(const fs::path& file) {
  const std::string text = text_of(file);
  try {
    const vv::JsonPlace::Json json = vv::parse_json(text);
    Performance result = performance(JsonPlace(&json, ""));
    result.file = file;
    return result;
  } catch (const vv::Refusal& refusal) {
    throw std::runtime_error(file.string() + ": " + refusal.what());
  }
}

std::vector<Performance> read_performance_history(const fs::path& directory) {
  std::error_code error;
  std::vector<Performance> history;
  for (auto entry = fs::directory_iterator(directory, error); !error && entry != fs::directory_iterator();
       entry.increment(error))
    if (entry->path().extension() == ".json") history.push_back(read_performance(entry->path()));
  if (error)
    throw std::runtime_error(directory.string() +
                             ": expected a directory of measurements: " + error.message());
  std::sort(history.begin(), history.end(), [](const Performance& a, const Performance& b) {
    return std::pair(a.date, a.file) < std::pair(b.date, b.file);
  });
  return history;
}

}  // namespace mpm::reports
