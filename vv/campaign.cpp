#include "vv/campaign.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <exception>
#include <fstream>
#include <mutex>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>
#include <thread>

#include "vv/advice.hpp"
#include "vv/gates.hpp"
#include "vv/machine.hpp"
#include "vv/progress.hpp"
#include "vv/revision.hpp"

namespace mpm::vv {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// ---- stopping ----

std::atomic<bool> stop_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

extern "C" void ask_to_stop(int) { stop_asked = true; }

/// While it lives the first SIGINT or SIGTERM asks for a clean stop; a second one has its usual effect.
class StopOnSignal {
 public:
  StopOnSignal() {
    stop_asked = false;
    struct sigaction action {};
    action.sa_handler = ask_to_stop;
    action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, &former_interrupt_);
    sigaction(SIGTERM, &action, &former_terminate_);
  }
  ~StopOnSignal() {
    sigaction(SIGINT, &former_interrupt_, nullptr);
    sigaction(SIGTERM, &former_terminate_, nullptr);
  }
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

 private:
  struct sigaction former_interrupt_ {};
  struct sigaction former_terminate_ {};
};

// ---- stored records ----

/// The text of a record file carries its own hash, so that an altered number is noticed.
std::string file_text_of(const Record& record) {
  const Json body = to_json(record);
  return Json{{"hash", hash_of(body.dump())}, {"record", body}}.dump() + "\n";
}

/// Nothing when the file is absent, cut short, altered or of another format: then the run is done again.
std::optional<Record> read_record(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return std::nullopt;
  try {
    const Json json = Json::parse(stream);
    const Json& body = json.at("record");
    if (json.at("hash") != hash_of(body.dump())) return std::nullopt;
    return record_from_json(body);
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

/// A file name from a swept value: letters, digits and "+-._=" stay.
std::string slug_of(const std::pair<std::string, Json>& parameter) {
  const auto& [pointer, value] = parameter;
  std::string slug = pointer.substr(pointer.rfind('/') + 1) + "=" +
                     (value.is_string() ? value.get<std::string>() : value.dump());
  const bool of_words = !pointer.starts_with('/');  // a variant's name; of a quantity the blank says nothing
  std::erase_if(slug, [&](char c) { return (c == ' ' && !of_words) || c == '"' || c == '{' || c == '}'; });
  for (char& c : slug) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!plain && std::string_view("+-._=").find(c) == std::string_view::npos) c = '_';
  }
  return slug;
}

std::string slug_of(const RunRequest& request) {
  std::string slug;
  for (const auto& parameter : request.parameters) {
    if (!slug.empty()) slug += ',';
    slug += slug_of(parameter);
  }
  constexpr std::size_t longest = 120;  // file systems stop at 255 bytes
  return slug.empty() ? "run" : slug.substr(0, longest);
}

// ---- jobs ----

/// Of an element test its increments or states, each of which costs about as much as a particle-step.
double estimated_steps(const RunRequest& request) {
  if (!request.element) return estimated_particle_steps(request.scene);
  const ElementTest& test = *request.element;
  return test.path == ElementPath::random_states ? test.states : test.increments;
}

/// One execution of one run.
struct Job {
  const Case* definition;
  std::size_t run;
  std::filesystem::path file;
  int pool_size;
  int step_threads = 0;               ///< that share the work of each step; 0 leaves it to the pool
  bool listed = false;                ///< a repeat on a number of threads that the case lists
  double estimate;                    ///< particle-steps
  std::optional<Record> record = {};  ///< once done
  std::atomic<std::int64_t> particle_steps{0};

  Job(const Case& of, std::size_t index, std::filesystem::path stored_in, int threads)
      : definition(&of),
        run(index),
        file(std::move(stored_in)),
        pool_size(threads),
        estimate(estimated_steps(of.runs[index]) * static_cast<double>(1 + of.metamorphoses.size())) {}

  const RunRequest& request() const { return definition->runs[run]; }

  /// Takes the stored record if it is what this program would compute from these inputs.
  bool reuse(const std::function<bool(const Record&)>& acceptable = {}) {
    std::optional<Record> stored = read_record(file);
    if (!stored || stored->case_id != definition->id || stored->program_hash != program_hash() ||
        stored->input_hash != input_hash(*definition, request()) || !stored->failure.empty() ||
        (acceptable && !acceptable(*stored))) {
      return false;
    }
    record = std::move(stored);
    return true;
  }
};

using Jobs = std::vector<std::unique_ptr<Job>>;

