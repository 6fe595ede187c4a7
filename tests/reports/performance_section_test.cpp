#include "reports/performance_section.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "reports/performance_figures.hpp"
#include "tests/support/demo_performance.hpp"
#include "tests/support/demo_verdict.hpp"

namespace mpm::reports {
namespace {

using Json = support::PerformanceJson;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++found;
  return found;
}

/// A report made where and of what the demonstration was measured.
vv::CampaignVerdict report_of_the_same() {
  vv::CampaignVerdict verdict;
  verdict.revision = "0123abcd";
  verdict.processor = "Test processor";
  verdict.compiler = "Test 1.0";
  return verdict;
}

PerformanceEvidence evidence_of(const Json& json) {
  PerformanceEvidence evidence;
  evidence.measured = support::performance_of(json);
  return evidence;
}

std::string section(const PerformanceEvidence& evidence,
                    const vv::CampaignVerdict& verdict = report_of_the_same(),
                    const std::vector<DrawnPerformanceFigure>& figures = {}) {
  int number = 7;
  return performance_section(evidence, verdict, figures, number);
}

std::string section(const Json& json) { return section(evidence_of(json)); }

TEST(PerformanceSection, SaysThatNothingWasMeasuredAndWhatMeasures) {
  const std::string html = section(PerformanceEvidence{});
  EXPECT_TRUE(has(html, "Nothing was measured"));
  EXPECT_TRUE(has(html, "./mpmvv bench --json"));
  EXPECT_TRUE(has(html, "./mpmvv report --performance"));
  EXPECT_FALSE(has(html, "<table"));
}

TEST(PerformanceSection, SaysThatMeasuringFailed) {
  PerformanceEvidence evidence;
  evidence.failure = "exit code <3>";
  const std::string html = section(evidence);
  EXPECT_TRUE(has(html, "Measuring failed: exit code &lt;3&gt;"));
  EXPECT_FALSE(has(html, "Nothing was measured"));
}

TEST(PerformanceSection, TellsWhereItWasMeasured) {
  const std::string html = section(support::demo_performance_json());
  for (const char* fact :
       {"<code>0123abcd</code></dd>", "2000-01-02T03:04:05Z", "Test processor, 2 cores</dd>",
        "Test 1.0, all instructions of the machine</dd>", "median of 5 repetitions", "0.25 s",
        "typically 10\u00a0% of the rate", "<code>demo.json</code>"})
    EXPECT_TRUE(has(html, fact)) << fact;
  EXPECT_FALSE(has(html, "class=\"bad\""));
}

TEST(PerformanceSection, SaysWhenItIsOfAnotherRevisionOrMachine) {
  vv::CampaignVerdict verdict = report_of_the_same();
  verdict.revision = "55555555";
  std::string html = section(evidence_of(support::demo_performance_json()), verdict);
  EXPECT_TRUE(
      has(html, "<dd class=\"bad\"><code>0123abcd</code>: not the revision of this report, 55555555"));
  verdict = report_of_the_same();
  verdict.processor = "Another processor";
  html = section(evidence_of(support::demo_performance_json()), verdict);
  EXPECT_TRUE(has(html, "the rest of this report is of Another processor"));
  EXPECT_FALSE(has(html, "not the revision of this report"));
  Json modified = support::demo_performance_json();
  modified["modified"] = true;
  verdict = report_of_the_same();
  EXPECT_TRUE(has(section(evidence_of(modified), verdict), "not the revision of this report"));
  verdict.revision = "0123abcd-dirty";
  EXPECT_TRUE(has(section(evidence_of(modified), verdict), "with changes that no revision holds"));
}

TEST(PerformanceSection, ShowsTargetsMetAndNotMet) {
  const std::string html = section(support::demo_performance_json());
  EXPECT_TRUE(has(html, "2 of 4 targets are met."));
  EXPECT_EQ(count(html, ">MET<"), 2U);
  EXPECT_EQ(count(html, ">NOT MET<"), 2U);
  EXPECT_EQ(count(html, "within the spread"), 1U) << "50 against 52 with a spread of 5";
  const std::size_t row = html.find("<tr><td>cpGIMP</td>");
  ASSERT_NE(row, std::string::npos);
  const std::string cells = html.substr(row, html.find("</tr>", row) - row);
  EXPECT_EQ(
      cells,
      "<tr><td>cpGIMP</td><td class=\"n\">10</td><td class=\"n\">9\u00a0–\u00a011</td><td class=\"n\">20</td>"
      "<td><span class=\"chip contrary\">NOT MET</span></td><td class=\"n\">200</td><td class=\"n\">400</td>"
      "<td class=\"n\">25 %</td><td class=\"n\">12 %</td>");
}

TEST(PerformanceSection, NamesOnlyWhatDiffersInARow) {
  const std::string html = section(support::demo_performance_json());
  EXPECT_TRUE(has(html, "<b>footing</b> · USL, Mohr–Coulomb, double, 10\u00a0000 particles, 1 thread</td>"));
  EXPECT_TRUE(has(html, "<tr><td>cpGIMP, double, 1\u00a0000\u00a0000 particles, 2 threads</td>"));
}

TEST(PerformanceSection, ShowsWithoutTargetsThatThereAreNone) {
  Json json = support::demo_performance_json();
  for (Json& step : json["steps"]) step["target"] = nullptr;
  const std::string html = section(json);
  EXPECT_TRUE(has(html, "No configuration has a target"));
  EXPECT_FALSE(has(html, "MET<"));
}

TEST(PerformanceSection, ShowsRunsLimitsKernelsMemoryAndStartUp) {
  const std::string html = section(support::demo_performance_json());
  EXPECT_TRUE(
      has(html,
          "<tr><td>the footing, the paper&#39;s settings</td><td class=\"n\">2</td><td class=\"n\">8</td>"
          "<td class=\"n\">1\u202f000</td><td class=\"n\">20\u202f000</td>"
          "<td class=\"n\">2.00×10<sup>7</sup></td><td class=\"n\">2.50</td><td class=\"n\">25</td>"
          "<td>reached time</td></tr>"));
  EXPECT_TRUE(
      has(html,
          "<td>triad in L2</td><td class=\"n\">80</td><td class=\"n\">72\u00a0–\u00a088</td><td>GB/s</td>"));
  EXPECT_TRUE(has(html, "<td class=\"n\">100</td><td class=\"n\">90\u00a0–\u00a0110</td><td>Gflop/s</td>"));
  EXPECT_TRUE(has(html, "<code>weights/gimp/float64</code></td><td class=\"n\">200</td>"));
  EXPECT_TRUE(has(html,
                  "<td>footing, cpGIMP, Mohr–Coulomb, double</td><td class=\"n\">1\u202f000\u202f000</td>"
                  "<td class=\"n\">222</td>"));
  EXPECT_TRUE(has(html, "<td>footing paper</td><td class=\"n\">12.5</td>"));
  EXPECT_FALSE(has(html, "What these measurements lack"));
}

TEST(PerformanceSection, ShowsWhatFeaturesCost) {
  const std::string html = section(support::demo_performance_json());
  EXPECT_TRUE(has(html, "What a feature costs, and that an unused one costs nothing"));
  EXPECT_TRUE(
      has(html, "1 of 1 defaults that were said left every bit and byte as it was; 1 took at most 2 % more"));
  EXPECT_TRUE(has(html,
                  "<tr><td>local damping<br><small>damped; without: none</small></td><td class=\"n\">20</td>"
                  "<td class=\"n\">25.0</td><td class=\"n\">1.25</td><td class=\"n\">1.12\u00a0–\u00a01.38</td>"
                  "<td class=\"n\">1.25</td><td class=\"n\">160</td><td class=\"n\">176</td>"
                  "<td><code>damping: 0</code></td>"));
  EXPECT_TRUE(has(html, "WITHIN 2 %</span></td><td>equal</td><td>the same</td>"));
  const std::size_t row = html.find("<tr><td>footing of particles");
  ASSERT_NE(row, std::string::npos);
  const std::string cells = html.substr(row, html.find("</tr>", row) - row);
  EXPECT_TRUE(has(cells, "<td class=\"n\">10</td>"))
      << "of a simulated second, whose steps are longer without it";
  EXPECT_TRUE(has(cells, "nothing but its absence"));
  EXPECT_EQ(count(html, "class=\"bad\""), 0U);
}

TEST(PerformanceSection, ShowsAFeatureThatIsNotFree) {
  Json json = support::demo_performance_json();
  Json& spelled = json["features"][0]["spelled"];
  spelled["same_bits"] = false;
  spelled["bytes"] = 160008;
  spelled["verdict"] = "beyond";
  std::string html = section(json);
  EXPECT_TRUE(has(html, "BEYOND 2 %</span></td><td class=\"bad\">+8</td><td class=\"bad\">others</td>"));
  EXPECT_TRUE(has(html, "0 of 1 defaults that were said left every bit and byte as it was; 0 took"));
  spelled["verdict"] = "within_noise";
  html = section(json);
  EXPECT_TRUE(has(html, "WITHIN NOISE"));
  EXPECT_TRUE(has(html, "and of 1 the noise"));
}

TEST(PerformanceSection, SaysWhatTheMeasurementsLack) {
  Json json = support::demo_performance_json();
  Json steps = Json::array();
  for (const Json& step : json["steps"])
    if (step["threads"] == 1 && step["particles"] == 10000 && step["precision"] == "float64")
      steps.push_back(step);
  json["steps"] = steps;
  for (const char* key : {"limits", "kernels", "runs", "memory", "start_up", "features"})
    json[key] = Json::array();
  const std::string html = section(json);
  for (const char* lack :
       {"at several numbers of particles", "No roofline", "on one thread and on several",
        "in both precisions", "No whole run was timed", "limits of the machine were not measured",
        "No kernel was measured by itself", "Memory was not measured", "Start-up was not measured",
        "What features cost was not measured"})
    EXPECT_TRUE(has(html, lack)) << lack;
  EXPECT_FALSE(has(html, "an unused one"));
  EXPECT_FALSE(has(html, "No whole step was measured"));
  json["steps"] = Json::array();
  EXPECT_TRUE(has(section(json), "No whole step was measured"));
  EXPECT_TRUE(draw_performance_figures(evidence_of(json)).empty());
}

TEST(PerformanceSection, EscapesWhatTheFileSays) {
  Json json = support::demo_performance_json();
  const std::string evil = "<script>alert('x')</script> & \"quoted\"";
  for (const char* pointer :
       {"/revision", "/date", "/compiler", "/machine/processor", "/limits/0/title", "/steps/0/scene",
        "/steps/1/scheme", "/steps/2/law", "/steps/3/precision", "/steps/4/order", "/kernels/0/name",
        "/runs/0/title", "/runs/0/ending", "/memory/0/scene", "/memory/0/law", "/start_up/0/scene",
        "/features/0/title", "/features/0/with/what", "/features/0/spelled/what"})
    json[Json::json_pointer(pointer)] = evil;
  PerformanceEvidence evidence = evidence_of(json);
  evidence.history = {evidence_of(json).measured.value()};
  const auto figures = draw_performance_figures(evidence);
  for (const auto& figure : figures) EXPECT_EQ(figure.drawn.failure, "") << figure.drawn.figure_id;
  const std::string html = section(evidence, report_of_the_same(), figures);
  EXPECT_FALSE(has(html, "<script"));
  EXPECT_FALSE(has(html, "\"quoted\""));
  EXPECT_TRUE(has(html, "&lt;script&gt;"));
  for (const auto& figure : figures)
    EXPECT_EQ(figure.drawn.figure_id.find_first_of("/<> \"'"), std::string::npos) << figure.drawn.figure_id;
}

TEST(PerformanceSection, ComparesWithEarlierMeasurements) {
  PerformanceEvidence evidence = evidence_of(support::demo_performance_json());
  evidence.history = {support::performance_of(support::demo_earlier_json(), "old.json")};
  const std::string html = section(evidence);
  EXPECT_TRUE(has(html, "Since revision <code>fedc9876</code>"));
  EXPECT_TRUE(has(html, "Measured on 2000-01-01T03:04:05Z on Test processor (2 cores), Test 1.0"));
  EXPECT_TRUE(has(html, "<code>old.json</code>"));
  EXPECT_TRUE(has(html, "19 configurations before and after")) << "the block was not measured then";
  EXPECT_TRUE(has(html,
                  "<tr><td>MPM, double, 10\u00a0000 particles, 1 thread</td><td class=\"n\">20</td><td "
                  "class=\"n\">40</td>"
                  "<td class=\"n\">2</td><td class=\"n\">1.64\u00a0–\u00a02.44</td></tr>"));
  EXPECT_TRUE(has(html,
                  "<td class=\"n\">1</td><td class=\"n\">30</td><td class=\"n\">10</td>"
                  "<td class=\"n\">20\u202f000</td><td class=\"n\">20\u202f000</td><td class=\"n\">3</td>"));
  EXPECT_FALSE(has(html, "another machine or build"));
  evidence.history[0].processor = "Slow processor";
  EXPECT_TRUE(has(section(evidence), "another machine or build"));
}

TEST(PerformanceSection, SaysWhenNothingWasMeasuredThenAndNow) {
  PerformanceEvidence evidence = evidence_of(support::demo_performance_json());
  evidence.history = {support::performance_of(support::demo_earlier_json())};
  evidence.history[0].steps.clear();
  evidence.history[0].runs.clear();
  const std::string html = section(evidence);
  EXPECT_TRUE(has(html, "No configuration was measured then and now"));
  EXPECT_TRUE(has(html, "No whole run was measured then and now"));
}

TEST(PerformanceSection, NumbersItsFiguresOn) {
  PerformanceEvidence evidence = evidence_of(support::demo_performance_json());
  std::vector<DrawnPerformanceFigure> figures = {
      {{"performance", "sizes", "bytes", 100, ""}, "A <b>caption</b>.", {}},
      {{"performance", "ratios", "", 0, "no renderer"}, "Another.", {}}};
  int number = 7;
  const std::string html = performance_section(evidence, report_of_the_same(), figures, number);
  EXPECT_EQ(number, 9);
  EXPECT_TRUE(has(
      html, "<figure id=\"performance-sizes\">\n<img src=\"data:image/png;base64,Ynl0ZXM=\" width=\"50\""));
  EXPECT_TRUE(has(html, "<b>Figure 7.</b> A <b>caption</b>."));
  EXPECT_TRUE(has(html, "could not be drawn: no renderer"));
  EXPECT_TRUE(has(html, "<b>Figure 8.</b> Another."));
}

TEST(PerformanceSection, StandsInTheReport) {
  const vv::CampaignVerdict campaign = support::demo_campaign();
  const std::string bare = report_html(campaign, {});
  EXPECT_TRUE(has(bare, "<a href=\"#performance\">"));
  EXPECT_TRUE(has(bare, "Nothing was measured"));
  PerformanceEvidence evidence = evidence_of(support::demo_performance_json());
  evidence.history = {support::performance_of(support::demo_earlier_json())};
  const std::string html = report_html(campaign, {}, evidence);
  EXPECT_TRUE(has(html, "2 of 4 targets are met."));
  EXPECT_FALSE(has(html, "{{"));
  EXPECT_FALSE(has(html, "}}"));
  EXPECT_EQ(count(html, "<table"), count(html, "</table>"));
  EXPECT_EQ(count(html, "<details"), count(html, "</details>"));
  EXPECT_EQ(count(html, "<div"), count(html, "</div>"));
}

}  // namespace
}  // namespace mpm::reports
