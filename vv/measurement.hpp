#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "vv/curve_file.hpp"

/// Curves of runs against measured ones, with the uncertainty of both [ASME20, OberkampfRoy10].
namespace mpm::vv {

struct Curve;
struct Metric;

/// What a curve of a run turned out to be beside a measured one.
enum class Agreement {
  validated,       ///< the difference lies within the uncertainty, which is as small as was asked for
  model_error,     ///< the difference is larger than the uncertainty explains
  inconclusive,    ///< it is not, but the uncertainty is larger than was asked for
  no_measurement,  ///< the curve file is an empty slot
  not_compared,    ///< `lack` says why
};

/// "validated at this level", "model error detected", ...
const char* name_of(Agreement agreement);

/// How far apart two curves are that are given at the same abscissae. Integrals are by the trapezoidal rule.
struct CurveDistance {
  double l2 = 0.0;             ///< sqrt(int (s - d)^2 / int d^2) [-]
  double magnitude = 0.0;      ///< M = sqrt(int s^2 / int d^2) - 1 [-] [SpragueGeers04]
  double phase = 0.0;          ///< P = arccos(int s d / sqrt(int s^2 int d^2)) / pi [-] [SpragueGeers04]
  double comprehensive = 0.0;  ///< C = sqrt(M^2 + P^2) [-]
};

/// The distance of `simulated` s from `measured` d over ascending abscissae. All three are equally long, at
/// least two entries. Not a number where a curve is zero throughout.
CurveDistance curve_distance(const std::vector<double>& abscissa, const std::vector<double>& measured,
                             const std::vector<double>& simulated);

/// A run's curve beside a measured one. Vectors have one entry per measured abscissa that the run's curve
/// reaches; uncertainties are standard uncertainties (one sigma) in the unit of the ordinate.
struct CurveComparison {
  std::string measurement;  ///< id of the case's measurement
  Agreement agreement = Agreement::not_compared;
  std::string lack;  ///< why there is no comparison; empty beside one
  std::vector<double> abscissa, measured, simulated;
  std::vector<double> u_measured;    ///< u_D: digitisation, experiment, and slope times that of the abscissa
  std::vector<double> u_numerical;   ///< u_num: discretisation, and reading the curve off the particles
  std::vector<double> u_input;       ///< u_input: what is not known of the scene
  std::vector<double> u_validation;  ///< u_val = sqrt(u_num^2 + u_input^2 + u_D^2)
  double overlap = 0.0;  ///< share of the measured abscissae's range that the run's curve covers [-]
  CurveDistance distance;
  double bias = 0.0;           ///< mean of simulated - measured, over the largest measured magnitude [-]
  double largest_error = 0.0;  ///< largest |simulated - measured| over the same [-]
  double inside = 0.0;         ///< share of the points where |simulated - measured| <= 2 u_val [-]
  double excess =
      0.0;  ///< largest |simulated - measured| - 2 u_val, or 0, over the largest measured magnitude [-]
  double level = 0.0;  ///< root mean square of 2 u_val over the largest measured magnitude [-]
};

/// Why there is nothing to compare with: the curve file is an empty slot.
std::string lack_of_measurement(const CurveFile& slot);

/// Share of the points that must lie within 2 u_val, where 2 sigma hold 95 % of normal errors.
inline constexpr double share_inside = 0.95;
/// Least overlap: a curve that covers less has not been compared.
inline constexpr double least_overlap = 0.95;

/// What is compared with a measured curve.
struct ComparedCurves {
  const Curve* simulated = nullptr;
  std::vector<const Curve*> refined = {};  ///< the same of its refinement, from coarse to fine; may be empty
  std::vector<double> cell_size = {};      ///< of those [m]
  std::vector<std::vector<const Curve*>> inputs = {};  ///< for each uncertain input the curves of its values
  double within = 0.0;  ///< half-width of the mean that curves are read with; 0 interpolates
};

/// Compares a run's curve with the ordinates `column` of a measured one; `accuracy` is what 2 u_val is asked
/// to be at most, relative to the largest measured magnitude.
///
/// Every curve is read at the measured abscissae. The uncertainty of the discretisation at one of them is, as
/// a 95 % bound, the distance to the finest level plus that level's own by `grid_convergence`: of two levels
/// 3 |f_1 - f_2| / (r - 1), first order taken for granted [Roache94]. Of an uncertain input it is the half
/// range of its values over sqrt(3), a rectangular distribution [GUM08]. The verdict:
///
/// - *model error detected* if less than 95 % of the points lie within 2 u_val, however large u_val is;
/// - else *inconclusive* if `level` is larger than `accuracy`: anything would have passed;
/// - else *validated at this level*.
CurveComparison compare(const CurveFile& file, std::size_t column, const ComparedCurves& curves,
                        double accuracy);

/// Metrics of a comparison are called measured.<id>.<name> with these names.
inline constexpr const char* measured_prefix = "measured.";

/// Name, meaning and value of everything a comparison measures.
struct ComparisonMetric {
  const char* name;
  const char* meaning;
  double (*value)(const CurveComparison&);
};
const std::vector<ComparisonMetric>& comparison_metrics();

// ---- many single measurements ----

/// A number measured and the same predicted.
struct Pair {
  std::string name;  ///< of the test
  double measured = 0.0, predicted = 0.0;
};

/// What many pairs of one quantity say of a model: the logarithms of predicted / measured are taken for
/// normal.
struct ModelFactor {
  double bias = 0.0;  ///< geometric mean of predicted / measured; 1 is right, above 1 on the high side
  double bias_low = 0.0, bias_high = 0.0;  ///< 95 % confidence interval of it, by Student's t
  double scatter = 0.0;        ///< standard deviation of the logarithms: about the coefficient of variation
  double model_scatter = 0.0;  ///< the same without the measurements' own, never below zero
  double least = 0.0, greatest = 0.0;  ///< of predicted / measured
};

/// Fewer pairs have a bias, but next to nothing to tell how certain it is.
inline constexpr std::size_t fewest_pairs = 3;

/// The model factor of at least `fewest_pairs` pairs. `u_measured` is the relative standard uncertainty of
/// one measurement [-]. Throws std::invalid_argument for fewer pairs or numbers that are not positive.
ModelFactor model_factor(const std::vector<Pair>& pairs, double u_measured);

}  // namespace mpm::vv
