#include "reports/document.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "tests/support/demo_validation.hpp"
#include "tests/support/demo_verdict.hpp"

namespace mpm::reports {
namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string read(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Document, SaysPassWhenAllIsGood) {
  const vv::CampaignVerdict campaign = support::demo_campaign();
  ASSERT_TRUE(campaign.passed());
  const std::string html = report_html(campaign, {});
  EXPECT_TRUE(has(html, "<span class=\"word\">PASS</span>"));
  EXPECT_FALSE(has(html, "What failed"));
}

TEST(Document, SaysFailWhenAGateFailed) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  campaign.cases[0].runs[2].gates[0].status = vv::GateStatus::fail;
  campaign.cases[0].status = vv::CaseStatus::fail;
  const std::string html = report_html(campaign, {});
  EXPECT_TRUE(has(html, "<span class=\"word\">FAIL</span>"));
  EXPECT_TRUE(has(html, "What failed"));
  EXPECT_TRUE(has(html, "10 of 11 gates hold"));
}

TEST(Document, SaysFailWhenAControlStayedGreen) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  campaign.cases[0].runs[9].gates[0].status = vv::GateStatus::unexpectedly_green;
  campaign.cases[0].status = vv::CaseStatus::fail;
  const std::string html = report_html(campaign, {});
  EXPECT_TRUE(has(html, "<span class=\"word\">FAIL</span>"));
  EXPECT_TRUE(has(html, "GREEN, must be red"));
}

TEST(Document, SaysWhatWasNotRun) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  vv::CaseVerdict skipped;
  skipped.definition.id = "skipped_case";
  skipped.definition.title = "A case that was left out";
  skipped.status = vv::CaseStatus::not_run;
  skipped.not_run_reason = "it is not part of a quick report";
  campaign.cases.push_back(skipped);
  campaign.quick = true;
  const std::string html = report_html(campaign, {});
  EXPECT_FALSE(has(html, "<span class=\"word\">PASS</span>"));
  EXPECT_TRUE(has(html, "What was not run"));
  EXPECT_TRUE(has(html, "it is not part of a quick report"));
  EXPECT_TRUE(has(html, "2 of 3 cases passed"));
  EXPECT_TRUE(has(html, "./mpmvv report --quick"));
}

TEST(Document, SaysWhatWasNotMeasured) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  vv::GateResult& gate = campaign.cases[0].runs[0].gates[0];
  gate.value = std::numeric_limits<double>::quiet_NaN();
  gate.status = vv::GateStatus::fail;
  gate.detail = "the run has no stress";
  const std::string html = report_html(campaign, {});
  EXPECT_TRUE(has(html, "What was not measured"));
  EXPECT_TRUE(has(html, "the run has no stress"));
  EXPECT_FALSE(has(html, ">nan"));
}

TEST(Document, ListsEveryRunThatDidNotComplete) {
  const std::string html = report_html(support::demo_campaign(), {});
  EXPECT_TRUE(has(html, "12\u202f345"));
  EXPECT_TRUE(has(html, "1.04"));
  EXPECT_FALSE(has(html, "Every run ended where it was meant to"));
}

TEST(Document, RunsThatShareARowAreAllNamed) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  for (vv::RunVerdict& run : campaign.cases[0].runs)
    if (!run.gates[0].must_fail) run.gates[0].value = 0.0;
  const std::string html = report_html(campaign, {});
  EXPECT_TRUE(has(html,
                  "11 runs alike</summary><small><span class=\"run\">1G, MPM</span>; <span class=\"run\">1G, "
                  "uGIMP</span>;"));
  EXPECT_TRUE(has(html, "<span class=\"run\">50G, cpGIMP</span></small>"));
}

