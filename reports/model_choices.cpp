#include "reports/model_choices.hpp"

#include <fmt/format.h>

#include <cmath>

#include "reports/figures.hpp"
#include "vv/model_difference.hpp"

namespace mpm::reports {
namespace {

/// "×6.0" of what less there was to do; a dash if that is not known.
std::string saving_markup(double written, double used) {
  return written > 0.0 && used > 0.0 ? fmt::format("×{:.3g}", written / used) : "–";
}

/// How much less was done, in particle-steps: against the run as written or, without one, by the particles
/// alone.
std::string work_saved(const vv::RunVerdict& run, const vv::ModelChoice& choice,
                       const vv::RunVerdict* written) {
  if (written) {
    return saving_markup(static_cast<double>(written->record.cost.particle_steps),
                         static_cast<double>(run.record.cost.particle_steps));
  }
  const auto before = choice.numbers.find("particles_written"), after = choice.numbers.find("particles_used");
  if (before == choice.numbers.end() || after == choice.numbers.end()) return "–";
  return saving_markup(before->second, after->second);
}

std::string memory_saved(const vv::RunVerdict& run, const vv::RunVerdict* written) {
  if (!written) return "–";
  return saving_markup(static_cast<double>(written->record.cost.memory_bytes),
                       static_cast<double>(run.record.cost.memory_bytes));
}

/// Each number the choice rests on: "name 1.2 · name 3".
std::string numbers_markup(const vv::ModelChoice& choice) {
  std::string text;
  for (const auto& [name, value] : choice.numbers) {
    std::string words = name;
    for (char& letter : words) letter = letter == '_' ? ' ' : letter;
    text += fmt::format("{}{} {}", text.empty() ? "" : " · ", words, number_markup(value));
  }
  return text;
}

PageData row_of(const vv::CaseVerdict& verdict, const vv::RunVerdict& run, const vv::ModelChoice& choice) {
  const vv::RunVerdict* written = run_as_written(verdict, run, choice);
  const auto difference =
      written ? model_difference(run.record, written->record) : std::optional<vv::ModelDifference>();
  return object({{"name", name_of_run(run.parameters)},
                 {"what", choice.what},
                 {"written", choice.written},
                 {"used", choice.used},
                 {"reason", choice.reason},
                 {"numbers", numbers_markup(choice)},
                 {"work", work_saved(run, choice, written)},
                 {"memory", memory_saved(run, written)},
                 {"displacement", difference ? number_markup(difference->displacement, 2) : "–"},
                 {"stress", difference ? number_markup(difference->stress, 2) : "–"}});
}

}  // namespace

void set_model_choices(PageData& section, const vv::CaseVerdict& verdict) {
  PageData rows = list();
  for (const vv::RunVerdict& run : verdict.runs) {
    for (const vv::ModelChoice& choice : run.record.model)
      if (choice.picked()) rows << row_of(verdict, run, choice);
  }
  set_list(section, "model_choices", rows);
}

}  // namespace mpm::reports
