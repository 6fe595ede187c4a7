#include "vv/step_cost.hpp"

#include <variant>

#include "solver/particles.hpp"

namespace mpm::vv {
namespace {

/// What the parts of a step read, write and compute for a particle. The stencil is a node wider than the
/// particle on either side if particles have a size.
struct Parts {
  explicit Parts(const StepKind& step)
      : plane(step.dimension == 2),
        domain(step.scheme != Scheme::mpm),
        d(step.dimension),
        stress(plane ? 4 : 1),
        in_plane(plane ? 3 : 1),
        width(domain ? 4 : 2),
        rows(plane ? width : 1),
        grown(step.scheme == Scheme::cpgimp ? d : 0) {}

  bool plane, domain;
  double d, stress, in_plane, width, rows, grown;

  // Every pass over particles that reaches nodes reads the places and half sizes, and computes the weights.
  double place() const { return d + (domain ? d : 0); }
  double weights() const { return d * (domain ? 39 : 5); }
  /// A row of nodes of one quantity: a product with the weight across, then a multiply-add for each node.
  double row() const { return 1 + 2 * width; }
  /// One row for each component of the stress in the direction of the force.
  double forces() const { return rows * d * d * row(); }
  /// Lanes of sums move into place and are added to the nodes: five additions per quantity and row of a cell.
  double put(double quantities) const { return 5 * rows * quantities; }
  double see_velocity() const { return rows * d * (2 * width + 2); }
  double see_gradient() const { return rows * d * (2 * width + (plane ? 4 : 2)); }
  double follow() const { return 6 * d; }
  double move() const { return 6 * d; }
  double deform() const { return plane ? 6 : 1; }
};

/// How a law makes a stress of a strain increment.
struct LawCost {
  double reads, writes, operations;
};

/// The volume belongs to it.
LawCost law_cost(const StepKind& step, const Parts& parts) {
  const double volume = parts.plane ? 5 : 3, elastic = parts.plane ? 14 : 4;
  // A stress of the stretch alone need not be known before, unless its work is summed.
  const double unread = step.sums_work ? 0 : -parts.stress;
  switch (step.law) {
    case LawKind::linear_elastic:
      return {0, 0, volume + elastic};
    case LawKind::mohr_coulomb:
      return {0, 0, volume + elastic + 50};
    case LawKind::zhang_elastic:
      return {unread, 0, volume + 4};
    case LawKind::neo_hookean:
      break;
  }
  if (!parts.plane) return {unread, 0, volume + 3};
  // The deformation gradient grows by the step's: a rotation, four sums, a product of two by two, a
  // determinant.
  const double gradient = 3 + 4 + 12 + 3;
  return {unread + 4, 4, gradient + operations_of_a_function + 23};
}

/// What a step does to a particle's stress beyond the plainest: in the same pass as the law.
LawCost extras(const StepKind& step, const Parts& parts) {
  LawCost extra{0, 0, 0};
  const bool by_itself = step.law == LawKind::neo_hookean;  // but its work is that on the turned stress
  const double turn = parts.plane && (step.turns_stress || by_itself) ? 2 * operations_of_a_function + 18 : 0;
  if (!by_itself && turn > 0) extra.operations += 3 + turn;
  if (step.sums_strain) {
    extra.reads += parts.stress;
    extra.writes += parts.stress;
    extra.operations += parts.stress;
  }
  if (step.sums_work) {
    extra.reads += 1;
    extra.writes += 1;
    extra.operations += turn + (parts.plane ? 18 : 5);
  }
  return extra;
}

/// What averages over cells add: their means are taken for the dilation and for the stress, from two sums a
/// cell each.
struct Averaging {
  bool wanted;
  double sums = 2;
  double of_cell() const { return wanted ? sums : 0; }  ///< scalars of a cell, to take its mean
  double share() const { return wanted ? 7 : 0; }       ///< operations, to give a particle the mean