TEST(Document, AFailedRunDoesNotHideInASharedRow) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  for (vv::RunVerdict& run : campaign.cases[0].runs)
    if (!run.gates[0].must_fail) run.gates[0].value = 0.0;
  campaign.cases[0].runs[4].gates[0].status = vv::GateStatus::fail;
  EXPECT_TRUE(has(report_html(campaign, {}), "10 runs alike"));
}

TEST(Document, OfManyResultsOfAGateTheClosestAndTheBadOnesStayOpen) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  double value = 0.001;
  for (vv::RunVerdict& run : campaign.cases[0].runs)
    if (!run.gates[0].must_fail) run.gates[0].value = value += 0.0001;
  vv::GateResult& bad = campaign.cases[0].runs[0].gates[0];
  bad.status = vv::GateStatus::fail;
  const std::string html = report_html(campaign, {});
  const std::size_t closest = html.find("closest of 11: "), folded = html.find("all 11 results");
  ASSERT_NE(closest, std::string::npos);
  ASSERT_NE(folded, std::string::npos);
  const std::string open = html.substr(closest, folded - closest);
  EXPECT_TRUE(has(open, "50G, cpGIMP")) << "the last has the largest value";
  EXPECT_TRUE(has(open, "1G, MPM")) << "the failed one";
  EXPECT_FALSE(has(open, "20G, uGIMP"));
}

TEST(Document, AFindingHoldsOnlyWhileItsGatesAreGood) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  for (vv::RunVerdict& run : campaign.cases[0].runs)
    for (vv::GateResult& gate : run.gates)
      if (!gate.good()) gate.status = vv::GateStatus::pass;
  vv::Claim& claim = campaign.cases[0].definition.claims[0];
  EXPECT_TRUE(has(report_html(campaign, {}), ">holds<"));
  claim.finding = vv::Finding::not_seen;
  EXPECT_TRUE(has(report_html(campaign, {}), ">not seen<"));
  claim.finding = vv::Finding::depends;
  EXPECT_TRUE(has(report_html(campaign, {}), ">holds in part<"));
  claim.gates = {"smooth", "never_applied"};
  EXPECT_TRUE(has(report_html(campaign, {}), ">NOT MEASURED<"));
  claim.gates = {"smooth"};
  campaign.cases[0].runs[1].gates[0].status = vv::GateStatus::fail;
  const std::string html = report_html(campaign, {});
  EXPECT_TRUE(has(html, ">IN DOUBT<"));
  EXPECT_FALSE(has(html, ">not seen<"));
}

TEST(Document, AClaimShowsWhatItsGatesMeasuredAndTheirBound) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  vv::CaseVerdict& levels = campaign.cases[0];
  double value = 0.0031;
  for (vv::RunVerdict& run : levels.runs)
    if (run.gates[0].id == "smooth") run.gates[0].value = value += 0.0001;
  const std::string html = report_html(campaign, {});
  const std::size_t at = html.find("<section id=\"claims\">");
  const std::string claims = html.substr(at, html.find("</section>", at) - at);
  EXPECT_TRUE(has(claims, "<b>smooth</b>&nbsp;11/11"));
  EXPECT_TRUE(
      has(claims, "<span class=\"range\">3.20×10<sup>−3</sup> … 4.20×10<sup>−3</sup></span>, at most 0.02"));
  EXPECT_FALSE(has(claims, "not measured"));
  levels.runs[0].gates[0].value = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(has(report_html(campaign, {}), "at most 0.02; 1 not measured"));
  levels.definition.claims[0].gates = {"oscillation_control"};
  EXPECT_TRUE(has(report_html(campaign, {}), "not at most 0.01")) << "a control must violate its bound";
}

// ---- validation

