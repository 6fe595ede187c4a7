#pragma once

#include "reports/page_data.hpp"
#include "vv/verdict.hpp"

namespace mpm::reports {

/// The part of a case's section that weighs configurations: the list `trades`, one entry a trade and problem,
/// with `has_trades`. An entry has the front (cheapest first), for every error asked for the configuration to
/// take, and the configurations that failed.
void set_trades(PageData& section, const vv::CaseVerdict& verdict);

/// What the page says of speed against accuracy as a whole: `trade_rows` (one entry a trade and problem) and
/// `choices` (one entry a trade: what each single choice buys, over its problems), with `has_...`.
void set_trade_overview(PageData& page, const vv::CampaignVerdict& verdict);

}  // namespace mpm::reports
