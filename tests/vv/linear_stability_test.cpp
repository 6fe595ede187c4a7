#include "vv/linear_stability.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "reference/linear_stability.hpp"
#include "vv/record.hpp"

namespace mpm::vv {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;
using reference::StrainedBy;

constexpr double h = 0.2, density = 1700.0, youngs_modulus = 4e6;

StrainedBy strained_by(UpdateOrder order) {
  return order == UpdateOrder::usl ? StrainedBy::grid : StrainedBy::particles;
}

/// A bar, free unless `foot` holds its lower end, whose last particle lies `offset` cells past a node.
Scene bar(Scheme scheme, UpdateOrder order, int per_cell, double offset, int cells = 12,
          Condition foot = Condition::free) {
  Scene scene;
  scene.dimension = 1;
  scene.scheme = scheme;
  scene.update_order = order;
  scene.cell_size = h;
  scene.grid_upper = {(cells + 4) * h, 0.0};
  scene.edges[0][0] = foot;
  const double upper = (cells + 1 + offset + 0.5 / per_cell) * h;
  scene.bodies = {{.name = "bar",
                   .lower = {upper - cells * h},
                   .upper = {upper},
                   .anywhere = true,
                   .particles_per_cell = {per_cell, 1},
                   .density = density,
                   .material = LinearElastic{youngs_modulus, 0.0}}};
  return scene;
}

/// A patch of plane strain in a free grid whose last row and column lie `offset` past nodes.
Scene patch(Scheme scheme, UpdateOrder order, int per_cell, double offset, int cells,
            double poissons_ratio = 0.3) {
  Scene scene = bar(scheme, order, per_cell, offset, cells);
  Body& body = scene.bodies.front();
  scene.dimension = 2;
  scene.grid_upper[1] = scene.grid_upper[0];
  body.lower[1] = body.lower[0];
  body.upper[1] = body.upper[0];
  body.particles_per_cell[1] = per_cell;
  body.material = LinearElastic{youngs_modulus, poissons_ratio};
  return scene;
}

double limit_of(const Scene& scene) {
  const LinearStability found = linear_stability(scene);
  EXPECT_EQ(found.lack, "");
  return found.limit;
}

// ---- a step, written out ----

double hat(double x) { return std::max(0.0, 1 - std::abs(x)); }
double hat_integral(double x) {
  const double t = std::clamp(x, -1.0, 1.0);
  return t * (1 - std::abs(t) / 2);
}

/// Weight and gradient over the distance from a node, both in cells; half size 0 is a point.
double weight_at(double d, double l) {
  return l == 0 ? hat(d) : (hat_integral(d + l) - hat_integral(d - l)) / (2 * l);
}
double gradient_at(double d, double l) {
  if (l == 0) return d > -1 && d < 0 ? 1.0 : d >= 0 && d < 1 ? -1.0 : 0.0;
  return (hat(d + l) - hat(d - l)) / (2 * l);
}

/// The step as matrices over all nodes, units as in `StepMatrix`.
class PlainStep {
 public:
  PlainStep(const Scene& scene, const ParticleFields& fields, double courant)
      : scene_(scene),
        dim_(scene.dimension),
        particles_(static_cast<Eigen::Index>(fields.mass.size())),
        dt_(courant) {
    const auto side =
        static_cast<Eigen::Index>(std::lround((scene.grid_upper[0] - scene.grid_lower[0]) / h)) + 3;
    nodes_ = dim_ == 1 ? side : side * side;
    weight_ = MatrixXd::Zero(particles_, nodes_);
    for (MatrixXd& gradient : gradient_) gradient = weight_;
    held_ = VectorXd::Zero(nodes_);
    for (Eigen::Index p = 0; p < particles_; ++p) {
      for (Eigen::Index i = 0; i < nodes_; ++i) fill(fields, p, i, side);
      mass_.push_back(fields.mass[static_cast<std::size_t>(p)] / (density * std::pow(h, dim_)));
      volume_.push_back(fields.volume[static_cast<std::size_t>(p)] / std::pow(h, dim_));
    }
    if (scene.edges[0][0] == Condition::fixed) held_[0] = held_[1] = 1.0;
    const double nu = std::get<LinearElastic>(scene.bodies[0].material).poissons_ratio;
    lateral_ = dim_ == 1 ? 0.0 : nu / (1 - nu);
  }

