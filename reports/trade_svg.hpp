#pragma once

#include <string>

#include "vv/verdict.hpp"

namespace mpm::reports {

/// The chart of a request of kind `trade` for the screen: HTML with an inline SVG for every panel. Needs
/// nothing from elsewhere.
///
/// - Every point has a <title> with its configuration, error, prices and steps, which reports/trade.js shows
/// in a
///   box. It then also dims all other families while one in the legend is pointed at, marks the same run in
///   the other panels, and leads from point to point by the arrow keys.
/// - Points on a front can be reached by the tabulator.
///
/// Empty if there is nothing to show.
std::string trade_html(const vv::CaseVerdict& verdict, const vv::FigureRequest& request);

/// Markup without its tags, for where there can be none; superscripts and subscripts of digits stay. What was
/// escaped stays so.
std::string without_tags(const std::string& markup);

}  // namespace mpm::reports
