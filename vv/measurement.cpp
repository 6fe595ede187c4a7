#include "vv/measurement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "vv/curves.hpp"
#include "vv/grid_convergence.hpp"

namespace mpm::vv {
namespace {

using Values = std::vector<double>;

/// Trapezoidal rule over ascending abscissae.
template <class Integrand>
double integral(const Values& abscissa, Integrand integrand) {
  double sum = 0.0;
  for (std::size_t k = 1; k < abscissa.size(); ++k)
    sum += (abscissa[k] - abscissa[k - 1]) * (integrand(k - 1) + integrand(k)) / 2;
  return sum;
}

double largest_magnitude(const Values& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// A curve at every abscissa; NaN where it has no value.
Values read_at(const Curve& curve, const Values& abscissa, double within) {
  Values values;
  for (const double x : abscissa) values.push_back(value_at(curve, x, within).value);
  return values;
}

/// Slope of the measured curve through its neighbours; what an uncertain abscissa is multiplied by.
double slope_at(const Values& x, const Values& y, std::size_t k) {
  const std::size_t before = k == 0 ? 0 : k - 1, after = std::min(k + 1, x.size() - 1);
  return (y[after] - y[before]) / (x[after] - x[before]);
}

/// u_D^2 = u_exp^2 + u_dig^2 + (dy/dx)^2 u_x^2 at every row.
Values measured_uncertainty(const CurveFile& file, std::size_t column, const Values& x, const Values& y) {
  const CurveColumn& along = file.columns[*file.abscissa];
  const CurveColumn& up = file.columns[column];
  Values u;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double u_x = std::hypot(along.digitisation.of(x[k]), along.experimental.of(x[k]));
    u.push_back(std::hypot(up.digitisation.of(y[k]), up.experimental.of(y[k]), slope_at(x, y, k) * u_x));
  }
  return u;
}

/// 95 % bound of the finest value of a refinement, in its unit.
double bound_of_finest(const Values& cell_size, const Values& values) {
  const std::size_t count = values.size();
  if (const std::optional<GridConvergence> found = grid_convergence(cell_size, values))
    return found->uncertainty * std::abs(values.back());
  const double step = std::abs(values[count - 1] - values[count - 2]);
  if (count > 2) {  // three levels of which the finest value is zero
    const auto [least, most] = std::minmax_element(values.end() - 3, values.end());
    return *most - *least;
  }
  constexpr double safety_factor = 3.0;  // for two levels [Roache94]
  return safety_factor * step / (cell_size[count - 2] / cell_size[count - 1] - 1.0);
}

/// Where the run's curve can be read: its values and the measured rows they belong to.
struct Reach {
  Values values;
  std::vector<std::size_t> rows;
};

Reach reach_of(const Curve& curve, const Values& abscissa, double within) {
  Reach reach;
  const Values all = read_at(curve, abscissa, within);
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (!std::isfinite(all[k])) continue;
    reach.values.push_back(all[k]);
    reach.rows.push_back(k);
  }
  return reach;
}

Values picked(const Values& values, const std::vector<std::size_t>& rows) {
  Values some;
  for (const std::size_t row : rows) some.push_back(values[row]);
  return some;
}

/// The curves of several runs at one abscissa each; empty `lack` if all of them are read.
struct Family {
  std::vector<Values> values;  ///< one a curve
  std::string lack;
};

Family read_family(const std::vector<const Curve*>& curves, const Values& abscissa, double within,
                   const std::string& what) {
  Family family;
  for (const Curve* curve : curves) {
    family.values.push_back(curve ? read_at(*curve, abscissa, within) : Values{});
    const Values& read = family.values.back();
    const bool whole =
        curve && std::all_of(read.begin(), read.end(), [](double value) { return std::isfinite(value); });
    if (!whole && family.lack.empty())
      family.lack = fmt::format("run {} of {} has no curve there, or one that does not reach as far",
                                family.values.size(), what);
  }
  return family;
}

/// u_num: half the 95 % bound of the discretisation, and what the curve itself says of how it was read.
void add_numerical(const ComparedCurves& curves, CurveComparison& found) {
  found.u_numerical.assign(found.abscissa.size(), 0.0);
  if (curves.refined.size() >= 2) {
    const Family levels = read_family(curves.refined, found.abscissa, curves.within, "the refinement");
    if (found.lack = levels.lack; !found.lack.empty()) return;
    for (std::size_t k = 0; k < found.abscissa.size(); ++k) {
      Values at_point;
      for (const Values& level : levels.values) at_point.push_back(level[k]);
      const double bound =
          std::abs(found.simulated[k] - at_point.back()) + bound_of_finest(curves.cell_size, at_point);
      found.u_numerical[k] = bound / 2;
    }
  }
  if (curves.simulated->uncertainty.empty()) return;
  Curve reading = *curves.simulated;
  reading.y = reading.uncertainty;
  const Values u = read_at(reading, found.abscissa, curves.within);
  for (std::size_t k = 0; k < u.size(); ++k) found.u_numerical[k] = std::hypot(found.u_numerical[k], u[k]);
}

/// u_input: every value of an input between those run is as likely.
void add_inputs(const ComparedCurves& curves, CurveComparison& found) {
  found.u_input.assign(found.abscissa.size(), 0.0);
  for (const std::vector<const Curve*>& input : curves.inputs) {
    const Family family = read_family(input, found.abscissa, curves.within, "an uncertain input");
    if (found.lack = family.lack; !found.lack.empty()) return;
    for (std::size_t k = 0; k < found.abscissa.size(); ++k) {
      double least = found.simulated[k], most = least;
      for (const Values& values : family.values) {
        least = std::min(least, values[k]);
        most = std::max(most, values[k]);
      }
      found.u_input[k] = std::hypot(found.u_input[k], (most - least) / 2 / std::numbers::sqrt3);
    }
  }
}

/// The numbers of a comparison whose vectors are there.
void measure(CurveComparison& found) {
  const std::size_t count = found.abscissa.size();
  const double scale = largest_magnitude(found.measured);
  double sum = 0.0, squares = 0.0;
  std::size_t within = 0;
  for (std::size_t k = 0; k < count; ++k) {
    found.u_validation.push_back(std::hypot(found.u_numerical[k], found.u_input[k], found.u_measured[k]));
    const double error = found.simulated[k] - found.measured[k], bound = 2 * found.u_validation[k];
    sum += error;
    squares += bound * bound;
    within += std::abs(error) <= bound ? 1 : 0;
    found.largest_error = std::max(found.largest_error, std::abs(error) / scale);
    found.excess = std::max(found.excess, (std::abs(error) - bound) / scale);
  }
  const auto points = static_cast<double>(count);
  found.bias = sum / points / scale;
  found.level = std::sqrt(squares / points) / scale;
  found.inside = static_cast<double>(within) / points;
  found.distance = curve_distance(found.abscissa, found.measured, found.simulated);
}

Agreement agreement_of(const CurveComparison& found, double accuracy) {
  if (found.inside < share_inside) return Agreement::model_error;
  return found.level > accuracy ? Agreement::inconclusive : Agreement::validated;
}

CurveComparison lacking(CurveComparison found, const std::string& lack) {
  found.agreement = Agreement::not_compared;
  found.lack = lack;
  return found;
}

/// The 97.5 % quantile of Student's t, by its expansion in the degrees of freedom [AbramowitzStegun64,
/// Eq. 26.7.5]: within 1 % from 2 degrees on, within 1e-4 from 6.
double student_t(double degrees) {
  constexpr double z = 1.959963984540054;  // of the normal distribution
  const double z2 = z * z;
  const double g1 = z * (z2 + 1) / 4;
  const double g2 = z * ((5 * z2 + 16) * z2 + 3) / 96;
  const double g3 = z * (((3 * z2 + 19) * z2 + 17) * z2 - 15) / 384;
  const double g4 = z * ((((79 * z2 + 776) * z2 + 1482) * z2 - 1920) * z2 - 945) / 92160;
  return z + (g1 + (g2 + (g3 + g4 / degrees) / degrees) / degrees) / degrees;
}

}  // namespace

