#include "reports/trade_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "reports/figure_parts.hpp"
#include "reports/figures.hpp"
#include "reports/trade_parts.hpp"
#include "vv/advice_choice.hpp"

namespace mpm::reports {
namespace {

using data = PageData;

std::string title_of(const vv::TradeVerdict& trade) {
  const std::string problem = name_of_problem(trade);
  return escaped(trade.title) + (problem.empty() ? "" : ", " + problem);
}

const std::vector<double>& asked_of(const vv::CaseVerdict& verdict, const vv::TradeVerdict& trade) {
  static const std::vector<double> nothing;
  for (const vv::TradeRequest& request : verdict.definition.trades)
    if (request.title == trade.title) return request.asked;
  return nothing;
}

/// The price that advice counts in.
Price main_price(const vv::TradeVerdict& trade) { return prices_of(trade).front(); }

/// NaN if it is not known.
double paid(const vv::TradePoint& point, Price price) {
  return price_of(point, price).value_or(std::numeric_limits<double>::quiet_NaN());
}

bool failed(const vv::TradePoint& point) { return !point.failure.empty() || !std::isfinite(point.error); }

std::string bytes_cell(const vv::TradePoint& point) {
  const std::optional<double> bytes = price_of(point, Price::bytes);
  return bytes ? price_markup(*bytes, Price::bytes) : "–";
}

std::string plural(std::size_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

/// As short as it was written.
std::string asked_markup(double error) { return number_markup(100.0 * error, 0) + "\u00a0%"; }

// ---- the front
// --------------------------------------------------------------------------------------------------

/// The points on the front of a price, from the cheapest to the most accurate.
std::vector<const vv::TradePoint*> front_of(const vv::TradeVerdict& trade, Price price) {
  std::vector<const vv::TradePoint*> front;
  for (const vv::TradePoint& point : trade.points)
    if (on_front(point, price) && price_of(point, price)) front.push_back(&point);
  std::stable_sort(front.begin(), front.end(), [price](const vv::TradePoint* a, const vv::TradePoint* b) {
    return paid(*a, price) < paid(*b, price);
  });
  return front;
}

/// How many times cheaper a point of the front is than the next that is better: "3.2 ×"; "–" of the best.
std::string saving_of(const vv::TradeVerdict& trade, const vv::TradePoint& point, Price price) {
  const std::vector<const vv::TradePoint*> front = front_of(trade, price);
  const auto at = std::find(front.begin(), front.end(), &point);
  if (at == front.end() || at + 1 == front.end()) return "–";
  return ratio_markup(paid(**(at + 1), price) / paid(point, price));
}

std::string fronts_of(const vv::TradePoint& point, const std::vector<Price>& prices) {
  std::string names;
  for (const Price price : prices)
    if (on_front(point, price))
      names += (names.empty() ? "" : ", ") + std::string(price == Price::seconds ? "time" : "data");
  return names;
}

data front_rows(const vv::TradeVerdict& trade) {
  const std::vector<Price> prices = prices_of(trade);
  std::vector<const vv::TradePoint*> shown = front_of(trade, prices.front());
  for (const vv::TradePoint* point : front_of(trade, prices.back()))
    if (std::find(shown.begin(), shown.end(), point) == shown.end()) shown.push_back(point);
  std::stable_sort(shown.begin(), shown.end(),
                   [](const vv::TradePoint* a, const vv::TradePoint* b) { return a->error > b->error; });
  data rows = list();
  for (const vv::TradePoint* point : shown) {
    const Price price = on_front(*point, prices.front()) ? prices.front() : prices.back();
    rows << object({{"configuration", name_of_configuration(trade, *point)},
                    {"error", error_markup(*point)},
                    {"bound", percent_markup(point->bound())},
                    {"time", timing_markup(*point)},
                    {"bytes", bytes_cell(*point)},
                    {"saving", saving_of(trade, *point, price)},
                    {"fronts", fronts_of(*point, prices)}});
  }
  return rows;
}

// ---- advice
// -----------------------------------------------------------------------------------------------------

/// "0.41 s" or, of what was not timed, "4.5 GB".
std::string main_price_markup(const vv::TradeVerdict& trade, const vv::TradePoint& point) {
  return price_markup(paid(point, main_price(trade)), main_price(trade));
}

/// The second best: what it is and how much more it costs.
std::string runner_up_cell(const vv::TradeVerdict& trade, const vv::Choice& choice) {
  if (!choice.runner_up) return "none: nothing else meets it";
  const vv::TradePoint &point = trade.points[*choice.point], &next = trade.points[*choice.runner_up];
  const double more = paid(next, main_price(trade)) / paid(point, main_price(trade));
  return fmt::format("{}: {} the cost, error {}", name_of_configuration(trade, next), ratio_markup(more),
                     error_markup(next));
}

/// What saving more would lose.
std::string cheaper_cell(const vv::TradeVerdict& trade, const vv::Choice& choice) {
  if (!choice.cheaper) return "nothing is cheaper";
  const vv::TradePoint &point = trade.points[*choice.point], &less = trade.points[*choice.cheaper];
  const double cost = paid(less, main_price(trade)) / paid(point, main_price(trade));
  return fmt::format("{}: {} the cost, but error {}", name_of_configuration(trade, less), ratio_markup(cost),
                     error_markup(less));
}

/// The most accurate of all that may be chosen; null without any.
const vv::TradePoint* best_of(const vv::TradeVerdict& trade) {
  const vv::TradePoint* best = nullptr;
  for (const vv::TradePoint& point : trade.points)
    if (vv::is_offer(point) && (!best || point.bound() < best->bound())) best = &point;
  return best;
}

vv::Choice chosen(const vv::TradeVerdict& trade, double error) {
  return vv::cheapest_within(trade, error, vv::has_times(trade));
}

data advice_rows(const vv::TradeVerdict& trade, const std::vector<double>& asked) {
  data rows = list();
  for (const double error : asked) {
    const vv::Choice choice = chosen(trade, error);
    data row = object({{"asked", asked_markup(error)}});
    if (choice.point) {
      const vv::TradePoint& point = trade.points[*choice.point];
      row.set("chosen", flag(true));
      row.set("configuration", name_of_configuration(trade, point));
      row.set("error", error_markup(point));
      row.set("price", main_price_markup(trade, point));
      row.set("margin", number_markup(100.0 * choice.margin, 2) + "\u00a0%");
      row.set("runner_up", runner_up_cell(trade, choice));
      row.set("cheaper", cheaper_cell(trade, choice));
    } else {
      const vv::TradePoint* best = best_of(trade);
      row.set("chosen", flag(false));
      row.set("best", best ? "the most accurate: " + name_of_configuration(trade, *best) + ", error " +
                                 error_markup(*best)
                           : std::string("nothing was measured"));
    }
    rows << row;
  }
  return rows;
}

data failure_rows(const vv::TradeVerdict& trade) {
  data rows = list();
  for (const vv::TradePoint& point : trade.points) {
    if (!failed(point)) continue;
    rows << object({{"configuration", name_of_configuration(trade, point)},
                    {"reason", point.failure.empty() ? "there is no error" : point.failure}});
  }
  return rows;
}

std::string reference_sentence(const vv::TradeVerdict& trade) {
  const double doubt = trade.reference.uncertainty;
  return name_of_reference(trade.reference.source) +
         (doubt > 0.0 ? ", uncertain by " + number_markup(100.0 * doubt, 2) + "\u00a0%" : "");
}

/// "96 configurations, 12 of them failed".
std::string counts_sentence(const vv::TradeVerdict& trade) {
  const auto bad = static_cast<std::size_t>(std::count_if(trade.points.begin(), trade.points.end(), failed));
  const auto finest = static_cast<std::size_t>(std::count_if(
      trade.points.begin(), trade.points.end(), [](const vv::TradePoint& p) { return p.of_reference; }));
  std::string text = plural(trade.points.size(), "configuration");
  if (bad > 0) text += fmt::format(", {} of them failed", bad);
  if (finest > 0) text += fmt::format(", {} part of the reference and no offer", finest);
  return text;
}

// ---- across cases
// -----------------------------------------------------------------------------------------------

/// "0.05 % … 12 %", of offers.
template <typename Value, typename Words>
std::string range_of(const vv::TradeVerdict& trade, Value value, Words words) {
  Extent extent;
  for (const vv::TradePoint& point : trade.points)
    if (vv::is_offer(point)) extent.include(value(point));
  return extent.empty() ? "–" : words(extent.lower) + " … " + words(extent.upper);
}

data cost_cells(const vv::TradeVerdict& trade, const std::vector<double>& asked) {
  data cells = list();
  for (const double error : asked) {
    const vv::Choice choice = chosen(trade, error);
    cells << object({{"asked", asked_markup(error)},
                     {"cost", choice.point ? main_price_markup(trade, trade.points[*choice.point])
                                           : "nothing measured meets it"}});
  }
  return cells;
}

/// Whether float is enough, and by how much.
std::string rounding_cell(const vv::TradeVerdict& trade, const vv::Case& definition) {
  const std::optional<Rounding> rounding = rounding_of(trade, definition);
  if (!rounding) return "not measured";
  const std::string pairs = plural(rounding->pairs, "pair");
  const std::string most =
      "changes the error by at most " + number_markup(100.0 * rounding->worst, 2) + "\u00a0%";
  if (rounding->enough == rounding->pairs) return chip("pass", "yes") + " " + most + ", " + pairs;
  std::string text = chip("contrary", rounding->enough > 0 ? "not everywhere" : "no");
  text += fmt::format(" in {} of {}; {}", rounding->enough, pairs, most);
  if (rounding->failed > 0) text += fmt::format("; failed in {}", rounding->failed);
  return text;
}

data overview_row(const vv::CaseVerdict& verdict, const vv::TradeVerdict& trade) {
  const vv::TradePoint* best = best_of(trade);
  const Price price = main_price(trade);
  data row = object({{"case_id", verdict.definition.id},
                     {"title", title_of(trade)},
                     {"counts", counts_sentence(trade)},
                     {"best", best ? error_markup(*best) : "–"},
                     {"errors", range_of(
                                    trade, [](const vv::TradePoint& p) { return p.error; }, percent_markup)},
                     {"prices", range_of(
                                    trade, [price](const vv::TradePoint& p) { return paid(p, price); },
                                    [price](double value) { return price_markup(value, price); })},
                     {"rounding", rounding_cell(trade, verdict.definition)}});
  row.set("costs", cost_cells(trade, asked_of(verdict, trade)));
  return row;
}

/// "0.74 × [0.70 … 0.80]".
std::string factor_cell(const Factor& factor) {
  if (factor.pairs == 0) return "–";
  if (factor.pairs == 1) return ratio_markup(factor.median);
  return fmt::format("{} <small>[{}\u00a0…\u00a0{}]</small>", ratio_markup(factor.median),
                     number_markup(factor.low, 2), number_markup(factor.high, 2));
}

std::string failures_cell(const ChoiceEffect& effect) {
  std::string text;
  if (effect.only_taken_failed > 0) text = fmt::format("with it {}", effect.only_taken_failed);
  if (effect.only_other_failed > 0)
    text += fmt::format("{}without it {}", text.empty() ? "" : ", ", effect.only_other_failed);
  return text.empty() ? "–" : text;
}

data effect_rows(const std::vector<ChoiceEffect>& effects) {
  data rows = list();
  for (const ChoiceEffect& effect : effects)
    rows << object({{"taken", name_of_parameter(effect.axis, effect.taken)},
                    {"instead_of", name_of_parameter(effect.axis, effect.instead_of)},
                    {"error", factor_cell(effect.error)},
                    {"seconds", factor_cell(effect.seconds)},
                    {"bytes", factor_cell(effect.bytes)},
                    {"pairs", std::to_string(effect.pairs)},
                    {"failures", failures_cell(effect)}});
  return rows;
}

/// The trades of one title, which are its problems, in the order of the case.
std::vector<std::vector<const vv::TradeVerdict*>> by_title(const vv::CaseVerdict& verdict) {
  std::vector<std::vector<const vv::TradeVerdict*>> groups;
  for (const vv::TradeVerdict& trade : verdict.trades) {
    const auto same = std::find_if(groups.begin(), groups.end(), [&trade](const auto& group) {
      return group.front()->title == trade.title;
    });
    if (same == groups.end())
      groups.push_back({&trade});
    else
      same->push_back(&trade);
  }
  return groups;
}

}  // namespace

void set_trades(PageData& section, const vv::CaseVerdict& verdict) {
  data entries = list();
  for (const vv::TradeVerdict& trade : verdict.trades) {
    const std::vector<double>& asked = asked_of(verdict, trade);
    data entry = object({{"title", title_of(trade)},
                         {"error_name", name_of_trade_error(trade, verdict.definition)},
                         {"reference", reference_sentence(trade)},
                         {"counts", counts_sentence(trade)},
                         {"price", main_price(trade) == Price::seconds ? "time" : "cost"}});
    set_list(entry, "front", front_rows(trade));
    set_list(entry, "advice", advice_rows(trade, asked));
    const data failures = failure_rows(trade);
    entry.set("failure_count", plural(failures.list_value().size(), "configuration"));
    set_list(entry, "failed", failures);
    entries << entry;
  }
  set_list(section, "trades", entries);
}

void set_trade_overview(PageData& page, const vv::CampaignVerdict& verdict) {
  data rows = list(), choices = list();
  for (const vv::CaseVerdict& c : verdict.cases) {
    if (c.status == vv::CaseStatus::not_run) continue;
    for (const vv::TradeVerdict& trade : c.trades) rows << overview_row(c, trade);
    for (const auto& problems : by_title(c)) {
      const std::vector<ChoiceEffect> effects = effects_of(problems);
      if (effects.empty()) continue;
      data entry = object({{"case_id", c.definition.id}, {"title", problems.front()->title}});
      entry.set("effects", effect_rows(effects));
      choices << entry;
    }
  }
  set_list(page, "trade_rows", rows);
  set_list(page, "choices", choices);
}

}  // namespace mpm::reports