  void add_stress(std::vector<Pass>& passes, const Parts& parts) const {
    if (!wanted) return;
    passes.push_back({"clear cells", true, 0, 0, sums, 0});
    passes.push_back({"mean stress", false, parts.d + 2 + 2, 0, 2 * sums, 2 + 1 + 2});
  }
  void add_dilation(std::vector<Pass>& passes, const Parts& parts) const {
    if (!wanted) return;
    passes.push_back({"clear cells", true, 0, 0, sums, 0});
    passes.push_back(
        {"mean dilation", false, parts.place() + 2, 0, parts.d + 2 * sums,
         parts.weights() + parts.see_velocity() + parts.see_gradient() + parts.deform() + 2 + 1 + 2});
  }
};

LawKind law_of(const Material& material) {
  struct Kind {
    LawKind operator()(const LinearElastic&) const { return LawKind::linear_elastic; }
    LawKind operator()(const ZhangElastic&) const { return LawKind::zhang_elastic; }
    LawKind operator()(const MohrCoulomb&) const { return LawKind::mohr_coulomb; }
    LawKind operator()(const NeoHookean&) const { return LawKind::neo_hookean; }
  };
  return std::visit(Kind(), material);
}

}  // namespace

std::vector<Pass> passes_of(const StepKind& step) {
  const Parts parts(step);
  const double d = parts.d, place = parts.place(), weights = parts.weights(), row = parts.row();
  const double forces = parts.forces(), see = parts.see_velocity(), gradient = parts.see_gradient();
  const double rows = parts.rows, in_plane = parts.in_plane, grown = parts.grown;
  const Averaging averaging{step.averages_cells && parts.plane};
  const LawCost law = law_cost(step, parts), extra = extras(step, parts);
  // Mass, stress and both volumes are read, volume and stress written, and half sizes that grow.
  const double update_reads = 1 + parts.stress + 2 + law.reads + extra.reads;
  const double update_writes = parts.stress + 1 + grown + law.writes + extra.writes;
  const double update = parts.deform() + law.operations + extra.operations + averaging.share() + 2 * grown;
  const Pass nodal_velocity{"nodal velocity", true, 0, 0, 1 + 2 * d, 1 + d};

  std::vector<Pass> passes{{"clear nodes", true, 0, 0, 1 + 2 * d, 0}};
  if (step.order == UpdateOrder::usf) {
    passes.push_back(
        {"mass and momentum", false, place + 1 + d, 0, 2 * (1 + d), weights + d + rows * (1 + d) * row});
    passes.push_back({"into place", true, 0, 0, 0, parts.put(1 + d)});
    passes.push_back(nodal_velocity);
    averaging.add_dilation(passes, parts);
    if (averaging.wanted) {
      passes.push_back({"stress", false, place + update_reads, update_writes, d + averaging.of_cell(),
                        weights + see + gradient + update});
      averaging.add_stress(passes, parts);
      passes.push_back({"internal force", false, place + 2 + in_plane, 0, 2 * d + averaging.of_cell(),
                        weights + in_plane + forces + averaging.share()});
    } else {
      passes.push_back({"stress and internal force", false, place + update_reads, update_writes, d + 2 * d,
                        weights + see + gradient + update + in_plane + forces});
    }
    passes.push_back({"into place", true, 0, 0, 0, parts.put(d)});
  } else {
    averaging.add_stress(passes, parts);
    passes.push_back({"mass, momentum and internal force", false, place + 1 + d + 1 + in_plane, 0,
                      2 * (1 + 2 * d) + averaging.of_cell(),
                      weights + d + in_plane + rows * (1 + d) * row + forces + averaging.share()});
    passes.push_back({"into place", true, 0, 0, 0, parts.put(1 + 2 * d)});
  }
  passes.push_back({"gravity", true, 0, 0, 3, 2});
  passes.push_back({"acceleration", true, 0, 0, 1 + 4 * d, 1 + d * (step.damps ? 10 : 4)});
  if (step.order == UpdateOrder::usl) {
    averaging.add_dilation(passes, parts);
    passes.push_back({"motion and stress", false, place + 2 * d + update_reads, 3 * d + update_writes,
                      2 * d + averaging.of_cell(),
                      weights + 2 * see + gradient + parts.follow() + parts.move() + update});
  } else if (step.order == UpdateOrder::usf) {
    passes.push_back({"motion", false, place + 2 * d + 2 + grown, 3 * d + grown, 2 * d,
                      weights + 2 * see + parts.follow() + parts.move()});
  } else {
    passes.push_back({"clear momentum", true, 0, 0, d, 0});
    passes.push_back({"acceleration and momentum", false, place + d + 1, 2 * d, 2 * d + 2 * d,
                      weights + 2 * see + parts.follow() + d + rows * d * row});
    passes.push_back({"into place", true, 0, 0, 0, parts.put(d)});
    passes.push_back(nodal_velocity);
    averaging.add_dilation(passes, parts);
    passes.push_back({"stress and motion", false, place + update_reads + 2 * d, update_writes + 2 * d,
                      d + averaging.of_cell(), weights + see + gradient + parts.move() + update});
  }
  return passes;
}

StepCost step_cost(const StepKind& step) {
  const double scalar = step.precision == Precision::float64 ? 8 : 4;
  StepCost cost{0, 0};
  for (const Pass& pass : passes_of(step)) {
    cost.bytes += scalar * (pass.reads + pass.writes + pass.node_scalars / step.particles_per_node);
    cost.operations += pass.over_nodes ? pass.operations / step.particles_per_node : pass.operations;
  }
  return cost;
}

StepKind step_of(const Scene& scene, const Body& body) {
  double in_a_cell = 1;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.dimension); ++axis)
    in_a_cell *= body.particles_per_cell[axis];
  return {.dimension = scene.dimension,
          .scheme = scene.scheme,
          .order = scene.update_order,
          .law = law_of(body.material),
          .precision = scene.precision,
          .particles_per_node = in_a_cell,
          .damps = scene.damping > 0.0,
          .sums_strain = scene.sums_strain,
          .sums_work = scene.sums_work,
          .turns_stress = scene.objectivity == Objectivity::jaumann,
          .averages_cells = body.locking_control == LockingControl::cell_average};
}

CountedWork counted_work(const Scene& scene, std::int64_t particle_steps) {
  double particles = 0, bytes = 0, operations = 0;
  for (const Body& body : scene.bodies) {
    const auto of_body = static_cast<double>(lattice_of(scene, body).centers.size());
    const StepCost cost = step_cost(step_of(scene, body));
    particles += of_body;
    bytes += of_body * cost.bytes;
    operations += of_body * cost.operations;
  }
  const auto done = static_cast<double>(particle_steps);
  if (!(particles > 0)) return {.particle_steps = done};
  return {
      .particle_steps = done, .bytes = done * bytes / particles, .operations = done * operations / particles};
}

}  // namespace mpm::vv