const char* name_of(Agreement agreement) {
  switch (agreement) {
    case Agreement::validated:
      return "validated at this level";
    case Agreement::model_error:
      return "model error detected";
    case Agreement::inconclusive:
      return "inconclusive";
    case Agreement::no_measurement:
      return "no measurement";
    case Agreement::not_compared:
      return "not compared";
  }
  return "not compared";
}

std::string lack_of_measurement(const CurveFile& slot) {
  return "no measurement: " + slot.id + ".json is an empty slot";
}

CurveDistance curve_distance(const Values& abscissa, const Values& measured, const Values& simulated) {
  const double dd = integral(abscissa, [&](std::size_t k) { return measured[k] * measured[k]; });
  const double ss = integral(abscissa, [&](std::size_t k) { return simulated[k] * simulated[k]; });
  const double sd = integral(abscissa, [&](std::size_t k) { return simulated[k] * measured[k]; });
  const double ee =
      integral(abscissa, [&](std::size_t k) { return std::pow(simulated[k] - measured[k], 2); });
  CurveDistance distance;
  distance.l2 = std::sqrt(ee / dd);
  distance.magnitude = std::sqrt(ss / dd) - 1.0;
  // Round-off may carry the cosine of two equal curves above one.
  distance.phase = std::acos(std::clamp(sd / std::sqrt(ss * dd), -1.0, 1.0)) / std::numbers::pi;
  distance.comprehensive = std::hypot(distance.magnitude, distance.phase);
  return distance;
}

