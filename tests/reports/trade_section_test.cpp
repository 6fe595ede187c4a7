// What the report says of speed against accuracy, looked at in the page as a whole.

#include <gtest/gtest.h>

#include <algorithm>

#include "reports/document.hpp"
#include "reports/trade_parts.hpp"
#include "tests/support/demo_trade.hpp"
#include "vv/advice_choice.hpp"

namespace mpm::reports {
namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++found;
  return found;
}

vv::CampaignVerdict campaign() {
  vv::CampaignVerdict verdict = support::demo_campaign();
  verdict.cases = {support::demo_trade_column(), support::demo_trade_footing()};
  return verdict;
}

/// Without pictures, which these tests do not look at.
std::string page(const vv::CampaignVerdict& verdict) { return report_html(verdict, {}); }

/// What stands between the heading and the next of its level.
std::string part(const std::string& html, const std::string& begin, const std::string& end) {
  const std::size_t at = html.find(begin);
  if (at == std::string::npos) return "";
  return html.substr(at, html.find(end, at + begin.size()) - at);
}

std::string section() { return part(page(campaign()), "<section id=\"speed\">", "</section>"); }

/// The row of a table that has this cell.
std::string row_with(const std::string& html, const std::string& cell) {
  const std::size_t at = html.find(cell);
  if (at == std::string::npos) return "";
  const std::size_t begin = html.rfind("<tr>", at);
  return html.substr(begin, html.find("</tr>", at) - begin);
}

TEST(TradeSection, SaysThatNothingIsWeighed) {
  const std::string html = page(support::demo_campaign());
  EXPECT_TRUE(has(html, "No case of this report weighs speed against accuracy."));
  EXPECT_FALSE(has(html, "<script>"));
  EXPECT_FALSE(has(html, "What each choice buys"));
  EXPECT_TRUE(has(html, "<a href=\"#speed\">Speed and accuracy</a>"));
}

TEST(TradeSection, HasARowForEveryTradeAndProblem) {
  const std::string html = section();
  EXPECT_TRUE(has(html, "stress of the column, 1G<br>"));
  EXPECT_TRUE(has(html,
                  "stress of the column, 50G<br><small><a href=\"#trade_column\">trade_column</a>: 96 "
                  "configurations, 20 of them failed</small>"));
  EXPECT_TRUE(has(html, "9 configurations, 1 of them failed, 3 part of the reference and no offer"));
  EXPECT_EQ(count(html, "<b>0.3\u00a0%</b>: "), 2u);
  EXPECT_EQ(count(html, "<b>1\u00a0%</b>: "), 2u);
  EXPECT_EQ(count(html, "nothing measured meets it"), 4u);
}

TEST(TradeSection, TellsWhatAnErrorCosts) {
  const vv::CaseVerdict verdict = support::demo_trade_column();
  const vv::TradeVerdict& trade = verdict.trades[0];
  const vv::Choice choice = vv::cheapest_within(trade, 0.01, true);
  ASSERT_TRUE(choice.point && choice.runner_up && choice.cheaper);
  const std::string html = page(campaign());
  const std::string tables = part(html, "<h4>stress of the column, 1G</h4>", "<h4>");
  const std::string row = row_with(tables, "<th class=\"n\">1\u00a0%</th>");
  const vv::TradePoint& point = trade.points[*choice.point];
  EXPECT_TRUE(has(row, "<td>" + name_of_configuration(trade, point) + "</td>")) << row;
  EXPECT_TRUE(has(row, ">" + duration_markup(point.timing->median) + "<")) << row;
  EXPECT_TRUE(has(row, name_of_configuration(trade, trade.points[*choice.runner_up]) + ": ")) << row;
  EXPECT_TRUE(has(row, name_of_configuration(trade, trade.points[*choice.cheaper]) + ": ")) << row;
  EXPECT_TRUE(has(row, "the cost, but error " + error_markup(trade.points[*choice.cheaper]))) << row;
}

TEST(TradeSection, SaysThatNothingMeasuredMeetsAnError) {
  const std::string html = page(campaign());
  const std::string tables = part(html, "<h4>stress of the column, 50G</h4>", "<h4>");
  EXPECT_TRUE(
      has(tables, "<b>nothing measured meets it</b>; the most accurate: cpGIMP, <i>h</i> = 2.5 mm, MUSL"));
}

TEST(TradeSection, TabulatesTheFrontFromCheapToAccurate) {
  const vv::CaseVerdict verdict = support::demo_trade_column();
  const std::string tables = part(page(campaign()), "<h4>stress of the column, 1G</h4>", "<h4>");
  const std::string front = part(tables, "<tbody>", "</tbody>");
  std::vector<const vv::TradePoint*> points;
  for (const vv::TradePoint& point : verdict.trades[0].points)
    if (point.on_time_front || point.on_work_front) points.push_back(&point);
  EXPECT_EQ(count(front, "<tr>"), points.size());
  std::sort(points.begin(), points.end(), [](const auto* a, const auto* b) { return a->error > b->error; });
  std::size_t at = 0;
  for (const vv::TradePoint* point : points) {
    at = front.find("<td>" + name_of_configuration(verdict.trades[0], *point) + "</td>", at);
    ASSERT_NE(at, std::string::npos);
  }
  EXPECT_TRUE(has(front, "<td>time, data</td>"));
}

