#pragma once

#include <cstdint>
#include <vector>

#include "solver/scene.hpp"
#include "vv/trade.hpp"

/// What a step costs, counted: the passes of a step as solver/time_step.hpp makes them, from their loads,
/// stores and arithmetic.
///
/// Particle arrays are counted once for each pass that touches them, node arrays once for each pass over the
/// nodes and once for each pass over the particles that touches them: a node that neighbouring blocks touch
/// one after another comes from the nearest cache. All nodes of a stencil are computed, also those of weight
/// zero. Nodes are those below particles; what edges, rigid bodies, loads and density ramps do to some nodes
/// or particles is left out, and so are strays and putting particles in order.
namespace mpm::vv {

enum class LawKind { linear_elastic, zhang_elastic, mohr_coulomb, neo_hookean };

/// All that the cost of a particle's step depends on.
struct StepKind {
  int dimension = 2;
  Scheme scheme = Scheme::cpgimp;
  UpdateOrder order = UpdateOrder::musl;
  LawKind law = LawKind::mohr_coulomb;
  Precision precision = Precision::float64;
  double particles_per_node = 4;  ///< above 0
  bool damps = true;
  bool sums_strain = false, sums_work = false;
  bool turns_stress = false;    ///< by the Jaumann rate
  bool averages_cells = false;  ///< LockingControl::cell_average
};

/// What one pass of a step costs: a pass over particles per particle, a pass over nodes per node.
struct Pass {
  const char* name;
  bool over_nodes;
  double reads, writes;  ///< scalars of particle arrays
  double node_scalars;   ///< scalars of node arrays read and written, per node
  double operations;     ///< + - * / and square roots, a multiply-add being two, a sine, cosine or logarithm
                         ///< `operations_of_a_function`; no comparisons, min, max, abs
};

/// About what the polynomial of a sine, cosine or logarithm takes.
inline constexpr double operations_of_a_function = 20;

std::vector<Pass> passes_of(const StepKind& step);

/// What a step costs per particle.
struct StepCost {
  double bytes, operations;
};

/// The sum of the passes.
StepCost step_cost(const StepKind& step);

/// The step of a body of the scene, with as many particles for each node as the body has in a cell.
StepKind step_of(const Scene& scene, const Body& body);

/// What so many particle-steps of a scene take; each body has the share of its particles.
CountedWork counted_work(const Scene& scene, std::int64_t particle_steps);

}  // namespace mpm::vv
