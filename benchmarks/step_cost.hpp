#pragma once

#include "benchmarks/scenes.hpp"
#include "vv/step_cost.hpp"

namespace mpm::bench {

using vv::StepCost;

/// The count of vv/step_cost.hpp for the step of a scene: damped, with one particle a node in one dimension
/// and four in two.
inline StepCost step_cost(const SceneChoice& choice) {
  const int dimension = choice.model == SceneChoice::Model::column ? 1 : 2;
  return vv::step_cost(
      {.dimension = dimension,
       .scheme = choice.scheme,
       .order = choice.order,
       .law = choice.law == Law::mohr_coulomb ? vv::LawKind::mohr_coulomb : vv::LawKind::linear_elastic,
       .precision = choice.precision,
       .particles_per_node = dimension == 1 ? 1.0 : 4.0});
}

}  // namespace mpm::bench
