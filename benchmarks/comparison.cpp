#include "benchmarks/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace mpm::bench {
namespace {

/// A name with its rate.
struct Named {
  std::string name;
  Measured rate;
};

std::vector<Named> rates_of(const Results& results) {
  std::vector<Named> all;
  for (const StepResult& step : results.steps) all.push_back({step.name, step.rate});
  for (const KernelResult& kernel : results.kernels) all.push_back({kernel.name, kernel.rate});
  return all;
}

std::vector<Named> limits_of(const Results& results) {
  std::vector<Named> all;
  for (const Limit& limit : results.limits) all.push_back({limit.name, limit.rate});
  return all;
}

const Named* find(const std::vector<Named>& all, const std::string& name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Named& each) { return each.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::vector<Compared> in_both(const std::vector<Named>& before, const std::vector<Named>& after) {
  std::vector<Compared> both;
  for (const Named& old : before) {
    if (const Named* now = find(after, old.name)) {
      both.push_back({old.name, old.rate, now->rate, change_of(old.rate, now->rate)});
    }
  }
  return both;
}

std::vector<std::string> names_only_in(const std::vector<Named>& these, const std::vector<Named>& others) {
  std::vector<std::string> names;
  for (const Named& each : these) {
    if (!find(others, each.name)) names.push_back(each.name);
  }
  return names;
}

std::vector<std::string> differences(const Results& before, const Results& after) {
  std::vector<std::string> found;
  const auto tell = [&](const char* what, const std::string& old, const std::string& now) {
    if (old != now) found.push_back(fmt::format("{} differs: {} before, {} after", what, old, now));
  };
  const auto machine = [](const Results& of) {
    return fmt::format("{} with {} cores", of.processor, of.cores);
  };
  const auto instructions = [](const Results& of) {
    return std::string(of.native ? "those of the machine" : "portable");
  };
  const auto effort = [](const Results& of) {
    return fmt::format("{} repetitions of {} s", of.repetitions, of.seconds_each);
  };
  tell("the machine", machine(before), machine(after));
  tell("the compiler", before.compiler, after.compiler);
  tell("the instruction set", instructions(before), instructions(after));
  tell("the effort", effort(before), effort(after));
  return found;
}

const char* word_of(Change change) {
  return change == Change::faster ? "faster" : change == Change::slower ? "SLOWER" : "unchanged";
}

std::string row_of(const Compared& compared) {
  const auto rate = [](const Measured& measured) {
    return fmt::format("{:9.4g} ± {:4.1f} %", measured.value / 1e6, 100 * measured.spread());
  };
  return fmt::format("  {:<52} {} {} {:6.3f} x  {}\n", compared.name, rate(compared.before),
                     rate(compared.after), compared.ratio(), word_of(compared.change));
}

}  // namespace

Change change_of(const Measured& before, const Measured& after) {
  const bool apart = after.low > before.high || after.high < before.low;
  const double noise = std::max(before.half_width(), after.half_width());
  if (!apart || std::abs(after.value - before.value) <= noise) return Change::unchanged;
  return after.value > before.value ? Change::faster : Change::slower;
}

bool Comparison::has_slower() const {
  return std::any_of(rates.begin(), rates.end(),
                     [](const Compared& compared) { return compared.change == Change::slower; });
}

Comparison compare(const Results& before, const Results& after) {
  const std::vector<Named> old = rates_of(before), now = rates_of(after);
  return {.circumstances = differences(before, after),
          .limits = in_both(limits_of(before), limits_of(after)),
          .rates = in_both(old, now),
          .only_before = names_only_in(old, now),
          .only_after = names_only_in(now, old)};
}

std::string text_of(const Comparison& comparison) {
  std::string text =
      fmt::format("  {:<52} {:>18} {:>18} {:>8}   (millions a second)\n", "", "before", "after", "ratio");
  for (const std::string& line : comparison.circumstances) text += "note: " + line + "\n";
  for (const Compared& limit : comparison.limits) text += row_of(limit);
  for (const Compared& rate : comparison.rates) text += row_of(rate);
  for (const std::string& name : comparison.only_before) text += fmt::format("  {:<52} only before\n", name);
  for (const std::string& name : comparison.only_after) text += fmt::format("  {:<52} only after\n", name);
  const auto count = [&](Change change) {
    return std::count_if(comparison.rates.begin(), comparison.rates.end(),
                         [&](const Compared& compared) { return compared.change == change; });
  };
  text += fmt::format("beyond noise: {} faster, {} slower, {} unchanged; the machine's limits do not count\n",
                      count(Change::faster), count(Change::slower), count(Change::unchanged));
  return text;
}

}  // namespace mpm::bench