/// A fixed number of threads that work through jobs, longest first.
class Pool {
 public:
  Pool(std::vector<Job*> jobs, int threads, const Execute& execute)
      : jobs_(std::move(jobs)), threads_(threads), execute_(execute), done_(jobs_.size()) {
    std::stable_sort(jobs_.begin(), jobs_.end(),
                     [](const Job* a, const Job* b) { return a->estimate > b->estimate; });
  }

  /// Returns when every job is done or a stop was asked for. Throws what storing a record threw.
  void run() {
    if (jobs_.empty()) return;
    Progress progress;
    {
      working_ = threads_;
      std::vector<std::jthread> threads;
      for (int i = 0; i < threads_; ++i) threads.emplace_back([this] { work(); });
      std::unique_lock lock(mutex_);
      while (!idle_.wait_for(lock, std::chrono::milliseconds(200), [&] { return working_ == 0; })) {
        draw(progress);
      }
    }
    if (error_) std::rethrow_exception(error_);
  }

 private:
  bool stopping() const { return stop_asked || broken_; }

  void draw(Progress& progress) const {
    double estimated = 0.0, updates = 0.0, progressed = 0.0;
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      const auto steps = static_cast<double>(jobs_[i]->particle_steps.load());
      estimated += jobs_[i]->estimate;
      updates += steps;
      progressed += done_[i] ? jobs_[i]->estimate : std::min(steps, jobs_[i]->estimate);
    }
    progress.draw(progressed / estimated,
                  fmt::format("{}/{} runs  {:.2g} particle-updates/s", finished_.load(), jobs_.size(),
                              updates / std::max(progress.elapsed(), 1e-3)));
  }

  void work() {
    for (std::size_t i = next_++; i < jobs_.size() && !stopping(); i = next_++) {
      try {
        do_job(*jobs_[i]);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!error_) error_ = std::current_exception();
        broken_ = true;
      }
      done_[i] = true;
      ++finished_;
    }
    const std::lock_guard lock(mutex_);
    if (--working_ == 0) idle_.notify_all();
  }

  void do_job(Job& job) {
    std::optional<Record> record = executed(job);
    if (!record) return;
    record->threads = threads_;
    record->step_threads = step_threads_of(job);
    if (record->failure.empty()) write_atomically(job.file, file_text_of(*record));
    job.record = std::move(record);
  }

  /// The run's record; one that tells why when the run threw; nothing when it was abandoned.
  std::optional<Record> executed(Job& job) {
    const Pulse pulse = [&](std::int64_t particle_steps) {
      job.particle_steps += particle_steps;
      return !stopping();
    };
    try {
      RunRequest request = job.request();
      request.threads = step_threads_of(job);
      return execute_(*job.definition, request, pulse);
    } catch (const Abandoned&) {
      return std::nullopt;
    } catch (const std::exception& error) {
      return failed(job, error.what());
    } catch (...) {
      return failed(job, "an exception that says nothing about itself");
    }
  }

  /// Threads that would have nothing to do share the steps of the runs there are.
  int step_threads_of(const Job& job) const {
    return job.step_threads > 0 ? job.step_threads : std::max(1, threads_ / static_cast<int>(jobs_.size()));
  }

  static Record failed(const Job& job, const std::string& reason) {
    Record record;
    record.case_id = job.definition->id;
    record.input_hash = input_hash(*job.definition, job.request());
    record.program_hash = program_hash();
    record.revision = build_facts().revision;
    record.failure = reason.empty() ? "an exception without a text" : reason;
    record.outcome.ending = Ending::not_at_rest;
    return record;
  }

  std::vector<Job*> jobs_;
  int threads_;
  const Execute& execute_;
  std::vector<std::atomic<bool>> done_;
  std::atomic<std::size_t> next_{0}, finished_{0};
  std::atomic<bool> broken_{false};
  std::mutex mutex_;
  std::condition_variable idle_;
  int working_ = 0;
  std::exception_ptr error_;
};

std::vector<Job*> unfinished(const Jobs& jobs, int pool_size) {
  std::vector<Job*> rest;
  for (const auto& job : jobs) {
    if (!job->record && job->pool_size == pool_size) rest.push_back(job.get());
  }
  return rest;
}

// ---- the campaign ----

