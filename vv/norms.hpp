#pragma once

#include <map>
#include <string>
#include <vector>

#include "vv/verdict.hpp"

namespace mpm::vv {

/// A number that a record can be judged by.
struct Metric {
  std::string name;       ///< as gates write it, for example "hencky.stress.l2"
  std::string unit;       ///< "-" for a ratio
  std::string reference;  ///< the reference solution it needs (a member of Case::references), or empty
  std::string meaning;    ///< one line for a person
};

/// Every metric there is, in the order a report lists them.
const std::vector<Metric>& metric_catalogue();

/// Reference solutions a case may ask for: of columns equilibrium, hencky and zhang; of footings
/// limit_analysis, elastic_strip, terzaghi, embedded_limit and elastic_layer; of motions manufactured, free_fall
/// and rotation; of element tests closed_form.
const std::vector<std::string>& reference_catalogue();

/// What a reference solution needs that a scene does not have, for a person; empty if it describes the scene.
std::string why_unsuited(const std::string& reference, const Scene& scene);

/// The same of a run, which may be an element test.
std::string why_unsuited(const std::string& reference, const RunRequest& request);

/// What a reference solution needs that the case does not record of a run, for a person; empty if it records
/// enough for the run to be judged by it. The reference solution describes the run.
std::string why_not_judged(const std::string& reference, const Case& definition, const RunRequest& request);

/// What the norms say of a record.
struct Judgement {
  std::map<std::string, double> metrics;  ///< finite values only
  std::vector<Curve> curves;              ///< of the run and of the references it was judged against
};

/// Judges a record by the references of its case. A run that did not complete has only the metrics that
/// need no final state (cell_crossings, steps, particle_steps, completed) and what footings leave on their way: load
/// curves with all that is read from them alone.
Judgement judge(const Case& definition, const RunRequest& request, const Record& record);

}  // namespace mpm::vv
