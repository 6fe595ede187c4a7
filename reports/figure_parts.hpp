#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "reports/plot.hpp"
#include "vv/verdict.hpp"

/// What figures of several kinds are put together from: the runs in their places, ranges, units and looks.
namespace mpm::reports {

using Parameters = std::vector<std::pair<std::string, vv::Json>>;

// ---- words
// ----------------------------------------------------------------------------------------------------

/// Underscores and dots become blanks.
std::string spaced(std::string text);

/// The first letter, if it is one of a to z, becomes a capital.
std::string capitalised(std::string text);

/// Metres of a length as case files write it: a number, or "5 mm", "0.5 cm", "0.005 m".
std::optional<double> length_of(const vv::Json& value);

// ---- choosing and grouping runs
// ---------------------------------------------------------------------------------

/// The value of a parameter; null without it.
const vv::Json* value_of(const Parameters& parameters, const std::string& pointer);

/// Whether a run has one of the values of every selector.
bool selected(const vv::RunVerdict& run, const std::vector<vv::Selector>& where);

/// One run in its place in a picture.
struct Member {
  const vv::RunVerdict* run = nullptr;
  const Scene* scene = nullptr;
  std::string panel;   ///< markup; empty without a panel parameter
  std::string series;  ///< markup
  int look = 0;        ///< number of the series' look
  std::string over;    ///< markup of the refined value; empty without one
  double cell_size = std::numeric_limits<double>::quiet_NaN();  ///< [m]; NaN if it is not known
};

/// The runs that a request selects, in the order of the verdict. What varies among them and is neither
/// `panels`, `series` nor `over` is part of the name of the series.
std::vector<Member> members_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request);

/// The different texts that `key` makes of the members, in their order.
template <class Key>
std::vector<std::string> distinct(const std::vector<Member>& members, Key key) {
  std::vector<std::string> values;
  for (const Member& member : members)
    if (std::find(values.begin(), values.end(), key(member)) == values.end()) values.push_back(key(member));
  return values;
}

std::vector<Member> in_panel(const std::vector<Member>& members, const std::string& panel);

/// The curve of this name and source; null without one.
const vv::Curve* curve_of(const vv::RunVerdict& run, const std::string& name, const std::string& source);

/// NaN if the run does not have the metric.
double metric_of(const vv::RunVerdict& run, const std::string& metric);

/// Where a run that the solver ended stopped: " at step 120, <i>t</i> = 0.5 s".
std::string place_of_ending(const vv::Record& record);

/// One note for all runs of a series that ended alike; `missing` says which runs have nothing to show.
std::vector<std::string> notes_on_runs(const std::vector<Member>& members,
                                       const std::function<bool(const Member&)>& missing);

/// Revision and input of the runs, in markup; without runs, the case alone.
std::string stamp_of(const vv::CaseVerdict& verdict, const std::vector<Member>& members);

// ---- ranges
// -----------------------------------------------------------------------------------------------------

/// The smallest range that holds what it is given; empty (lower > upper) at first.
struct Extent {
  double lower = std::numeric_limits<double>::infinity(), upper = -std::numeric_limits<double>::infinity();
  void include(double value) {
    if (!std::isfinite(value)) return;
    lower = std::min(lower, value);
    upper = std::max(upper, value);
  }
  bool empty() const { return lower > upper; }
  double reach() const { return std::max(std::abs(lower), std::abs(upper)); }
  /// With a margin on both sides, never of zero width.
  Range widened(double margin) const {
    if (empty()) return {0.0, 1.0};
    const double span = upper > lower ? upper - lower : std::max(std::abs(upper), 1e-12);
    return {lower - margin * span, upper + margin * span};
  }
};

/// Of all values times `factor`.
Extent extent_of(const std::vector<double>& values, double factor = 1.0);

/// Joins the extents of all series but the wild ones: going from the tamest up, it stops at the first whose
/// reach is more than 30 times the one before.
Extent tame_extent(std::vector<Extent> extents);

// ---- units
// ------------------------------------------------------------------------------------------------------

/// How a quantity is shown: factor from SI, axis label.
struct Quantity {
  double factor = 1.0;
  std::string label;
};

/// How values in an SI unit are shown whose largest is `reach`: in the prefix that leaves few digits.
/// Pressures stay in kPa up to 20 MPa, as geotechnical engineers write them.
Quantity shown_unit(const std::string& unit, double reach);

/// What stands along an axis: words in markup, and an SI unit.
struct AxisWords {
  std::string words, unit;
};

/// Of a curve's ordinate or abscissa; one that is not known keeps its own name, without a unit.
AxisWords words_of_curve(const std::string& name);

/// The reading that a metric is; null of any other metric.
const vv::Reading* reading_of(const vv::Case& definition, const std::string& metric);

/// The SI unit of a metric of a case; "-" of a pure number, empty of one that is not known.
std::string si_unit_of(const std::string& metric, const vv::Case& definition);

/// How the values of a metric are shown, and the axis label that says so. A pure number stays one.
Quantity shown_metric(const std::string& metric, const vv::Case& definition, double reach);

// ---- looks
// ------------------------------------------------------------------------------------------------------

/// Curves of runs often all but coincide: the solid line lies wide beneath, the dashed ones over it.
Look line_look(const Member& member);

/// Short dashes over long ones over solid lines.
int layer_of(const Look& look);

/// A filled mark without a line; `size` in points.
Look mark_look(MarkerShape shape, double size, const Color& color);

/// Dashed lines in black and grey, each with a dash of its own; repeats.
Look dashed_reference_look(std::size_t number);

}  // namespace mpm::reports
