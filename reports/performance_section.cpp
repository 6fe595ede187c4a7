#include "reports/performance_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

#include "reports/figures.hpp"
#include "reports/page_data.hpp"
#include "reports/performance_figures.hpp"

namespace mpm::reports {

std::string_view performance_template();

namespace {

constexpr std::size_t longest_open_table = 12;  // rows; longer ones are looked up, not read

using Steps = std::vector<const StepRate*>;

std::string spaced(std::string text) {
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

std::string millions(double rate) { return number_markup(rate / 1e6); }

std::string from_to(const Measured& value, double unit, int digits = 3) {
  return number_markup(value.low / unit, digits) + "\u00a0–\u00a0" + number_markup(value.high / unit, digits);
}

std::string if_any(const std::optional<double>& value) { return value ? number_markup(*value) : "–"; }

std::string percent(const std::optional<double>& share) {
  return share ? number_markup(100.0 * *share, 2) + " %" : "–";
}

std::string cores_text(int cores) { return fmt::format("{} core{}", cores, cores == 1 ? "" : "s"); }

std::string instructions_text(bool native) {
  return native ? "all instructions of the machine" : "instructions common to such machines";
}

// ---- where it was measured ----

/// What is to be said of a fact that is not the report's own; nothing when it is.
std::string difference(const std::string& measured, const std::string& reported) {
  if (reported.empty() || measured == reported) return "";
  return "the rest of this report is of " + reported;
}

std::string revision_remark(const Performance& measured, const vv::CampaignVerdict& verdict) {
  const bool differs = !verdict.revision.empty() && measured.full_revision() != verdict.revision;
  if (differs) return "not the revision of this report, " + verdict.revision;
  if (measured.modified) return "with changes that no revision holds";
  return "";
}

void set_facts(PageData& page, const Performance& measured, const vv::CampaignVerdict& verdict) {
  const std::string remark = revision_remark(measured, verdict);
  for (const auto& [key, value] : std::vector<std::pair<std::string, std::string>>{
           {"repetitions", std::to_string(measured.repetitions)},
           {"seconds_each", number_markup(measured.seconds_each, 0)},
           {"noise", number_markup(100.0 * measured.noise, 2) + "\u00a0%"},
           {"revision", measured.full_revision()},
           {"date", measured.date},
           {"processor", measured.processor},
           {"cores", cores_text(measured.cores)},
           {"compiler", measured.compiler},
           {"instructions", instructions_text(measured.native)},
           {"file", measured.file.filename().string()}})
    page.set(key, value);
  const PageData remarks = object({{"revision_remark", remark},
                                   {"processor_remark", difference(measured.processor, verdict.processor)},
                                   {"compiler_remark", difference(measured.compiler, verdict.compiler)}});
  for (const char* key : {"revision_remark", "processor_remark", "compiler_remark"})
    page.set(key, *remarks.get(key));
  page.set("revision_bad", flag(!remark.empty()));
}

// ---- steps ----

PageData step_row(const StepRate& step, const std::string& name) {
  const bool near = step.target && step.rate.low <= *step.target && *step.target <= step.rate.high;
  return object({{"name", name},
                 {"rate", millions(step.rate.median)},
                 {"spread", from_to(step.rate, 1e6)},
                 {"target", step.target ? millions(*step.target) : ""},
                 {"chip", step.meets_target() ? chip("pass", "MET") : chip("contrary", "NOT MET")},
                 {"remark", near ? "within the spread" : ""},
                 {"bytes", if_any(step.bytes)},
                 {"flops", if_any(step.flops)},
                 {"bandwidth", percent(step.share_of_bandwidth)},
                 {"peak", percent(step.share_of_peak)}});
}

/// Rows under their scene, whose head says what all of its configurations share. `row` makes one of a step,
/// its number and its name.
template <class MakeRow>
PageData scene_groups(const Steps& steps, MakeRow row) {
  std::vector<std::string> scenes;
  std::map<std::string, std::vector<std::size_t>> by_scene;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (by_scene[steps[i]->scene].empty()) scenes.push_back(steps[i]->scene);
    by_scene[steps[i]->scene].push_back(i);
  }
  PageData groups = list();
  for (const std::string& scene : scenes) {
    Steps members;
    for (const std::size_t i : by_scene[scene]) members.push_back(steps[i]);
    const ConfigurationNames names = configuration_names(members);
    PageData group = object({{"scene", escaped(spaced(scene))}, {"common", names.common}});
    PageData rows = list();
    for (std::size_t k = 0; k < members.size(); ++k)
      rows << row(*members[k], by_scene[scene][k], names.own[k].empty() ? "this one" : names.own[k]);
    group.set("rows", rows);
    groups << group;
  }
  return groups;
}

std::string target_sentence(const Steps& with_target) {
  const auto met = std::count_if(with_target.begin(), with_target.end(),
                                 [](const StepRate* step) { return step->meets_target(); });
  return fmt::format("{} of {} target{} {} met.", met, with_target.size(), with_target.size() == 1 ? "" : "s",
                     met == 1 ? "is" : "are");
}

void set_steps(PageData& page, const Performance& measured) {
  Steps with_target, others;
  for (const StepRate& step : measured.steps) (step.target ? with_target : others).push_back(&step);
  const auto row = [](const StepRate& step, std::size_t, const std::string& name) {
    return step_row(step, name);
  };
  page.set("target_sentence", target_sentence(with_target));
  set_list(page, "targets", scene_groups(with_target, row));
  set_list(page, "others", scene_groups(others, row));
  page.set("others_folded", flag(others.size() > longest_open_table));
  page.set("other_count", std::to_string(others.size()));
}

// ---- the rest ----

/// A unit that makes a limit a number to read.
std::pair<double, std::string> readable_unit(const std::string& unit) {
  if (unit == "particles/s") return {1e6, "10<sup>6</sup> particles/s"};
  return {1e9, unit == "B/s" ? "GB/s" : "Gflop/s"};
}

void set_limits(PageData& page, const Performance& measured) {
  PageData rows = list();
  for (const Limit& limit : measured.limits) {
    const auto [unit, name] = readable_unit(limit.unit);
    rows << object({{"title", limit.title},
                    {"value", number_markup(limit.value.median / unit)},
                    {"spread", from_to(limit.value, unit)},
                    {"unit", name}});
  }
  set_list(page, "limits", rows);
}

void set_kernels(PageData& page, const Performance& measured) {
  PageData rows = list();
  for (const KernelRate& kernel : measured.kernels)
    rows << object({{"name", kernel.name},
                    {"rate", millions(kernel.rate.median)},
                    {"spread", from_to(kernel.rate, 1e6)}});
  set_list(page, "kernels", rows);
}

void set_runs(PageData& page, const Performance& measured) {
  PageData rows = list();
  for (const TimedRun& run : measured.runs)
    rows << object({{"title", run.title},
                    {"threads", std::to_string(run.threads)},
                    {"seconds", number_markup(run.seconds)},
                    {"particles", count_markup(run.particles)},
                    {"steps", count_markup(run.steps)},
                    {"particle_steps", number_markup(run.particle_steps())},
                    {"rate", millions(run.rate())},
                    {"settlement", run.settlement ? number_markup(*run.settlement * 1e3) : "–"},
                    {"ending", spaced(run.ending)}});
  set_list(page, "runs", rows);
}

void set_memory_and_start_up(PageData& page, const Performance& measured) {
  PageData memory = list(), start_up = list();
  for (const MemoryUse& use : measured.memory) {
    // A step's words, without those that a state in memory does not have.
    StepRate like;
    like.scheme = use.scheme;
    like.law = use.law;
    like.precision = use.precision;
    const std::vector<std::string> words = configuration(like);
    memory << object(
        {{"name", fmt::format("{}, {}, {}, {}", escaped(spaced(use.scene)), words[0], words[2], words[3])},
         {"particles", count_markup(use.particles)},
         {"bytes", number_markup(use.bytes_per_particle)}});
  }
  for (const StartUp& entry : measured.start_up)
    start_up << object(
        {{"scene", escaped(spaced(entry.scene))}, {"milliseconds", number_markup(entry.seconds * 1e3)}});
  set_list(page, "memory", memory);
  set_list(page, "start_up", start_up);
}

// ---- features ----

double per_particle_step(const FeatureCost& cost) { return cost.per_particle(cost.step.median); }

double bytes_per_particle(const FeatureCost& cost) {
  return cost.per_particle(static_cast<double>(cost.bytes));
}

std::string verdict_chip(const SpelledDefault& spelled) {
  if (spelled.verdict == "within_limit") return chip("pass", "WITHIN 2 %");
  if (spelled.verdict == "within_noise") return chip("open", "WITHIN NOISE");
  return chip("contrary", "BEYOND 2 %");
}

/// What saying the default comes to; texts that are empty where it cannot be said.
void set_spelled(PageData& row, const FeaturePrice& feature) {
  row.set("spelled", flag(feature.spelled.has_value()));
  if (!feature.spelled) return;
  const SpelledDefault& spelled = *feature.spelled;
  const std::int64_t more = spelled.bytes - (spelled.of_with ? feature.with : feature.without).bytes;
  row.set("said", spelled.what);
  row.set("said_ratio", number_markup(spelled.ratio.median, 4));
  row.set("said_spread", from_to(spelled.ratio, 1.0, 4));
  row.set("said_chip", verdict_chip(spelled));
  row.set("said_bytes", more == 0 ? "equal" : fmt::format("{:+}", more));
  row.set("bytes_bad", flag(more != 0));
  row.set("said_bits", spelled.same_bits ? "the same" : "others");
  row.set("bits_bad", flag(!spelled.same_bits));
}

/// "2 of 9 defaults ..."; nothing without defaults that can be said.
std::string free_sentence(const std::vector<FeaturePrice>& features) {
  std::size_t said = 0, free = 0, within = 0, noisy = 0;
  for (const FeaturePrice& feature : features) {
    if (!feature.spelled) continue;
    const SpelledDefault& spelled = *feature.spelled;
    ++said;
    if (spelled.same_bits && spelled.bytes == (spelled.of_with ? feature.with : feature.without).bytes)
      ++free;
    if (spelled.verdict == "within_limit") ++within;
    if (spelled.verdict == "within_noise") ++noisy;
  }
  if (said == 0) return "";
  return fmt::format(
      "{} of {} defaults that were said left every bit and byte as it was; {} took at most 2 % more time, "
      "and "
      "of {} the noise of this measurement does not let that be told.",
      free, said, within, noisy);
}

void set_features(PageData& page, const Performance& measured) {
  PageData rows = list();
  for (const FeaturePrice& feature : measured.features) {
    PageData row = object({{"title", feature.title},
                           {"without", feature.without.what},
                           {"with", feature.with.what},
                           {"before", number_markup(1e9 * per_particle_step(feature.without))},
                           {"after", number_markup(1e9 * per_particle_step(feature.with))},
                           {"ratio", number_markup(feature.ratio.median)},
                           {"spread", from_to(feature.ratio, 1.0)},
                           {"of_time", number_markup(feature.ratio_of_time())},
                           {"bytes_before", number_markup(bytes_per_particle(feature.without))},
                           {"bytes_after", number_markup(bytes_per_particle(feature.with))}});
    set_spelled(row, feature);
    rows << row;
  }
  page.set("free_sentence", free_sentence(measured.features));
  set_list(page, "features", rows);
}

void set_lacks(PageData& page, const Performance& measured) {
  PageData lacks = list();
  const auto say_if = [&lacks](bool lacking, const char* what) {
    if (lacking) lacks << object({{"text", what}});
  };
  say_if(measured.steps.empty(), "No whole step was measured, so that there are no rates.");
  say_if(!measured.steps.empty() && !size_figure(measured),
         "No configuration was measured at several numbers of particles: how rates change with size is "
         "unknown.");
  say_if(!measured.steps.empty() && !roofline_figure(measured),
         "No roofline: it takes steps on one thread with counted bytes and operations, a measured bandwidth "
         "and a "
         "measured peak.");
  say_if(thread_pairs(measured).empty(),
         "No configuration was measured on one thread and on several: what threads gain is unknown.");
  say_if(precision_pairs(measured).empty(),
         "No configuration was measured in both precisions: what single precision gains is unknown.");
  say_if(measured.runs.empty(), "No whole run was timed.");
  say_if(measured.limits.empty(), "The limits of the machine were not measured.");
  say_if(measured.kernels.empty(), "No kernel was measured by itself.");
  say_if(measured.memory.empty(), "Memory was not measured.");
  say_if(measured.start_up.empty(), "Start-up was not measured.");
  say_if(measured.features.empty(), "What features cost was not measured.");
  set_list(page, "lacks", lacks);
}

// ---- before and after ----

void set_common_steps(PageData& entry, const Performance& before, const Performance& after) {
  const std::vector<StepPair> pairs = common_steps(before, after);
  Steps steps;
  for (const StepPair& pair : pairs) steps.push_back(pair.other);
  const auto row = [&pairs](const StepRate& step, std::size_t i, const std::string& name) {
    const Measured gain = ratio(step.rate, pairs[i].one->rate);
    return object({{"name", name},
                   {"before", millions(pairs[i].one->rate.median)},
                   {"after", millions(step.rate.median)},
                   {"ratio", number_markup(gain.median)},
                   {"spread", from_to(gain, 1.0)}});
  };
  set_list(entry, "steps", scene_groups(steps, row));
  entry.set("folded", flag(pairs.size() > longest_open_table));
  entry.set("count", std::to_string(pairs.size()));
}

void set_common_runs(PageData& entry, const Performance& before, const Performance& after) {
  PageData rows = list();
  for (const TimedRun& run : after.runs)
    for (const TimedRun& earlier : before.runs)
      if (earlier.name == run.name && earlier.threads == run.threads)
        rows << object({{"title", run.title},
                        {"threads", std::to_string(run.threads)},
                        {"before", number_markup(earlier.seconds)},
                        {"after", number_markup(run.seconds)},
                        {"steps_before", count_markup(earlier.steps)},
                        {"steps_after", count_markup(run.steps)},
                        {"ratio", number_markup(earlier.seconds / run.seconds)}});
  set_list(entry, "runs", rows);
}

PageData figure_entries(const std::vector<DrawnPerformanceFigure>& figures,
                        std::optional<std::size_t> history, int& number) {
  PageData entries = list();
  for (const DrawnPerformanceFigure& figure : figures) {
    if (figure.history != history) continue;
    entries << object({{"anchor", "performance-" + figure.drawn.figure_id},
                       {"png", base64(figure.drawn.png)},
                       {"width", std::to_string(figure.drawn.pixel_width / 2)},
                       {"alt", "performance, " + figure.drawn.figure_id},
                       {"failure", figure.drawn.failure},
                       {"number", std::to_string(number++)},
                       {"caption", figure.caption}});
  }
  return entries;
}

/// Whether machine and build are the same, as far as the files tell.
bool comparable(const Performance& a, const Performance& b) {
  return a.processor == b.processor && a.cores == b.cores && a.compiler == b.compiler && a.native == b.native;
}

/// The latest first.
PageData history_entries(const PerformanceEvidence& evidence,
                         const std::vector<DrawnPerformanceFigure>& figures, int& number) {
  PageData entries = list();
  for (std::size_t i = evidence.history.size(); i-- > 0;) {
    const Performance& before = evidence.history[i];
    PageData entry = object({{"revision", before.full_revision()},
                             {"date", before.date},
                             {"processor", before.processor},
                             {"cores", cores_text(before.cores)},
                             {"compiler", before.compiler},
                             {"instructions", instructions_text(before.native)},
                             {"file", before.file.filename().string()}});
    entry.set("other_machine", flag(!comparable(before, *evidence.measured)));
    set_common_steps(entry, before, *evidence.measured);
    set_common_runs(entry, before, *evidence.measured);
    entry.set("figures", figure_entries(figures, i, number));
    entries << entry;
  }
  return entries;
}

// ---- pictures ----

DrawnPerformanceFigure drawn(const PerformanceFigure& figure, std::optional<std::size_t> history) {
  DrawnPerformanceFigure result{{"performance", figure.id, "", 0, ""}, figure.caption, history};
  try {
    const Picture picture = draw(figure);
    const std::vector<unsigned char> png = picture.canvas.png();
    result.drawn.png.assign(png.begin(), png.end());
    result.drawn.pixel_width = picture.canvas.pixel_width();
  } catch (const std::exception& error) {
    result.drawn.failure = error.what();
  }
  return result;
}

}  // namespace

std::vector<DrawnPerformanceFigure> draw_performance_figures(const PerformanceEvidence& evidence) {
  std::vector<DrawnPerformanceFigure> figures;
  if (!evidence.measured) return figures;
  const Performance& measured = *evidence.measured;
  for (const PerformanceFigure& figure : rate_figures(measured))
    figures.push_back(drawn(figure, std::nullopt));
  for (const auto& figure : {size_figure(measured), roofline_figure(measured), ratio_figure(measured)})
    if (figure) figures.push_back(drawn(*figure, std::nullopt));
  for (std::size_t i = evidence.history.size(); i-- > 0;)
    for (const PerformanceFigure& figure : history_figures(evidence.history[i], measured))
      figures.push_back(drawn(figure, i));
  return figures;
}

std::string performance_section(const PerformanceEvidence& evidence, const vv::CampaignVerdict& verdict,
                                const std::vector<DrawnPerformanceFigure>& figures, int& number) {
  PageData page = object({{"failure", evidence.failure}});
  page.set("nothing", flag(!evidence.measured && evidence.failure.empty()));
  page.set("measured", flag(evidence.measured.has_value()));
  if (evidence.measured) {
    set_facts(page, *evidence.measured, verdict);
    set_steps(page, *evidence.measured);
    set_limits(page, *evidence.measured);
    set_kernels(page, *evidence.measured);
    set_runs(page, *evidence.measured);
    set_memory_and_start_up(page, *evidence.measured);
    set_features(page, *evidence.measured);
    set_lacks(page, *evidence.measured);
    set_list(page, "figures", figure_entries(figures, std::nullopt, number));
    page.set("history", history_entries(evidence, figures, number));
  }
  return rendered(performance_template(), page);
}

}  // namespace mpm::reports
