#include <gtest/gtest.h>

#include <cmath>

#include "reports/document.hpp"
#include "reports/last_good.hpp"
#include "tests/support/demo_stability.hpp"

namespace mpm::reports {
namespace {

using Class = vv::StabilityClass;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The part of the page about stability.
std::string section_of(const vv::CampaignVerdict& campaign) {
  const std::string html = report_html(campaign, {});
  const std::size_t begin = html.find("<section id=\"stability\">");
  EXPECT_NE(begin, std::string::npos);
  return html.substr(begin, html.find("</section>", begin) - begin);
}

vv::CampaignVerdict campaign_of(const vv::CaseVerdict& verdict) {
  vv::CampaignVerdict campaign;
  campaign.cases = {verdict};
  return campaign;
}

vv::GateResult class_gate(const std::string& found, const std::string& expected, bool good) {
  vv::GateResult gate;
  gate.id = "class";
  gate.metric = "class";
  gate.op = "is";
  gate.found = found;
  gate.expected = expected;
  gate.detail = found + " <somehow>";
  gate.advice = "Take smaller steps.";
  gate.status = good ? vv::GateStatus::pass : vv::GateStatus::fail;
  return gate;
}

/// Three extremes: one right, one that diverged as expected, one that rings against expectation.
vv::CaseVerdict demo_extremes() {
  vv::CaseVerdict verdict;
  verdict.definition.id = "extreme_soft";
  verdict.definition.title = "Very soft soil";
  verdict.status = vv::CaseStatus::fail;
  const std::pair<const char*, Class> found[] = {
      {"1 kPa", Class::accurate}, {"1 Pa", Class::diverged}, {"10 Pa", Class::oscillating}};
  for (const auto& [modulus, stability] : found) {
    vv::RunVerdict run;
    run.parameters = {{"modulus", modulus}};
    run.record.outcome.ending = Ending::reached_time;
    run.stability = stability;
    verdict.definition.runs.push_back({});
    verdict.runs.push_back(run);
  }
  verdict.runs[0].behaviour.signal.drift = 0.012;
  verdict.runs[0].gates = {class_gate("accurate", "accurate or inaccurate", true)};
  verdict.runs[1].record.outcome = {Ending::outside_grid, 1234, 0.5, 49, 1.04};
  verdict.runs[1].record.last_good = vv::Snapshot{"last good", 0.25, {}};
  verdict.runs[1].behaviour.failed = true;
  verdict.runs[1].gates = {class_gate("diverged", "diverged", true)};
  verdict.runs[2].behaviour.signal.ringing = 0.031;
  verdict.runs[2].gates = {class_gate("oscillating", "accurate", false)};
  return verdict;
}

/// Float in three scenes: enough, not enough, and not compared; and sums in another order with the same bits.
vv::CaseVerdict demo_rounding() {
  vv::CaseVerdict verdict;
  verdict.definition.id = "rounding_demo";
  verdict.definition.title = "Rounding";
  verdict.status = vv::CaseStatus::pass;
  verdict.definition.rounding = vv::RoundingRequest{{{"numbers", {"double"}}}, "cells"};
  for (const char* scene : {"column", "footing", "collapse"})
    for (const char* numbers : {"double", "float", "shuffled"}) {
      vv::RunVerdict run;
      run.parameters = {{"place", scene}, {"numbers", numbers}};
      verdict.runs.push_back(run);
      verdict.definition.runs.push_back({});
    }
  const auto row = [](std::size_t run, double rounding, double cells, const char* lack) {
    vv::RoundingRow made;
    made.run = run;
    made.baseline = run / 3 * 3;
    made.displacement = made.stress = rounding;
    made.digits_of_displacement = made.digits_of_stress = rounding > 0.0 ? -std::log10(rounding) : 17.0;
    made.cells_of_displacement = made.cells_of_stress = cells;
    made.share = rounding / cells;
    made.bits_equal = rounding == 0.0 && *lack == '\0';
    made.lack = lack;
    return made;
  };
  verdict.rounding = {row(1, 1e-6, 1e-3, ""),
                      row(2, 0.0, 1e-3, ""),
                      row(4, 4e-4, 1e-3, ""),
                      row(5, 0.0, 1e-3, ""),
                      row(7, 0.0, 1.0, "float <ended> early"),
                      row(8, 0.0, 1e-3, "")};
  return verdict;
}

TEST(StabilitySection, SaysThatThereIsNothing) {
  const std::string text = section_of(support::demo_campaign());
  EXPECT_TRUE(has(text, "No case of this report looks for the limits of stability."));
  EXPECT_FALSE(has(text, "<table"));
  EXPECT_TRUE(
      has(report_html(support::demo_campaign(), {}), "<a href=\"#stability\">Stability at the extremes</a>"));
}

TEST(StabilitySection, ListsTheLimitsOfEverySurvey) {
  vv::CaseVerdict verdict = support::demo_maps();
  verdict.runs.resize(12);
  verdict.definition.runs.resize(12);
  vv::Survey& first = *verdict.runs[0].record.survey;
  first.own = 0.9;
  verdict.runs[0].metrics["stability.formula"] = 0.577;
  vv::Survey& second = *verdict.runs[1].record.survey;
  second.linear.limit = 0.0;
  second.linear.lack = "too <many> unknowns";
  second.unstable = 0.0;
  const std::string text = section_of(campaign_of(verdict));
  EXPECT_TRUE(has(text, "<a href=\"#time_steps-map\">Time steps of a bar</a>"));
  EXPECT_TRUE(has(text, ">0.577<"));
  EXPECT_TRUE(has(text, "0.624\u00a0…\u00a00.663")) << text;
  EXPECT_TRUE(has(text, "top of the column"));
  EXPECT_TRUE(has(text, "take at most 0.15, 0.17 of its own: beyond it is not accurate"));
  EXPECT_TRUE(has(text, "its own is accurate"));
  EXPECT_TRUE(has(text, "too &lt;many&gt; unknowns"));
  EXPECT_TRUE(has(text, ">≥ "));
}

TEST(StabilitySection, TellsManySurveysMethodByMethodByTheirLeast) {
  vv::CaseVerdict verdict = support::demo_maps();
  for (std::size_t k = 0; k < verdict.runs.size(); ++k) {
    verdict.definition.runs[k].scene.scheme =
        verdict.runs[k].parameters[0].second == "mpm" ? Scheme::mpm : Scheme::ugimp;
    vv::Survey& survey = *verdict.runs[k].record.survey;
    survey.linear.limit = verdict.definition.runs[k].scene.scheme == Scheme::mpm ? 5.0 + static_cast<double>(k) : 7.5;
  }
  const std::string text = section_of(campaign_of(verdict));
  EXPECT_TRUE(has(text, "MPM, 8 scenes"));
  EXPECT_TRUE(has(text, "<td>16 scenes</td>"));
  EXPECT_TRUE(has(text, ">5.00<") || has(text, ">5<")) << "the least of the first eight";
  EXPECT_TRUE(has(text, ">7.50<") || has(text, ">7.5<"));
  EXPECT_FALSE(has(text, ">6.00<") || has(text, ">6<"));
}

TEST(StabilitySection, TellsWhatBecameOfEveryExtreme) {
  const std::string text = section_of(campaign_of(demo_extremes()));
  for (const char* part :
       {"Very soft soil", ">accurate<", ">diverged<", ">oscillating<", "as expected", "SURPRISE",
        "accurate or inaccurate", "drift\u00a00.012", "ringing\u00a00.031", "particle 49",
        "a particle left the grid", "value 1.04", "good up to <i>t</i> = 0.25", "Take smaller steps.",
        "oscillating &lt;somehow&gt;", "3 runs"})
    EXPECT_TRUE(has(text, part)) << part;
  const std::size_t unexpected = text.find("What was not expected");
  ASSERT_NE(unexpected, std::string::npos);
  const std::string surprises = text.substr(unexpected, text.find("</table>", unexpected) - unexpected);
  EXPECT_TRUE(has(surprises, "10 Pa"));
  EXPECT_FALSE(has(surprises, "1 kPa"));
}

TEST(StabilitySection, TellsRunsOfOneExpectationAndClassInOneRow) {
  vv::CaseVerdict verdict = demo_extremes();
  for (vv::RunVerdict& run : verdict.runs) {
    run.stability = Class::accurate;
    run.record.outcome = {};
    run.behaviour = {};
    run.gates = {class_gate("accurate", "accurate", true)};
    run.gates[0].reason = "nothing is in its way";
  }
  verdict.runs[1].behaviour.error = 0.0077;
  const std::string text = section_of(campaign_of(verdict));
  const std::string table = text.substr(0, text.find("every run"));
  EXPECT_TRUE(has(table, "3 runs, told by"));
  EXPECT_TRUE(has(table, "7.7"));
  EXPECT_TRUE(has(table, "nothing is in its way"));
  EXPECT_EQ(table.find("as expected<"), table.rfind("as expected<"));
}

TEST(StabilitySection, SaysThatAllWasExpected) {
  vv::CaseVerdict verdict = demo_extremes();
  verdict.runs[2].gates = {class_gate("oscillating", "oscillating", true)};
  const std::string text = section_of(campaign_of(verdict));
  EXPECT_FALSE(has(text, "What was not expected"));
  EXPECT_TRUE(has(text, "Every run of which a class was expected is of that class."));
}

TEST(StabilitySection, ShowsWhyASceneWasRefused) {
  vv::CaseVerdict verdict = demo_extremes();
  verdict.definition.runs[2].refusal = "density must be <above> 0";
  verdict.runs[2].stability = Class::refused;
  verdict.runs[2].behaviour.refused = true;
  EXPECT_TRUE(has(section_of(campaign_of(verdict)), "density must be &lt;above&gt; 0"));
}

TEST(StabilitySection, ShowsClassesInTheGatesOfTheCase) {
  const std::string html = report_html(campaign_of(demo_extremes()), {});
  EXPECT_TRUE(has(html, "<td class=\"n\">oscillating</td><td class=\"n\">expected accurate</td>"));
}

TEST(StabilitySection, SaysPlainlyWhetherFloatIsEnough) {
  vv::CaseVerdict verdict = demo_rounding();
  const std::string text = section_of(campaign_of(verdict));
  EXPECT_TRUE(has(
      text,
      "is enough in 1 of 2 runs, and not in the others: rounding is at most 40\u00a0% of the error of the "
      "cells (footing); 1 run could not be compared."))
      << text;
  EXPECT_TRUE(has(text, "gives the same bits in all of 3 runs."));
  for (const char* part :
       {">enough<", ">not enough<", ">same bits<", ">not compared<", "float &lt;ended&gt; early",
        "6.0 digits", "3.4 digits", ">40\u00a0%<", "at most\n10\u00a0% of the error"})
    EXPECT_TRUE(has(text, part)) << part;

  verdict.rounding.resize(1);
  EXPECT_TRUE(
      has(section_of(campaign_of(verdict)), "is enough in all of 1 run: rounding is at most 0.10\u00a0%"));
  verdict.rounding[0].share = 0.3;
  EXPECT_TRUE(has(section_of(campaign_of(verdict)), "is not enough in any of 1 run"));
  verdict.rounding[0].share = verdict.rounding[0].cells_of_stress = std::nan("");
  EXPECT_TRUE(has(section_of(campaign_of(verdict)), "the error of the cells is not known"));
}

TEST(StabilitySection, CountsRepeatsOnOtherNumbersOfThreads) {
  vv::CaseVerdict verdict = demo_rounding();
  verdict.rounding.clear();
  vv::RunVerdict& run = verdict.runs[0];
  run.record.digest = "a";
  run.record.repeats = {{2, "a"}, {3, "a"}, {8, "a"}};
  run.metrics["bits_differ"] = 0.0;
  std::string text = section_of(campaign_of(verdict));
  EXPECT_TRUE(has(text, ">1, 2, 3, 8</td><td class=\"n\">3</td><td><span class=\"chip pass\">same bits"));
  run.metrics["bits_differ"] = 2.0;
  text = section_of(campaign_of(verdict));
  EXPECT_TRUE(has(text, "2 DIFFER"));
}

/// Two particles that went apart.
vv::Snapshot demo_last_good(int dimension) {
  vv::Snapshot state{"last good", 0.25, {}};
  ParticleFields& fields = state.fields;
  const auto size = static_cast<std::size_t>(dimension);
  fields.dimension = dimension;
  fields.body = {0, 0};
  fields.mass = fields.volume = fields.initial_volume = {1.0, 1.0};
  for (std::size_t k = 0; k < 2 * size; ++k) {
    fields.position.push_back(0.1 * static_cast<double>(k));
    fields.velocity.push_back(static_cast<double>(k) - 1.0);
    fields.half_size.push_back(0.05);
  }
  fields.initial_position = fields.displacement = fields.position;
  fields.stress.assign(dimension == 1 ? 2 : 8, -1.0);
  return state;
}

TEST(StabilitySection, DrawsTheLastGoodStateOfAFailure) {
  for (const int dimension : {1, 2}) {
    vv::CaseVerdict verdict = demo_extremes();
    verdict.definition.classification = vv::Classification();
    verdict.runs[1].record.last_good = demo_last_good(dimension);
    verdict.runs[1].record.outcome.particle = 1;
    const vv::CampaignVerdict campaign = campaign_of(verdict);
    const std::vector<DrawnFigure> figures = draw_figures(campaign);
    ASSERT_EQ(figures.size(), 1u);
    EXPECT_EQ(figures[0].failure, "");
    EXPECT_FALSE(figures[0].png.empty());
    const std::string html = report_html(campaign, figures);
    EXPECT_TRUE(has(html, "<figure id=\"last-good\">"));
    EXPECT_TRUE(has(html, "particle 1 (ringed), value 1.04"));
    EXPECT_EQ(last_good_picture(failed_run_to_draw(campaign)).layout.panels.size(), 1u);
  }
}

TEST(StabilitySection, DrawsNoLastGoodStateWithoutAFailure) {
  vv::CaseVerdict verdict = demo_extremes();
  verdict.definition.classification = vv::Classification();
  verdict.runs[1].record.last_good.reset();
  EXPECT_TRUE(draw_figures(campaign_of(verdict)).empty());
  EXPECT_FALSE(has(report_html(campaign_of(verdict), {}), "last-good"));
}

}  // namespace
}  // namespace mpm::reports
