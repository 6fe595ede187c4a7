#pragma once

#include <string>

#include "reports/field.hpp"
#include "reports/model.hpp"
#include "reports/plot.hpp"
#include "reports/row_chart.hpp"
#include "vv/verdict.hpp"

namespace mpm::reports {

/// Text made safe for markup and HTML alike: & < > " ' become entities.
std::string escaped(const std::string& text);

/// A swept value as a person calls it, in markup that figures and HTML share: level 50 gives "50G", a scheme
/// "cpGIMP", a cell size "<i>h</i> = 5 mm"; anything else "parameter value".
std::string name_of_parameter(const std::string& pointer, const vv::Json& value);

/// All swept values of a run, comma separated; "the run" when nothing is swept.
std::string name_of_run(const std::vector<std::pair<std::string, vv::Json>>& parameters);

/// What a metric measures, in markup short enough for an axis; an unknown metric keeps its own name.
std::string name_of_metric(const std::string& metric);

/// The same for a metric of a case, whose readings have titles.
std::string name_of_metric(const std::string& metric, const vv::Case& definition);

/// Markup for a reference solution; an unknown one keeps its own name.
std::string name_of_reference(const std::string& reference);

/// How a run ended, a few words for a person: "a particle left the grid"; of a run that failed, why.
std::string name_of_ending(const vv::Record& record);

/// A pure number in markup with `digits` significant digits: 0.0123, 1.20×10<sup>−5</sup>; with `digits` zero
/// as short as six digits allow. A value that is not finite gives "–".
std::string number_markup(double value, int digits = 3);

/// Observed orders between neighbouring refinements, in markup: "1.62, −0.04"; one that is not finite gives
/// "–".
std::string orders_markup(const std::vector<double>& orders);

/// The plot a request of any kind but `fields`, `model` and `decomposition` asks for, drawn from the curves and
/// metrics of the verdict and from nothing else.
///
/// - Axes of profiles cover the reference solutions plus 12 % of their range, whatever the runs did; without
/// a
///   reference, for histories and for curves, they cover every series whose extreme is at most 30 times the
///   next tamer one's.
/// - Logarithmic axes of metrics end at 10 (1000 %).
/// - Readings, and metrics of load curves, do not go to zero with the cells: they have linear axes, and their
///   value for cells without size, with its uncertainty, stands at a cell size of zero.
/// - Curves of pressure have the load to the right and the settlement downwards. Stages are lines across.
/// - A reference solution that differs from run to run has the colours of its runs.
/// - Bends are marked where metrics say they are: `load_curve.bend_settlement` and its pressure or, of a curve
///   with three phases or more, those of the first and the second bend.
/// - A measurement that is not to be had is named in the legend, and has no curve.
/// - Runs that did not complete or lack a curve are named in a note under their panel.
/// - Kinds comparison, pairs and trend: see reports/validation_figures.hpp; trade: reports/trade_figures.hpp;
///   stability: reports/stability_figures.hpp.
///
/// Throws std::invalid_argument for a kind it does not know.
Plot plot_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request);

/// The picture a request of kind `fields` asks for: a row for every run selected, a column for every moment
/// at which runs were kept, or for every one the request chooses.
///
/// - A measurement that is not to be had has a row of hatched frames, or one frame beside the others.
/// - Measured curves are drawn as `add_measured_lines` says.
/// - The view is the request's, or covers all particles of the runs that completed; without any, of all.
///   Should a few particles have flown so far that all others would shrink by a third or more, the outermost
///   0.1 % are left out and counted.
/// - The colours cover all their values, or all but the outermost 0.5 % at an end beyond which a few lie
///   farther than half of the rest's span: then the scale says so and names the outermost value. Values of
///   both signs, the shear stress and the horizontal displacement have a scale with zero in its middle.
/// - A run that did not complete, or has no such snapshot, has its reason in the panel's place.
///
/// Throws std::invalid_argument for a quantity that is no field.
FieldPlot field_plot_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request);

/// The drawing a request of kind `model` asks for: a panel for every run selected, under its name.
ModelPlot model_plot_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request);

/// The chart a request of kind `decomposition` asks for: a bar for every value of the axis `over`, the change
/// against the first of them beside it. A panel for every metric, and for every value of `panels`.
///
/// - An upright line stands where the first value, the baseline, has its bar. Whatever else varies has a
///   baseline of its own, and no line.
/// - The lines of reference solutions are those of the baseline's run, read like the metric, which is a
///   reading.
RowChart decomposition_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request);

/// Draws what a request of any kind asks for. Throws as those above, and CanvasError.
Picture picture_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request);

}  // namespace mpm::reports