vv::CampaignVerdict measured_campaign() {
  vv::CampaignVerdict campaign;
  campaign.cases = {support::demo_collapse(), support::demo_pairs()};
  vv::CaseVerdict& collapse = campaign.cases[0];
  vv::GateResult live;
  live.id = "surface";
  live.metric = "measured.final_surface.inside";
  live.value = 1.0;
  live.op = ">=";
  live.threshold = 0.95;
  live.status = vv::GateStatus::pass;
  vv::GateResult waiting = live;
  waiting.id = "other";
  waiting.metric = "measured.other_surface.inside";
  waiting.value = std::nan("");
  waiting.status = vv::GateStatus::no_measurement;
  waiting.detail = "the slot is empty";
  collapse.runs[1].gates = {live, waiting};
  collapse.definition.claims = {{.text = "The live one.", .gates = {"surface"}, .remark = ""},
                                {.text = "The waiting one.", .gates = {"surface", "other"}, .remark = ""}};
  return campaign;
}

TEST(Document, SaysWhatBecameOfEveryComparison) {
  const std::string html = report_html(measured_campaign(), {});
  EXPECT_TRUE(has(html, "Beside measurements"));
  EXPECT_TRUE(has(html, "model error detected"));
  EXPECT_TRUE(has(html, "validated at this level"));
  EXPECT_TRUE(has(html, "71\u00a0%")) << "the share inside 2 u_val of the run that is off";
  EXPECT_TRUE(has(html, "0.043")) << "its comprehensive error";
  EXPECT_TRUE(has(html, "u_D is a lower bound")) << "the experiment's uncertainty is not stated";
}

TEST(Document, AWaitingGateIsNeitherGoodNorBad) {
  const vv::CampaignVerdict campaign = measured_campaign();
  ASSERT_FALSE(campaign.failed());
  const std::string html = report_html(campaign, {});
  EXPECT_TRUE(has(html, "1 of 2 gates hold"));
  EXPECT_TRUE(has(html, "1 gate waits for a measurement that is missing"));
  EXPECT_FALSE(has(html, "What failed"));
  EXPECT_FALSE(has(html, "What was not measured"));
  const std::size_t live = html.find("The live one."), waiting = html.find("The waiting one.");
  EXPECT_TRUE(has(html.substr(live, waiting - live), ">holds<"));
  EXPECT_TRUE(has(html.substr(waiting, 400), "not tested: no measurement"));
}

TEST(Document, SaysWhereEveryMeasuredNumberComesFrom) {
  const std::string html = report_html(measured_campaign(), {});
  EXPECT_TRUE(has(html, "Measured and published numbers"));
  EXPECT_TRUE(has(html, "<code>demo_surface</code>, Demo00, Figure 3"));
  EXPECT_TRUE(has(html, "A surface nobody has &lt;measured&gt;"));
  EXPECT_TRUE(has(html, "Origin: missing"));
  EXPECT_TRUE(has(html, "read to 1 mm, measured to not stated")) << "in the unit of the column";
  EXPECT_FALSE(has(html, "No measured curve enters this report"));
  EXPECT_TRUE(has(report_html(support::demo_campaign(), {}), "No measured curve enters this report"));
}

TEST(Document, TellsOfAFormulaOnceHoweverManyCasesAskIt) {
  vv::CampaignVerdict campaign = measured_campaign();
  ASSERT_FALSE(campaign.cases[1].definition.pairs.empty());
  campaign.cases[1].definition.pairs[0].formula = "exact";
  campaign.cases.push_back(campaign.cases[1]);
  const std::string html = report_html(campaign, {});
  const std::size_t begin = html.find("id=\"validation\""), end = html.find("</section>", begin);
  const std::string overview = html.substr(begin, end - begin), title = campaign.cases[1].pairs[0].title;
  const std::size_t first = overview.find(title);
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(overview.find(title, first + 1), std::string::npos);
}