class Campaign {
 public:
  Campaign(const std::vector<Case>& cases, const CampaignOptions& options, const Execute& execute,
           const TimeSteps& time_steps)
      : cases_(cases),
        options_(options),
        execute_(execute),
        timekeeper_{program_hash(), processor_name(), core_count(), time_steps} {
    if (options.threads < 1) throw std::invalid_argument("a campaign needs at least one thread");
    std::set<std::string> ids;
    for (const Case& definition : cases) {
      if (!ids.insert(definition.id).second) {
        throw std::invalid_argument("two cases have the id " + definition.id + ": the second is " +
                                    definition.file.string());
      }
    }
  }

  std::vector<CaseVerdict> run() {
    const StopOnSignal stop_on_signal;
    plan_runs();
    execute(jobs_, {options_.threads});
    plan_repeats();
    execute(repeats_, {1, 2});
    collect_records();
    time_trades();
    return judged();
  }

  int reused() const { return reused_; }
  double timing_seconds() const { return timing_seconds_; }

 private:
  bool left_out(const Case& definition) const { return options_.quick && !definition.quick; }

  void plan_runs() {
    for (const Case& definition : cases_) {
      if (left_out(definition)) continue;
      std::filesystem::create_directories(record_file(options_.out, definition, 0).parent_path());
      if (definition.repeat_on_other_threads) repeats_planned_ += definition.runs.size();
      repeats_planned_ += definition.repeat_on_threads.size() * definition.runs.size();
      for (std::size_t run = 0; run < definition.runs.size(); ++run) {
        const auto file = record_file(options_.out, definition, run);
        jobs_.push_back(std::make_unique<Job>(definition, run, file, options_.threads));
        reused_ += jobs_.back()->reuse();
      }
    }
  }

  void plan_repeats() {
    for (const auto& first : jobs_) {
      if (!first->record->failure.empty()) continue;
      for (const int threads : first->definition->repeat_on_threads) plan_repeat_on(threads, *first);
      if (!first->definition->repeat_on_other_threads) continue;
      const int other_size = first->record->threads == 1 ? 2 : 1;
      const auto file = record_file(options_.out, *first->definition, first->run, true);
      repeats_.push_back(std::make_unique<Job>(*first->definition, first->run, file, other_size));
      repeats_.back()->step_threads = first->record->step_threads == 1 ? 2 : 1;
      reused_ += repeats_.back()->reuse([&](const Record& r) {
        return r.threads != first->record->threads && r.step_threads != first->record->step_threads;
      });
    }
  }

  void plan_repeat_on(int threads, const Job& first) {
    const auto file = record_file(options_.out, *first.definition, first.run, true, threads);
    repeats_.push_back(std::make_unique<Job>(*first.definition, first.run, file, 1));
    repeats_.back()->step_threads = threads;
    repeats_.back()->listed = true;
    reused_ += repeats_.back()->reuse([&](const Record& r) { return r.step_threads == threads; });
  }

  void execute(const Jobs& jobs, std::initializer_list<int> pool_sizes) {
    for (int pool_size : pool_sizes) Pool(unfinished(jobs, pool_size), pool_size, execute_).run();
    const auto done = [](const std::unique_ptr<Job>& job) { return job->record.has_value(); };
    if (std::all_of(jobs.begin(), jobs.end(), done)) return;
    const auto stored = std::count_if(jobs_.begin(), jobs_.end(), done) +
                        std::count_if(repeats_.begin(), repeats_.end(), done);
    throw Interrupted(
        fmt::format("interrupted: {} of {} runs are stored in {}; the same command continues there", stored,
                    jobs_.size() + repeats_planned_, (options_.out / "records").string()));
  }

  void collect_records() {
    std::map<std::pair<const Case*, std::size_t>, Record*> first;
    for (const auto& job : jobs_) first[{job->definition, job->run}] = &*job->record;
    for (const auto& repeat : repeats_) {
      Record& record = *first.at({repeat->definition, repeat->run});
      const std::string& digest = repeat->record->digest;
      if (repeat->listed)
        record.repeats.emplace_back(repeat->step_threads, digest);
      else
        record.repeat_digest = digest;
    }
    for (const auto& job : jobs_) records_[job->definition].push_back(std::move(*job->record));
  }

