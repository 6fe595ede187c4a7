#pragma once

#include "reports/plot.hpp"
#include "vv/verdict.hpp"

/// Maps of what a scene does at every time step tried.
namespace mpm::reports {

/// How a class of behaviour looks: a symbol, and the colour of its symbol. Colours are safe for the
/// colour-blind, and no two classes have the same symbol.
Look look_of_class(vv::StabilityClass stability);

/// What a class means, a few words for a legend: "drifts".
std::string words_of_class(vv::StabilityClass stability);

/// The plot a request of kind `stability` asks for, drawn from the surveys of the runs: a column for every
/// value of `map_axis`, or for every run without one, over the time step in terms of wave speed and cell
/// size.
///
/// - A time step that was tried is a symbol in a patch of the colour of its class, which reaches half-way, in
/// the
///   logarithm, to the neighbours. Symbols that would cover one of the same class are left out.
/// - The line is the boundary of stability found by runs: half-way between the last that was stable and the
/// first
///   that diverged. Dashed is the limit by the matrix of one step, dotted the time step that the scene asks
///   for.
/// - A panel for every value of `panels` and `series`; all share their axes.
/// - Columns whose names would run into each other are numbered, and a note is the key.
/// - Runs without a survey are named in a note.
Plot stability_plot_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request);

}  // namespace mpm::reports
