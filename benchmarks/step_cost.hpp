#pragma once

#include <vector>

#include "benchmarks/scenes.hpp"

namespace mpm::bench {

/// What one pass of a step costs: a pass over particles per particle, a pass over nodes per node.
struct Pass {
  const char* name;
  bool over_nodes;
  double reads, writes;  ///< scalars of particle arrays
  double node_scalars;   ///< scalars of node arrays read and written, per node
  double operations;  ///< + - * / and square roots, a multiply-add being two; no comparisons, min, max, abs
};

/// What a step costs per particle.
struct StepCost {
  double bytes, operations;
};

/// The passes of a step as solver/time_step.hpp makes them, counted from their loads, stores and arithmetic.
///
/// Particle arrays are counted once for each pass that touches them, node arrays once for each pass over the
/// nodes and once for each pass over the particles that touches them: a node that neighbouring blocks touch
/// one after another comes from the nearest cache, which the triads do not measure. All nodes of a stencil
/// are computed, also those of weight zero.
inline std::vector<Pass> passes_of(int dimension, Scheme scheme, UpdateOrder order, Law law) {
  const bool plane = dimension == 2, has_domain = scheme != Scheme::mpm, follows = scheme == Scheme::cpgimp;
  const double d = dimension, stress = plane ? 4 : 1, in_plane = plane ? 3 : 1;
  const double width = has_domain ? 4 : 2, rows = plane ? width : 1;
  const double grown = follows ? d : 0;

  // Every pass over particles reads the places and half sizes, and computes the weights.
  const double place = d + (has_domain ? d : 0), weights = d * (has_domain ? 39 : 5);
  // A row of nodes of one quantity: a product with the weight across, then a multiply-add for each node. The
  // force has one for each component of the stress in its direction.
  const double row = 1 + 2 * width, forces = rows * d * d * row;
  // Lanes of sums move into place and are added to the nodes: five additions per quantity and row of a cell.
  const auto put = [&](double quantities) { return 5 * rows * quantities; };
  const double see_velocity = rows * d * (2 * width + 2),
               see_gradient = rows * d * (2 * width + (plane ? 4 : 2));
  const double follow = 6 * d, move = 6 * d, deform = plane ? 6 : 1;
  const double volume = plane ? 5 : 3, elastic = plane ? 14 : 4;
  const double update = deform + volume + elastic + (law == Law::mohr_coulomb ? 50 : 0) + 2 * grown;
  const Pass nodal_velocity{"nodal velocity", true, 0, 0, 1 + 2 * d, 1 + d};

  std::vector<Pass> passes{{"clear nodes", true, 0, 0, 1 + 2 * d, 0}};
  if (order == UpdateOrder::usf) {
    passes.push_back(
        {"mass and momentum", false, place + 1 + d, 0, 2 * (1 + d), weights + d + rows * (1 + d) * row});
    passes.push_back({"into place", true, 0, 0, 0, put(1 + d)});
    passes.push_back(nodal_velocity);
    passes.push_back({"stress and internal force", false, place + 1 + stress + 2, stress + 1 + grown,
                      d + 2 * d, weights + see_velocity + see_gradient + update + in_plane + forces});
    passes.push_back({"into place", true, 0, 0, 0, put(d)});
  } else {
    passes.push_back({"mass, momentum and internal force", false, place + 1 + d + 1 + in_plane, 0,
                      2 * (1 + 2 * d), weights + d + in_plane + rows * (1 + d) * row + forces});
    passes.push_back({"into place", true, 0, 0, 0, put(1 + 2 * d)});
  }
  passes.push_back({"gravity", true, 0, 0, 3, 2});
  passes.push_back({"acceleration", true, 0, 0, 1 + 4 * d, 1 + d * 10});  // with damping
  if (order == UpdateOrder::usl) {
    passes.push_back({"motion and stress", false, place + 2 * d + 1 + stress + 2, 3 * d + stress + 1 + grown,
                      2 * d, weights + 2 * see_velocity + see_gradient + follow + move + update});
  } else if (order == UpdateOrder::usf) {
    passes.push_back({"motion", false, place + 2 * d + 2 + grown, 3 * d + grown, 2 * d,
                      weights + 2 * see_velocity + follow + move});
  } else {
    passes.push_back({"clear momentum", true, 0, 0, d, 0});
    passes.push_back({"acceleration and momentum", false, place + d + 1, 2 * d, 2 * d + 2 * d,
                      weights + 2 * see_velocity + follow + d + rows * d * row});
    passes.push_back({"into place", true, 0, 0, 0, put(d)});
    passes.push_back(nodal_velocity);
    passes.push_back({"stress and motion", false, place + 1 + stress + 2 + 2 * d, stress + 1 + 2 * d + grown,
                      d, weights + see_velocity + see_gradient + move + update});
  }
  return passes;
}

/// The sum of the passes; nodes are shared by the particles of a cell, four in two dimensions and one in one.
inline StepCost step_cost(const SceneChoice& choice) {
  const int dimension = choice.model == SceneChoice::Model::column ? 1 : 2;
  const double particles_per_node = dimension == 1 ? 1 : 4;
  const double scalar = choice.precision == Precision::float64 ? 8 : 4;
  StepCost cost{0, 0};
  for (const Pass& pass : passes_of(dimension, choice.scheme, choice.order, choice.law)) {
    cost.bytes += scalar * (pass.reads + pass.writes + pass.node_scalars / particles_per_node);
    cost.operations += pass.over_nodes ? pass.operations / particles_per_node : pass.operations;
  }
  return cost;
}

}  // namespace mpm::bench
