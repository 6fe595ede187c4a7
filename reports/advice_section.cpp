#include "reports/advice_section.hpp"

#include "reports/figures.hpp"

namespace mpm::reports {
namespace {

std::string percent(double ratio) { return number_markup(100.0 * ratio, 2) + "\u00a0%"; }

std::string chip_of(const vv::AdviceTrial& trial) {
  if (trial.no_offer) return chip("open", "nothing meets it");
  if (!trial.lack.empty()) return chip("fail", "not tested");
  return trial.kept ? chip("pass", "kept") : chip("fail", "broken");
}

PageData row_of(const vv::AdviceTrial& trial) {
  return object({{"problem", trial.problem.empty() ? "" : name_of_run(trial.problem)},
                 {"title", trial.title},
                 {"asked", percent(trial.asked)},
                 {"drawn_from", trial.drawn_from + (trial.between ? ", between" : "")},
                 {"configuration", trial.configuration.empty() ? "" : name_of_run(trial.configuration)},
                 {"promised", percent(trial.promised)},
                 {"found", percent(trial.found)},
                 {"regret", number_markup(trial.regret, 3)},
                 {"chip", chip_of(trial)},
                 {"lack", trial.no_offer ? "" : trial.lack}});
}

}  // namespace

void set_advice(PageData& section, const vv::CaseVerdict& verdict) {
  if (!verdict.advice) return;
  PageData advice = object({{"of", verdict.advice->of}, {"lack", verdict.advice->lack}});
  advice.set("own", flag(verdict.advice->own));
  PageData trials = list();
  for (const vv::AdviceTrial& trial : verdict.advice->trials) trials << row_of(trial);
  set_list(advice, "trials", trials);
  section.set("advice", advice);
}

}  // namespace mpm::reports