  VectorXd operator()(const VectorXd& before) const {
    MatrixXd velocity(particles_, dim_), stress(particles_, parts());
    for (Eigen::Index p = 0; p < particles_; ++p) {
      velocity.row(p) = before.segment(p * size(), dim_).transpose();
      stress.row(p) = before.segment(p * size() + dim_, parts()).transpose();
    }
    if (scene_.update_order == UpdateOrder::usf) strain(to_nodes(velocity), stress);
    const MatrixXd acceleration = accelerate(stress), moved = to_nodes(velocity) + dt_ * acceleration;
    const double flip = scene_.flip_fraction;
    velocity = flip * (velocity + dt_ * (weight_ * acceleration)) + (1 - flip) * (weight_ * moved);
    if (scene_.update_order == UpdateOrder::usl) strain(moved, stress);
    if (scene_.update_order == UpdateOrder::musl) strain(to_nodes(velocity), stress);
    VectorXd after(before.size());
    for (Eigen::Index p = 0; p < particles_; ++p) {
      after.segment(p * size(), dim_) = velocity.row(p).transpose();
      after.segment(p * size() + dim_, parts()) = stress.row(p).transpose();
    }
    return after;
  }

 private:
  Eigen::Index parts() const { return dim_ == 1 ? 1 : 3; }
  Eigen::Index size() const { return dim_ + parts(); }

  void fill(const ParticleFields& fields, Eigen::Index p, Eigen::Index i, Eigen::Index side) {
    std::array<double, 2> w{1, 1}, g{0, 0};
    for (Eigen::Index a = 0; a < dim_; ++a) {
      const auto at = static_cast<std::size_t>(p * dim_ + a), axis = static_cast<std::size_t>(a);
      const double node = static_cast<double>(a == 0 ? i % side : i / side) - 1;  // one beyond the edge
      const double d = (fields.position[at] - scene_.grid_lower[axis]) / h - node;
      w[axis] = weight_at(d, fields.half_size[at] / h);
      g[axis] = gradient_at(d, fields.half_size[at] / h);
    }
    weight_(p, i) = w[0] * w[1];
    gradient_[0](p, i) = g[0] * w[1];
    gradient_[1](p, i) = w[0] * g[1];
  }

  VectorXd over_mass() const {
    const VectorXd mass = weight_.transpose() * Eigen::Map<const VectorXd>(mass_.data(), particles_);
    return mass.unaryExpr([](double m) { return m > 1e-14 ? 1 / m : 0.0; })
        .cwiseProduct(VectorXd::Ones(nodes_) - held_);
  }
  MatrixXd to_nodes(const MatrixXd& velocity) const {
    return over_mass().asDiagonal() * weight_.transpose() *
           Eigen::Map<const VectorXd>(mass_.data(), particles_).asDiagonal() * velocity;
  }
  MatrixXd accelerate(const MatrixXd& stress) const {
    const auto volume = Eigen::Map<const VectorXd>(volume_.data(), particles_).asDiagonal();
    MatrixXd force = MatrixXd::Zero(nodes_, dim_);
    force.col(0) = -gradient_[0].transpose() * volume * stress.col(0);
    if (dim_ == 2) {
      force.col(0) -= gradient_[1].transpose() * volume * stress.col(2);
      force.col(1) = -gradient_[0].transpose() * volume * stress.col(2) -
                     gradient_[1].transpose() * volume * stress.col(1);
    }
    return over_mass().asDiagonal() * force;
  }
  void strain(const MatrixXd& node_velocity, MatrixXd& stress) const {
    const VectorXd xx = gradient_[0] * node_velocity.col(0);
    if (dim_ == 1) {
      stress.col(0) += dt_ * xx;
      return;
    }
    const VectorXd yy = gradient_[1] * node_velocity.col(1);
    stress.col(0) += dt_ * (xx + lateral_ * yy);
    stress.col(1) += dt_ * (yy + lateral_ * xx);
    stress.col(2) += dt_ * (1 - lateral_) / 2 *
                     (gradient_[1] * node_velocity.col(0) + gradient_[0] * node_velocity.col(1));
  }

