#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "vv/case_file.hpp"
#include "vv/json_reader.hpp"

/// What a case says of error against cost.
namespace mpm::vv {

/// Trades make metrics of every run called this, the trade's number in the case from 1, and `.error` or
/// `.bound`.
inline constexpr const char* trade_prefix = "trade.";

/// The trades of a case whose runs, probes, cuts and readings are there; none if `place` is absent.
/// `read_metric` reads the name of a metric that the case measures. Throws Refusal, as all below.
std::vector<TradeRequest> read_trades(const JsonPlace& place, const Case& read,
                                      const std::function<std::string(const JsonPlace&)>& read_metric);

/// The advice that a case puts to the test; nothing if `place` is absent. Whether the other case is there,
/// nobody asks here.
std::optional<AdviceTest> read_advice(const JsonPlace& place);

/// The metrics that the case's trades make: trade.<number>.error and trade.<number>.bound.
std::vector<std::string> trade_metric_names(const std::vector<TradeRequest>& trades);

}  // namespace mpm::vv
