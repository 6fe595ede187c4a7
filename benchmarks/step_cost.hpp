#pragma once

#include <vector>

#include "benchmarks/scenes.hpp"

namespace mpm::bench {

/// What one pass of a step costs per particle.
struct Pass {
  const char* name;
  double reads, writes;  ///< scalars of particle arrays (stencils among them)
  double node_scalars;   ///< scalars of node arrays read and written, per node
  double integers;       ///< 32-bit integers read and written
  double operations;  ///< + - * / and square roots, a multiply-add being two; no comparisons, min, max, abs
};

/// What a step costs per particle.
struct StepCost {
  double bytes, operations;
};

/// The passes of a step as solver/ makes them, counted from their loads, stores and arithmetic.
///
/// Particle arrays are counted once for each pass that touches them, node arrays once for each sweep over the
/// nodes and once for each pass over the particles that touches them: a node that neighbouring particles
/// touch one after another comes from the nearest cache, which the triads do not measure. All nodes of a
/// stencil are computed, also those of weight zero.
inline std::vector<Pass> passes_of(int dimension, Scheme scheme, UpdateOrder order, Law law) {
  const bool plane = dimension == 2, has_domain = scheme != Scheme::mpm, follows = scheme == Scheme::cpgimp;
  const double d = dimension, components = plane ? 4 : 1;
  const double width = has_domain ? 4 : 2, nodes = plane ? width * width : width;
  const double stencil = 2 * d * width;               // weights and gradients along the axes
  const double sums = plane ? 8 : 4, motion = 2 * d;  // scalars of a node: NodeSums, NodeMotion

  // Per node of a stencil: products of the weights along the axes, then what is done with them.
  const double weight = plane ? 1 : 0, gradient = plane ? 2 : 0;
  const double force = plane ? 6 + 2 : 1 + 1;   // stress times gradient, added
  const double strain = plane ? 2 + 2 + 5 : 2;  // symmetric product, added
  const double axis_weights = has_domain ? 5 + 4 * 16 : 6;
  const double volume = plane ? 5 : 3, elastic = plane ? 14 : 4;
  const double law_operations = volume + elastic + (law == Law::mohr_coulomb ? 50 : 0);

  std::vector<Pass> passes{{"weights", d + (has_domain ? d : 0) + 1, stencil, 0, 3, d * axis_weights},
                           {"clear nodes", 0, 0, sums, 0, 0}};
  const Pass gather_strain{"strain",
                           stencil + (follows ? d : 0),
                           components + (follows ? d : 0),
                           motion,
                           1,
                           nodes * (gradient + strain) + components + (follows ? 2 * d : 0)};
  const Pass update_stress{"stress", 2 * components + 2, components + 1, 0, 0, law_operations};
  const Pass nodal_velocity{"nodal velocity", 0, 0, sums + motion, 0, 1 + d};
  if (order == UpdateOrder::usf) {
    passes.push_back(
        {"mass and momentum", stencil + 1 + d, 0, 2 * sums, 1, d + nodes * (weight + 2 + 2 * d)});
    passes.insert(passes.end(), {nodal_velocity, gather_strain, update_stress});
    passes.push_back({"internal force", stencil + 1 + components, 0, 2 * sums, 1,
                      components + nodes * (gradient + force)});
  } else {
    passes.push_back({"mass, momentum and internal force", stencil + 1 + d + 1 + components, 0, 2 * sums, 1,
                      d + components + nodes * (weight + gradient + 2 + 2 * d + force)});
  }
  passes.push_back({"gravity", 0, 0, 2 * sums, 0, 2 * d});
  passes.push_back({"acceleration", 0, 0, sums + motion, 0, 1 + d * 10});  // with damping
  passes.push_back({"motion", stencil + 3 * d, 3 * d, motion, 1, nodes * (weight + 4 * d) + 8 * d});
  if (order == UpdateOrder::musl) {
    passes.push_back({"clear momentum", 0, 0, 2 * sums, 0, 0});
    passes.push_back({"momentum", stencil + 1 + d, 0, 2 * sums, 1, d + nodes * (weight + 2 * d)});
    passes.insert(passes.end(), {nodal_velocity, gather_strain, update_stress});
  }
  if (order == UpdateOrder::usl) passes.insert(passes.end(), {gather_strain, update_stress});
  return passes;
}

/// The sum of the passes; nodes are shared by the particles of a cell, four in two dimensions and one in one.
inline StepCost step_cost(const SceneChoice& choice) {
  const int dimension = choice.model == SceneChoice::Model::column ? 1 : 2;
  const double particles_per_node = dimension == 1 ? 1 : 4;
  const double scalar = choice.precision == Precision::float64 ? 8 : 4;
  StepCost cost{0, 0};
  for (const Pass& pass : passes_of(dimension, choice.scheme, choice.order, choice.law)) {
    const double nodal = pass.node_scalars / particles_per_node;
    cost.bytes += scalar * (pass.reads + pass.writes + nodal) + 4 * pass.integers;
    const bool over_nodes = pass.reads == 0;
    cost.operations += over_nodes ? pass.operations / particles_per_node : pass.operations;
  }
  return cost;
}

}  // namespace mpm::bench