  const Scene& scene_;
  Eigen::Index dim_, particles_, nodes_ = 0;
  double dt_, lateral_ = 0.0;
  MatrixXd weight_;
  std::array<MatrixXd, 2> gradient_;
  VectorXd held_;
  std::vector<double> mass_, volume_;
};

void expect_matrix_of(const Scene& scene, const std::optional<ParticleFields>& state = std::nullopt) {
  const StepMatrix step(scene, state);
  const ParticleFields fields = state ? *state : Simulation(linearised(scene)).particles();
  const MatrixXd found = step.at(0.7);
  const PlainStep plain(scene, fields, 0.7);
  MatrixXd expected(found.rows(), found.cols());
  for (Eigen::Index k = 0; k < found.cols(); ++k) expected.col(k) = plain(VectorXd::Unit(found.cols(), k));
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-11 * expected.cwiseAbs().maxCoeff());
}

TEST(StepMatrix, IsThatOfTheFormulasInOneDimension) {
  for (const Scheme scheme : {Scheme::mpm, Scheme::ugimp, Scheme::cpgimp})
    for (const UpdateOrder order : {UpdateOrder::musl, UpdateOrder::usf, UpdateOrder::usl})
      for (const double flip : {1.0, 0.9}) {
        Scene scene = bar(scheme, order, 3, 0.07, 3, Condition::fixed);
        scene.flip_fraction = flip;
        expect_matrix_of(scene);
      }
}

TEST(StepMatrix, IsThatOfTheFormulasInTwoDimensions) {
  for (const Scheme scheme : {Scheme::mpm, Scheme::cpgimp})
    for (const UpdateOrder order : {UpdateOrder::musl, UpdateOrder::usf, UpdateOrder::usl})
      expect_matrix_of(patch(scheme, order, 2, 0.07, 2));
}

TEST(StepMatrix, IsThatOfAStretchedState) {
  const Scene scene = bar(Scheme::cpgimp, UpdateOrder::usl, 1, 0.3, 3);
  ParticleFields state = Simulation(linearised(scene)).particles();
  for (std::size_t p = 0; p < state.mass.size(); ++p) {
    state.position[p] = (2.1 + 1.6 * static_cast<double>(p)) * h;
    state.half_size[p] *= 1.6;
    state.volume[p] *= 1.6;
  }
  expect_matrix_of(scene, state);
}

TEST(StepMatrix, LeavesOutWhatIsNotLinear) {
  Scene plain = bar(Scheme::cpgimp, UpdateOrder::musl, 2, 0.2, 3);
  Scene loaded = plain;
  loaded.precision = Precision::float32;
  loaded.damping = 0.8;
  loaded.gravity = {.acceleration = {-9.8, 0.0}, .level = 50.0, .loading = RampLoading{1.0}};
  loaded.bodies[0].initial_stress = UniformStress{.xx = -1e3};
  loaded.bodies[0].velocity = {3.0};
  loaded.bodies[0].material = NeoHookean{youngs_modulus, 0.3};
  loaded.termination = AtRest{1e-5, 1e-9, 9.0};
  EXPECT_EQ(StepMatrix(plain).at(0.5), StepMatrix(loaded).at(0.5));
  plain.bodies[0].density_ramp = DensityRamp{0.0, {{4 * density, 1.0}}};
  EXPECT_EQ(StepMatrix(plain).at(0.5), StepMatrix(loaded).at(0.5));
}

TEST(StepMatrix, HasTheUnitsOfTheWaves) {
  const Scene plain = bar(Scheme::cpgimp, UpdateOrder::usl, 2, 0.2, 3);
  Scene stiff = plain;
  stiff.bodies[0].material = LinearElastic{youngs_modulus * 1e6, 0.0};
  stiff.bodies[0].density *= 1e-5;
  EXPECT_LT((StepMatrix(plain).at(0.5) - StepMatrix(stiff).at(0.5)).cwiseAbs().maxCoeff(), 1e-12);
}