TEST(TradeSection, TellsHowMuchCheaperThanTheNextBetter) {
  vv::CampaignVerdict verdict = campaign();
  verdict.cases.erase(verdict.cases.begin());
  vv::TradeVerdict& trade = verdict.cases[0].trades[0];
  trade.points.resize(3);
  for (std::size_t k = 0; k < 3; ++k) {
    trade.points[k].of_reference = false;
    trade.points[k].error = 0.1 / static_cast<double>(k + 1);
    const double seconds = k == 0 ? 1.0 : k == 1 ? 4.5 : 9.0;
    trade.points[k].timing = vv::Timing{seconds, seconds, seconds, 5, true};
  }
  support::demo::mark_fronts(trade);
  const std::string front = part(page(verdict), "<table class=\"trades\">", "</table>");
  EXPECT_TRUE(has(row_with(front, "= 20 mm"), "<td class=\"n\">4.5\u00a0×</td>")) << front;
  EXPECT_TRUE(has(row_with(front, "= 10 mm"), "<td class=\"n\">2\u00a0×</td>")) << front;
  EXPECT_TRUE(has(row_with(front, "= 5 mm"), "<td class=\"n\">–</td>")) << front;
}

TEST(TradeSection, AdvisesByTimeWhereThereIsAny) {
  vv::CampaignVerdict verdict = campaign();
  verdict.cases.erase(verdict.cases.begin());
  vv::TradeVerdict& trade = verdict.cases[0].trades[0];
  trade.points.resize(3);
  for (std::size_t k = 0; k < 3; ++k) {
    trade.points[k].of_reference = false;
    trade.points[k].error = 0.03;
    const double seconds = k == 1 ? 1.0 : 5.0;
    trade.points[k].timing = vv::Timing{seconds, seconds, seconds, 5, true};
    trade.points[k].work.bytes = k == 2 ? 1e9 : 5e9;
  }
  EXPECT_TRUE(has(row_with(page(verdict), "<th class=\"n\">10\u00a0%</th>"), "<td><i>h</i> = 10 mm</td>"));
  for (vv::TradePoint& point : trade.points) point.timing.reset();
  const std::string row = row_with(page(verdict), "<th class=\"n\">10\u00a0%</th>");
  EXPECT_TRUE(has(row, "<td><i>h</i> = 5 mm</td>")) << row;
  EXPECT_TRUE(has(row, "<td class=\"n\">1\u00a0GB</td>")) << row;
}

TEST(TradeSection, FoldsFailuresWithTheirReasons) {
  const std::string html = page(campaign());
  EXPECT_TRUE(has(html, "<summary>20 configurations that failed, and why</summary>"));
  EXPECT_EQ(count(html, "<td>a particle left the grid at step 617</td>"), 20u);
  EXPECT_TRUE(has(html, "not moved so far by the deadline &amp; more"));
}

TEST(TradeSection, TellsWhetherFloatIsEnough) {
  vv::CampaignVerdict verdict = campaign();
  EXPECT_TRUE(has(section(), "not everywhere"));
  EXPECT_TRUE(has(section(), "<td>not measured</td>")) << "the footing has one precision";
  const auto set_float = [&verdict](double factor) {
    for (vv::TradeVerdict& trade : verdict.cases[0].trades)
      for (std::size_t k = 1; k < trade.points.size(); k += 2)
        trade.points[k].error = factor * trade.points[k - 1].error;
  };
  set_float(1.01);
  std::string html = part(page(verdict), "<section id=\"speed\">", "</section>");
  EXPECT_EQ(count(html, ">yes</span> changes the error by at most 1.0\u00a0%, "), 2u) << html;
  set_float(1.2);
  html = part(page(verdict), "<section id=\"speed\">", "</section>");
  EXPECT_EQ(count(html, ">no</span> in 0 of "), 2u);
}

TEST(TradeSection, TellsWhatEachChoiceBuys) {
  const std::string html = section();
  EXPECT_TRUE(has(html, "What each choice buys"));
  const std::string usl = row_with(html, "<td>USL</td><td>MUSL</td>");
  EXPECT_TRUE(has(usl, "<td class=\"n\">0.74\u00a0× <small>[0.74\u00a0…\u00a00.74]</small></td>")) << usl;
  EXPECT_TRUE(has(html, "<td><i>h</i> = 10 mm</td><td><i>h</i> = 20 mm</td>"));
  EXPECT_TRUE(has(html, "<td>uGIMP</td><td>MPM</td>"));
  EXPECT_TRUE(has(html, "without it 20")) << "uGIMP holds where MPM fails";
  EXPECT_TRUE(has(html, "<td>rigid &lt;footing&gt;</td><td>paper&#39;s own</td>") ||
              has(html, "<td>rigid &lt;footing&gt;</td><td>paper&apos;s own</td>"));
}

TEST(TradeSection, EscapesTitles) {
  vv::CampaignVerdict verdict = campaign();
  verdict.cases[1].trades[0].title = verdict.cases[1].definition.trades[0].title = "<b>bold</b>";
  const std::string html = page(verdict);
  EXPECT_FALSE(has(html, "<b>bold</b>"));
  EXPECT_GE(count(html, "&lt;b&gt;bold&lt;/b&gt;"), 3u);
}

TEST(TradeSection, ShowsTheChartOnTheScreenAndThePictureOnPaper) {
  const vv::CampaignVerdict verdict = campaign();
  std::vector<DrawnFigure> figures{{"trade_column", "trade", "picture", 100, ""}};
  const std::string html = report_html(verdict, figures);
  EXPECT_EQ(count(html, "<div class=\"trade\">"), 1u);
  EXPECT_TRUE(has(html, "<img class=\"on-paper\" src=\"data:image/png;base64,"));
  EXPECT_TRUE(has(html, "<script>"));
  EXPECT_TRUE(has(html, "@media screen { figure img.on-paper { display: none; } }"));
  EXPECT_TRUE(has(html, ".trade, .on-screen { display: none; }"));
  figures.front().failure = "no renderer";
  figures.front().png.clear();
  EXPECT_TRUE(has(report_html(verdict, figures), "<div class=\"trade\">"));
}

}  // namespace
}  // namespace mpm::reports