  /// Nothing else runs meanwhile.
  void time_trades() {
    std::vector<std::pair<const Case*, CaseTiming>> timings;
    std::size_t left = 0, done = 0;
    for (const Case& definition : cases_) {
      if (definition.trades.empty() || left_out(definition)) continue;
      const auto file = timing_file(options_.out, definition);
      timings.emplace_back(&definition, CaseTiming(definition, records_[&definition], file, timekeeper_));
      left += timings.back().second.repeats_left();
    }
    Progress progress;
    for (auto& [definition, timing] : timings) {
      const bool finished = timing.run([&] {
        ++done;
        progress.draw(static_cast<double>(done) / static_cast<double>(left),
                      fmt::format("{}/{} timed", done, left));
        return !stop_asked;
      });
      if (!finished)
        throw Interrupted(fmt::format(
            "interrupted: all runs are stored, and the rounds of timing that were finished are in {}; "
            "the same command continues there",
            (options_.out / "timings").string()));
      timings_[definition] = timing.timings();
    }
    if (left > 0) timing_seconds_ = progress.elapsed();
  }

  std::vector<CaseVerdict> judged() {
    std::vector<CaseVerdict> verdicts;
    for (const Case& definition : cases_) {
      verdicts.push_back(left_out(definition) ? not_run(definition, "not part of the quick selection")
                                              : judge_case(definition, std::move(records_[&definition]),
                                                           judge, timings_[&definition]));
    }
    judge_advice(verdicts);
    return verdicts;
  }

  static CaseVerdict not_run(const Case& definition, const std::string& reason) {
    CaseVerdict verdict;
    verdict.definition = definition;
    verdict.status = CaseStatus::not_run;
    verdict.not_run_reason = reason;
    return verdict;
  }

  const std::vector<Case>& cases_;
  const CampaignOptions& options_;
  const Execute& execute_;
  Timekeeper timekeeper_;
  Jobs jobs_, repeats_;
  std::map<const Case*, std::vector<Record>> records_;
  std::map<const Case*, Timings> timings_;
  double timing_seconds_ = 0.0;
  std::size_t repeats_planned_ = 0;
  int reused_ = 0;
};

// ---- provenance ----

std::string host_name() {
  utsname system{};
  return ::uname(&system) == 0 ? system.nodename : "unknown";
}

double extent_in_particles(const Body& body, std::size_t axis, double cell_size) {
  return (body.upper[axis] - body.lower[axis]) / cell_size * body.particles_per_cell[axis];
}

double time_step_of(const Scene& scene) {
  if (const auto* given = std::get_if<GivenTimeStep>(&scene.time_step)) return given->seconds;
  double fastest = 0.0;
  for (const Body& body : scene.bodies) {
    const double modulus =
        std::visit([](const auto& material) { return material.youngs_modulus; }, body.material);
    fastest = std::max(fastest, std::sqrt(modulus / body.lightest()));
  }
  return std::get<StableFraction>(scene.time_step).fraction * scene.cell_size / fastest;
}

}  // namespace

CampaignVerdict run_campaign(const std::vector<Case>& cases, const CampaignOptions& options,
                             const Execute& execute, const TimeSteps& time_steps) {
  const auto start = Clock::now();
  CampaignVerdict verdict;
  verdict.revision = build_facts().revision;
  verdict.compiler = build_facts().compiler;
  verdict.build = build_facts().build;
  verdict.host = host_name();
  verdict.processor = processor_name();
  verdict.date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  verdict.threads = options.threads;
  verdict.quick = options.quick;
  Campaign campaign(cases, options, execute, time_steps);
  verdict.cases = campaign.run();
  verdict.reused = campaign.reused();
  verdict.timing_seconds = campaign.timing_seconds();
  verdict.wall_seconds = seconds_since(start);
  return verdict;
}

std::filesystem::path record_file(const std::filesystem::path& out, const Case& definition, std::size_t run,
                                  bool repeat, int step_threads) {
  std::string name = "run";
  if (run < definition.runs.size()) {
    name = slug_of(definition.runs[run]);
    const auto namesakes = std::count_if(definition.runs.begin(), definition.runs.end(),
                                         [&](const RunRequest& other) { return slug_of(other) == name; });
    if (namesakes > 1) name += fmt::format("-{}", run);
  }
  if (repeat) name += ".repeat";
  if (step_threads > 0) name += fmt::format("-{}", step_threads);
  return out / "records" / definition.id / (name + ".json");
}

double estimated_particle_steps(const Scene& scene) {
  double particles = 0.0;
  for (const Body& body : scene.bodies) {
    double of_body = 1.0;
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimension); ++axis) {
      of_body *= extent_in_particles(body, axis, scene.cell_size);
    }
    particles += of_body;
  }
  const double estimate = particles * latest_end(scene) / time_step_of(scene);
  return std::isfinite(estimate) ? std::max(1.0, estimate) : 1.0;
}

}  // namespace mpm::vv
