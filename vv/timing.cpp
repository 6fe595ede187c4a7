#include "vv/timing.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <numeric>
#include <random>

#include "solver/simulation.hpp"

namespace mpm::vv {
namespace {

constexpr const char* timing_schema = "mpmvv-timing/1";

Json to_json(const TimedSteps& timed) {
  return {{"seconds", timed.seconds}, {"steps", timed.steps}, {"whole", timed.whole}};
}

/// Throws std::exception for what is none, or cannot have been measured.
TimedSteps timed_from(const Json& json) {
  const TimedSteps timed{.seconds = json.at("seconds").get<double>(),
                         .steps = json.at("steps").get<std::int64_t>(),
                         .whole = json.at("whole").get<bool>()};
  if (!(timed.seconds > 0.0) || timed.steps < 1) throw std::runtime_error("not a time");
  return timed;
}

/// How much longer a step of the run took on average than one of its first: strays and plastic particles come
/// later.
double growth_of(const Cost& cost) {
  const double all = cost.wall_seconds / static_cast<double>(cost.steps);
  const double growth = all / (cost.early_seconds / static_cast<double>(cost.early_steps));
  return growth > 0.0 && std::isfinite(growth) ? growth : 1.0;  // as if none, of a record that cannot tell
}

/// For the whole run [s].
double seconds_of_run(const TimedSteps& timed, const Cost& cost) {
  if (timed.whole) return timed.seconds;
  return timed.seconds / static_cast<double>(timed.steps) * static_cast<double>(cost.steps) * growth_of(cost);
}

}  // namespace

TimedSteps time_first_steps(const RunRequest& request, double seconds) {
  using Clock = std::chrono::steady_clock;
  constexpr std::int64_t particle_steps_a_look = 1 << 14;  // about a millisecond between looks at the clock
  Simulation simulation(request.scene, 1);
  const std::int64_t steps_a_look = std::max<std::int64_t>(
      1, particle_steps_a_look / std::max<std::int64_t>(1, simulation.particle_count()));
  TimedSteps timed;
  const auto began = Clock::now();
  do {
    for (std::int64_t step = 0; step < steps_a_look && !timed.whole; ++step)
      timed.whole = !simulation.advance();
    timed.seconds = std::chrono::duration<double>(Clock::now() - began).count();
  } while (!timed.whole && timed.seconds < seconds);
  timed.steps = simulation.steps();
  return timed;
}

double CaseTiming::seconds_of_repeat(std::size_t runs) {
  constexpr double wanted = 0.15, most_of_case = 60.0;
  const auto repeats = static_cast<double>(rounds * std::max<std::size_t>(1, runs));
  return std::min(wanted, most_of_case / repeats);
}

std::vector<std::size_t> CaseTiming::order_of_round(std::size_t round, std::size_t runs) {
  std::vector<std::size_t> order(runs);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::mt19937 random(static_cast<std::mt19937::result_type>(round + 1));
  for (std::size_t left = runs; left > 1; --left) std::swap(order[left - 1], order[random() % left]);
  return order;
}

CaseTiming::CaseTiming(const Case& definition, const std::vector<Record>& records, std::filesystem::path file,
                       const Timekeeper& timekeeper)
    : definition_(definition), records_(records), file_(std::move(file)), timekeeper_(timekeeper) {
  for (std::size_t run = 0; run < records.size(); ++run)
    if (records[run].completed() && records[run].cost.steps > 0) timed_.push_back(run);
  read();
}

/// All that must be the same for figures to be taken over.
Json CaseTiming::key() const {
  Json inputs = Json::array();
  for (const std::size_t run : timed_) inputs.push_back(records_[run].input_hash);
  return {{"schema", timing_schema},
          {"case_id", definition_.id},
          {"program_hash", timekeeper_.program},
          {"processor", timekeeper_.processor},
          {"cores", timekeeper_.cores},
          {"inputs", inputs}};
}

/// Nothing from a file that is absent, cut short, altered or of others.
void CaseTiming::read() {
  std::ifstream stream(file_, std::ios::binary);
  if (!stream) return;
  try {
    const Json json = Json::parse(stream);
    const Json& body = json.at("timings");
    if (json.at("hash") != hash_of(body.dump()) || body.at("of") != key()) return;
    std::vector<Round> done;
    for (const Json& round : body.at("rounds")) {
      done.emplace_back();
      for (const Json& timed : round) done.back().push_back(timed_from(timed));
      if (done.back().size() != timed_.size()) return;
    }
    if (done.size() <= rounds) done_ = std::move(done);
  } catch (const std::exception&) {
    done_.clear();
  }
}

void CaseTiming::store() const {
  Json all = Json::array();
  for (const Round& round : done_) {
    all.push_back(Json::array());
    for (const TimedSteps& timed : round) all.back().push_back(to_json(timed));
  }
  const Json body = {{"of", key()}, {"rounds", all}};
  std::filesystem::create_directories(file_.parent_path());
  write_atomically(file_, Json{{"hash", hash_of(body.dump())}, {"timings", body}}.dump() + "\n");
}

bool CaseTiming::run(const std::function<bool()>& after_repeat) {
  const double seconds = seconds_of_repeat(timed_.size());
  bool goes_on = true;
  while (goes_on && repeats_left() > 0) {
    Round round(timed_.size());
    std::size_t repeats = 0;
    for (const std::size_t place : order_of_round(done_.size(), timed_.size())) {
      round[place] = timekeeper_.time_steps(definition_.runs[timed_[place]], seconds);
      goes_on = after_repeat();
      if (++repeats < timed_.size() && !goes_on) return false;
    }
    done_.push_back(std::move(round));
    store();
  }
  return repeats_left() == 0;
}

Timing CaseTiming::timing_of(std::size_t place) const {
  std::vector<double> seconds;
  Timing timing;
  for (const Round& round : done_) {
    seconds.push_back(seconds_of_run(round[place], records_[timed_[place]].cost));
    timing.whole = timing.whole && round[place].whole;
  }
  std::sort(seconds.begin(), seconds.end());
  timing.repeats = static_cast<int>(seconds.size());
  timing.low = seconds.front();
  timing.median = seconds[seconds.size() / 2];
  timing.high = seconds.back();
  return timing;
}

Timings CaseTiming::timings() const {
  Timings timings(records_.size());
  if (done_.size() < rounds) return timings;
  for (std::size_t place = 0; place < timed_.size(); ++place) timings[timed_[place]] = timing_of(place);
  return timings;
}

std::filesystem::path timing_file(const std::filesystem::path& out, const Case& definition) {
  return out / "timings" / (definition.id + ".json");
}

}  // namespace mpm::vv
