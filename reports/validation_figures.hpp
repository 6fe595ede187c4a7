#pragma once

#include "reports/field.hpp"
#include "reports/plot.hpp"
#include "vv/verdict.hpp"

/// Pictures of runs beside measured and published curves. All is shown in the units of the curve files.
namespace mpm::reports {

/// The plot a request of kind `comparison` asks for: for every measurement, and every value of `panels`, two
/// panels one above the other.
///
/// - Above stand the measured points with 2 u_D on either side, and the runs' whole curves with twice their
///   own uncertainty; runs that are not compared are pale. Where nobody states the uncertainty of the
///   experiment the legend says that it is that of the reading only.
/// - Below stands simulated minus measured with 2 u_val on either side of zero: grey for one run, of several
///   in the colour of each. The title has the verdict, the note its numbers.
/// - Of an empty slot a hatched frame stands below, and the runs' curves above it; of curves that could not
/// be
///   compared a frame with the reason.
Plot comparison_plot_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request);

/// The plot a request of kind `pairs` asks for: predicted against measured, and their ratio against measured,
/// all on logarithmic axes; two panels for every unit that the pairs have.
///
/// - A line where both are equal has lines of a factor of 2 on either side or, if no ratio is farther off
/// than
///   a factor of 1.5, of 20 %.
/// - The legend has bias and scatter. What was not predicted is named in a note.
Plot pairs_plot_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request);

/// The plot a request of kind `trend` asks for: a mark for every run, a metric against another. A panel for
/// every metric, and for every value of `panels`.
///
/// - Both axes are logarithmic if all that is shown is above zero.
/// - The n-th metric has the n-th column after the abscissa of the published curves beside it. The space
///   between the lowest and the highest of two or more is filled wherever two are defined.
Plot trend_plot_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request);

/// Draws the measured curves that a request of kind `fields` names on the particles, abscissa and ordinate
/// for the places x and y. `runs` are those of the rows, `moments` those of the columns.
///
/// - Only runs that are compared with it have a measured curve: those of a cut at the cut's snapshot, all
/// others
///   at the last moment shown.
/// - The view grows to hold it, unless the request has its own.
/// - An empty slot, or a curve that is none of places, is named in the legend and has no line.
void add_measured_lines(FieldPlot& plot, const vv::CaseVerdict& verdict, const vv::FigureRequest& request,
                        const std::vector<const vv::RunVerdict*>& runs,
                        const std::vector<std::string>& moments);

}  // namespace mpm::reports
