#pragma once

#include <optional>

#include "vv/verdict.hpp"

namespace mpm::vv {

/// What a smaller model has cost in accuracy: largest difference between its state at the end and that of the
/// run as written, relative to the latter's largest value [-].
struct ModelDifference {
  double displacement = 0.0;
  double stress = 0.0;
};

/// The run of the case that differs from another one only in that it keeps what the other has less of; null
/// without one.
const RunVerdict* run_as_written(const CaseVerdict& verdict, const RunVerdict& run,
                                 const ModelChoice& choice);

/// Particle by particle, by their initial heights. Nothing if one of them did not complete or a height of one
/// is none of the other's.
std::optional<ModelDifference> model_difference(const Record& used, const Record& written);

}  // namespace mpm::vv
