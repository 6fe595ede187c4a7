#pragma once

#include <string>
#include <vector>

#include "vv/case_file.hpp"
#include "vv/json_reader.hpp"
#include "vv/measurement.hpp"

/// What a case says of measurements: which curves its runs have, and what they are compared with.
namespace mpm::vv {

/// A curve that every run of a case has, and what its axes measure: "length", "pressure", "ratio", ...
struct CurveKind {
  std::string name, abscissa, ordinate;
};

/// The curves of a case that have a name, its cuts included: of a scene the pressure under a footing over its
/// settlement, of one in two dimensions also free surface and failure line of what has collapsed; of an
/// element test its stresses and volume over the strain.
std::vector<CurveKind> curve_kinds(const Case& read);

/// Lines through the fields of snapshots; none if `place` is absent. Throws Refusal, as all below.
std::vector<Cut> read_cuts(const JsonPlace& place, const Case& read);

/// A curve file that comes with the program, by its id, or that lies beside the case, by its name with
/// ".json".
std::shared_ptr<const CurveFile> read_curve_file_at(const JsonPlace& place, const Case& read);

/// Comparisons with measured curves; none if `place` is absent.
std::vector<Measurement> read_measurements(const JsonPlace& place, const Case& read);

/// Single measurements beside predictions; none if `place` is absent. `metrics` are those of the case's runs.
std::vector<PairedPrediction> read_pairs(const JsonPlace& place, const Case& read,
                                         const std::vector<std::string>& metrics);

/// The metrics that the case's comparisons make: measured.<id>.<name>.
std::vector<std::string> comparison_metric_names(const std::vector<Measurement>& measurements);

/// The measurement that such a metric belongs to; null for another metric.
const Measurement* measurement_of(const std::string& metric, const std::vector<Measurement>& measurements);

}  // namespace mpm::vv