TEST(Document, EscapesWhatTheVerdictSays) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  const std::string evil = "<script>alert('x')</script> & \"quoted\"";
  campaign.host = campaign.cases[0].definition.title = campaign.cases[0].definition.notes[0] = evil;
  campaign.cases[0].definition.claims = {{evil, vv::Finding::not_seen, {"smooth"}, evil}};
  campaign.cases[0].definition.figures[0].caption = evil;
  campaign.cases[0].runs[0].gates[0].reason = evil;
  campaign.cases[0].runs[0].gates[0].scope = evil;
  campaign.cases[0].runs[0].record.failure = evil;
  campaign.cases[0].runs[0].parameters[1].second = evil;
  const std::string html = report_html(campaign, {{"column_figure_1", "stress", "bytes", 100, ""}});
  EXPECT_FALSE(has(html, "<script"));
  EXPECT_FALSE(has(html, "\"quoted\""));
  EXPECT_TRUE(has(html, "&lt;script&gt;"));
}

TEST(Document, LoadsNothingFromElsewhere) {
  const vv::CampaignVerdict campaign = support::demo_campaign();
  const std::string html = report_html(campaign, {{"column_figure_1", "stress", "bytes", 100, ""}});
  for (const char* loader : {"http://", "https://", "src=\"//", "<link", "<script", "@import", "url("})
    EXPECT_FALSE(has(html, loader)) << loader;
  EXPECT_TRUE(has(html, "src=\"data:image/png;base64,Ynl0ZXM=\""));
}

TEST(Document, LeavesNoTemplateTagsBehind) {
  const std::string html = report_html(support::demo_campaign(), {});
  EXPECT_FALSE(has(html, "{{"));
  EXPECT_FALSE(has(html, "}}"));
}

TEST(Document, FoldsLongTablesOfNormsAndLeavesShortOnesOpen) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  campaign.cases.resize(1);
  ASSERT_EQ(campaign.cases[0].runs.size(), 12U);
  EXPECT_FALSE(has(report_html(campaign, {}), ": table of 12 runs"));
  EXPECT_FALSE(has(report_html(campaign, {}), "what became of all"));
  campaign.cases[0].runs.push_back(campaign.cases[0].runs.back());
  const std::string html = report_html(campaign, {});
  EXPECT_TRUE(has(html, "what became of all 13 runs"));
  EXPECT_TRUE(has(
      html, "<details class=\"norms\">\n<summary>Against Hencky, exact for the rate law: table of 13 runs"));
  std::size_t opened = 0, closed = 0;
  for (std::size_t at = 0; (at = html.find("<details", at)) != std::string::npos; ++at) ++opened;
  for (std::size_t at = 0; (at = html.find("</details>", at)) != std::string::npos; ++at) ++closed;
  EXPECT_EQ(opened, closed);
}

TEST(Document, EmbedsFieldsAndCurvesLikeOtherFigures) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  campaign.cases = {support::demo_footing(20)};
  const auto figures = draw_figures(campaign);
  ASSERT_EQ(figures.size(), 3U);
  for (const DrawnFigure& figure : figures) EXPECT_EQ(figure.failure, "");
  const std::string html = report_html(campaign, figures);
  EXPECT_TRUE(has(html, "<figure id=\"strip_footing-shear\">\n<img src=\"data:image/png;base64,iVBOR"));
  EXPECT_TRUE(has(html, "Against limit analysis, exact limit load"));
}

TEST(Document, ReadingsHaveTheirTitlesAndTheirLimit) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  vv::CaseVerdict& refined = campaign.cases[1];
  EXPECT_FALSE(has(report_html(campaign, {}), "uncertainty of the finest"));
  refined.definition.readings = {{"deep", "pressure at <25 mm>", "pressure", 0.025, 0.0, ""}};
  for (vv::RunVerdict& run : refined.runs) run.metrics["reading.deep"] = 5e4;
  vv::SeriesVerdict& series = refined.series.back();
  series.metrics["reading.deep"] = {7e4, 6e4, 5.5e4};
  series.convergence["reading.deep"].extrapolated = 5e4;
  series.convergence["reading.deep"].order = 1.25;
  series.orders["reading.deep"] = {0.22, 0.13};
  series.convergence["reading.deep"].uncertainty = 0.12;
  std::string html = report_html(campaign, {});
  EXPECT_TRUE(has(html, "<td>pressure at &lt;25 mm&gt; <code>reading.deep</code></td>"));
  EXPECT_TRUE(has(html, "<td>1.25</td><td>50000; ±12 %</td>"));
  EXPECT_TRUE(has(html, "<th class=\"n\">pressure at &lt;25 mm&gt; [Pa]</th>"));
  EXPECT_TRUE(has(html, "Readings"));
  series.convergence["reading.deep"].extrapolated = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(has(report_html(campaign, {}), "<td>none; ±12 %</td>"));
}

