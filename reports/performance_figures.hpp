#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "reports/performance.hpp"
#include "reports/plot.hpp"
#include "reports/row_chart.hpp"

namespace mpm::reports {

struct PerformanceFigure {
  std::string id, caption;  ///< the caption is markup
  std::variant<Plot, RowChart> content;
};

/// The words that name a step's configuration, in markup and always in the same order: scheme, update order,
/// law, precision, particles, threads.
std::vector<std::string> configuration(const StepRate& step);

inline constexpr std::size_t precision_word = 3, threads_word = 5;

/// The words in which steps differ, one text a step, and those they all share. A step alone shares all.
struct ConfigurationNames {
  std::vector<std::string> own;
  std::string common;
};
/// The word `left_out` is said nowhere.
ConfigurationNames configuration_names(const std::vector<const StepRate*>& steps,
                                       std::optional<std::size_t> left_out = std::nullopt);

/// "10 000" of 10000, with spaces that do not break.
std::string grouped_digits(std::int64_t count);

/// A ratio of two medians; its ends take the opposite extremes of the two.
Measured ratio(const Measured& above, const Measured& below);

/// Two steps that differ in nothing but number of threads or precision, or are the same at two times.
struct StepPair {
  const StepRate* one = nullptr;    ///< on one thread, in double precision, or earlier
  const StepRate* other = nullptr;  ///< on several threads, in single precision, or later
};

/// Every step on several threads beside the same on one.
std::vector<StepPair> thread_pairs(const Performance& performance);
/// Every step in single precision beside the same in double precision.
std::vector<StepPair> precision_pairs(const Performance& performance);
/// Every step of `after` beside that of the same name in `before`.
std::vector<StepPair> common_steps(const Performance& before, const Performance& after);

/// The figures that the measurements suffice for; an absent one has nothing to draw. Rates stand in millions
/// a second.
///
/// - Rates: a bar a configuration, a chart a scene (long ones continue in another), target and spread marked;
///   rows of one update order, law and precision stand together under a heading.
/// - Sizes: rate over the number of particles, a curve a scheme and number of threads, of those measured at
///   several sizes.
/// - Roofline: arithmetic done a second over arithmetic a byte moved, one point a step on one thread, below
/// the
///   machine's measured limits.
/// - Ratios: several threads over one, single over double precision.
/// - History: rates before and after, of the configurations that both files have.
std::vector<PerformanceFigure> rate_figures(const Performance& performance);
std::optional<PerformanceFigure> size_figure(const Performance& performance);
std::optional<PerformanceFigure> roofline_figure(const Performance& performance);
std::optional<PerformanceFigure> ratio_figure(const Performance& performance);
std::vector<PerformanceFigure> history_figures(const Performance& before, const Performance& after);

/// Throws CanvasError.
Picture draw(const PerformanceFigure& figure);

}  // namespace mpm::reports