CurveComparison compare(const CurveFile& file, std::size_t column, const ComparedCurves& curves,
                        double accuracy) {
  CurveComparison found;
  if (file.missing) {
    found.agreement = Agreement::no_measurement;
    found.lack = lack_of_measurement(file);
    return found;
  }
  if (!curves.simulated) return lacking(std::move(found), "the run has no such curve");
  const Values x = file.column(*file.abscissa), y = file.column(column);
  const Reach reach = reach_of(*curves.simulated, x, curves.within);
  if (reach.rows.size() >= 2)
    found.overlap = (x[reach.rows.back()] - x[reach.rows.front()]) / (x.back() - x.front());
  found.abscissa = picked(x, reach.rows);
  found.measured = picked(y, reach.rows);
  found.simulated = reach.values;
  found.u_measured = picked(measured_uncertainty(file, column, x, y), reach.rows);
  if (found.overlap < least_overlap) {
    return lacking(std::move(found),
                   fmt::format("the run's curve covers {:.0f} % of the measured one, {:.0f} % are needed",
                               100 * found.overlap, 100 * least_overlap));
  }
  add_numerical(curves, found);
  if (found.lack.empty()) add_inputs(curves, found);
  if (!found.lack.empty()) return lacking(found, found.lack);
  measure(found);
  found.agreement = agreement_of(found, accuracy);
  return found;
}

const std::vector<ComparisonMetric>& comparison_metrics() {
  static const std::vector<ComparisonMetric> all = {
      {"inside", "share of the measured points within 2 u_val",
       [](const CurveComparison& c) { return c.inside; }},
      {"excess", "largest difference beyond 2 u_val, over the largest measured magnitude",
       [](const CurveComparison& c) { return c.excess; }},
      {"level", "2 u_val, root mean square, over the largest measured magnitude",
       [](const CurveComparison& c) { return c.level; }},
      {"bias", "mean difference, simulated less measured, over the largest measured magnitude",
       [](const CurveComparison& c) { return c.bias; }},
      {"largest_error", "largest difference over the largest measured magnitude",
       [](const CurveComparison& c) { return c.largest_error; }},
      {"l2", "L2 of the difference over that of the measured curve",
       [](const CurveComparison& c) { return c.distance.l2; }},
      {"magnitude", "Sprague and Geers's error of magnitude M",
       [](const CurveComparison& c) { return c.distance.magnitude; }},
      {"phase", "Sprague and Geers's error of phase P",
       [](const CurveComparison& c) { return c.distance.phase; }},
      {"comprehensive", "Sprague and Geers's comprehensive error, sqrt(M^2 + P^2)",
       [](const CurveComparison& c) { return c.distance.comprehensive; }},
      {"overlap", "share of the measured curve that the run's covers",
       [](const CurveComparison& c) { return c.overlap; }},
      {"validated", "1 if validated at this level, else 0",
       [](const CurveComparison& c) { return c.agreement == Agreement::validated ? 1.0 : 0.0; }}};
  return all;
}

ModelFactor model_factor(const std::vector<Pair>& pairs, double u_measured) {
  if (pairs.size() < fewest_pairs) throw std::invalid_argument("a model factor needs three pairs");
  Values logarithms;
  for (const Pair& pair : pairs) {
    if (!(pair.measured > 0.0) || !(pair.predicted > 0.0) || !std::isfinite(pair.predicted / pair.measured))
      throw std::invalid_argument("a model factor needs positive numbers: " + pair.name);
    logarithms.push_back(std::log(pair.predicted / pair.measured));
  }
  const auto count = static_cast<double>(pairs.size());
  const double mean = std::accumulate(logarithms.begin(), logarithms.end(), 0.0) / count;
  double squares = 0.0;
  for (const double logarithm : logarithms) squares += (logarithm - mean) * (logarithm - mean);
  ModelFactor factor;
  factor.scatter = std::sqrt(squares / (count - 1));
  factor.model_scatter = std::sqrt(std::max(0.0, factor.scatter * factor.scatter - u_measured * u_measured));
  const double reach = student_t(count - 1) * factor.scatter / std::sqrt(count);
  factor.bias = std::exp(mean);
  factor.bias_low = std::exp(mean - reach);
  factor.bias_high = std::exp(mean + reach);
  const auto [least, most] = std::minmax_element(logarithms.begin(), logarithms.end());
  factor.least = std::exp(*least);
  factor.greatest = std::exp(*most);
  return factor;
}

}  // namespace mpm::vv