TEST(Document, NamesTheLevelsOfASeriesByWhatTheyDifferBy) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  vv::SeriesVerdict& series = campaign.cases[1].series.back();
  series.across = "remedy";
  series.values = {"none", "<some>", "all"};
  EXPECT_FALSE(has(report_html(campaign, {}), "<th class=\"n\">&lt;some&gt;</th>")) << "cells refine it";
  series.cell_size.assign(3, 0.01);
  EXPECT_TRUE(has(report_html(campaign, {}), "<th class=\"n\">&lt;some&gt;</th>"));
}

TEST(Document, SaysWhatAReferenceOfAFootingIs) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  campaign.cases = {support::demo_footing(20)};
  campaign.cases[0].definition.references = {"terzaghi", "embedded_limit"};
  const std::string html = report_html(campaign, {});
  EXPECT_TRUE(has(html, "Terzaghi’s formulas and chart"));
  EXPECT_TRUE(has(html, "(<i>q</i> + <i>γ</i> <i>s</i>) <i>N</i><sub>q</sub>"));
  EXPECT_FALSE(has(html, "initial height of the\ncolumn")) << "symbols of columns";
}

TEST(Document, TellsWhenAFigureCouldNotBeDrawn) {
  const std::string html =
      report_html(support::demo_campaign(), {{"column_figure_1", "stress", "", 0, "no renderer"}});
  EXPECT_TRUE(has(html, "could not be drawn: no renderer"));
  EXPECT_FALSE(has(html, "<img"));
}

TEST(Document, TellsOfRecordsOfAnotherRevision) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  EXPECT_FALSE(has(report_html(campaign, {}), "recorded at another revision"));
  campaign.cases[0].runs[0].record.revision = "feedbeef";
  EXPECT_TRUE(has(report_html(campaign, {}), "1 of 27 runs were recorded at another revision: feedbeef"));
}

TEST(Document, FailedFiguresKeepTheirReason) {
  vv::CampaignVerdict campaign = support::demo_campaign();
  campaign.cases.resize(1);
  campaign.cases[0].definition.figures.resize(1);
  campaign.cases[0].definition.figures[0].kind = "pie";
  const auto figures = draw_figures(campaign);
  ASSERT_EQ(figures.size(), 1U);
  EXPECT_TRUE(has(figures[0].failure, "pie"));
}

TEST(Document, WritesThePageAndItsPictures) {
  const std::filesystem::path directory = std::filesystem::path(MPMVV_TEST_OUTPUT) / "document_test";
  std::filesystem::remove_all(directory);
  vv::CampaignVerdict campaign = support::demo_campaign();
  campaign.cases[0].definition.figures.resize(1);
  write_report(campaign, directory);
  const std::string html = read(directory / "report.html");
  EXPECT_TRUE(has(html, "</html>"));
  EXPECT_TRUE(has(html, "data:image/png;base64,iVBOR"));
  EXPECT_EQ(read(directory / "figures" / "column_figure_1-stress.png").substr(1, 3), "PNG");
  EXPECT_EQ(read(directory / "figures" / "column_convergence-convergence.png").substr(1, 3), "PNG");
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(directory))
    files += entry.is_regular_file();
  EXPECT_EQ(files, 3U);
}

}  // namespace
}  // namespace mpm::reports
