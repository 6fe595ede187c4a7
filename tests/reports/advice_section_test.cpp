#include <gtest/gtest.h>

#include "reports/document.hpp"
#include "tests/support/demo_verdict.hpp"

namespace mpm::reports {
namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Advice with one promise kept, one broken, one that could not be tested, and one that was not made.
vv::AdviceVerdict demo_advice() {
  vv::AdviceVerdict advice{.of = "other_case"};
  vv::AdviceTrial trial{.title = "stress <of> it", .problem = {{"/scene/gravity/level", 20}}, .asked = 0.02};
  trial.drawn_from = "1G and 50G";
  trial.between = true;
  trial.configuration = {{"/scene/scheme", "ugimp"}};
  trial.promised = 0.017;
  trial.found = 0.011;
  trial.regret = 1.25;
  trial.kept = true;
  advice.trials.push_back(trial);
  trial.found = 0.034;
  trial.kept = false;
  advice.trials.push_back(trial);
  trial.lack = "the configuration was not run here";
  advice.trials.push_back(trial);
  trial.lack = "nothing measured meets it";
  trial.no_offer = true;
  advice.trials.push_back(trial);
  return advice;
}

TEST(AdviceSection, TellsOfEveryPromise) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  EXPECT_FALSE(has(report_html(campaign, {}), "Advice put to the test"));
  campaign.cases[0].advice = demo_advice();
  const std::string html = report_html(campaign, {});
  for (const char* part :
       {"Advice put to the test", "<a href=\"#other_case\">", "<td>20G</td>", "stress &lt;of&gt; it",
        "1G and 50G, between", "uGIMP", ">1.7\u00a0%<", ">1.1\u00a0%<", ">1.25<", ">kept<", ">3.4\u00a0%<",
        ">broken<", ">not tested<", "the configuration was not run here", ">nothing meets it<"})
    EXPECT_TRUE(has(html, part)) << part;
  EXPECT_FALSE(has(html, "every second configuration"));
}

TEST(AdviceSection, SaysWhyThereIsNone) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  campaign.cases[0].advice = {.of = "other_case", .own = true, .lack = "case other_case was not run"};
  const std::string html = report_html(campaign, {});
  EXPECT_TRUE(has(html, "every second configuration"));
  EXPECT_TRUE(has(html, "case other_case was not run."));
  EXPECT_FALSE(has(html, "<th class=\"n\">regret</th>"));
}

}  // namespace
}  // namespace mpm::reports
