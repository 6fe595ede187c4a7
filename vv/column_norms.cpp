#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "reference/column.hpp"
#include "solver/shape_functions.hpp"
#include "vv/behaviour.hpp"
#include "vv/judging.hpp"

namespace mpm::vv {
namespace {

double weighted_norm(const Values& values, const Values& weight) {
  double sum = 0.0;
  for (std::size_t p = 0; p < values.size(); ++p) sum += weight[p] * values[p] * values[p];
  return std::sqrt(sum);
}

Values difference(const Values& a, const Values& b) {
  Values result(a.size());
  std::transform(a.begin(), a.end(), b.begin(), result.begin(), std::minus<>());
  return result;
}

template <class Function>
Values map(const Values& values, Function&& function) {
  Values result(values.size());
  std::transform(values.begin(), values.end(), result.begin(), function);
  return result;
}

/// Width of a column across its axis [m]; 1, without unit, in one dimension.
double width_of(const Scene& scene) {
  const Body& body = scene.bodies.front();
  return scene.dimension == 1 ? 1.0 : body.upper[0] - body.lower[0];
}

Eigen::Map<const Eigen::VectorXd> as_vector(const Values& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

/// Rows of `lengths_in_cells` below the grid's lower edge, for domains that reach over it.
constexpr int ghost_layers = 2;

/// How the grid sees stress: each particle's length in each cell [cell, particle], in cell sizes; in two
/// dimensions its area in each row of cells, per area of the row. The internal forces are the differences of
/// neighbouring rows of this matrix times the stress, so it loses exactly what they lose; for domains it is
/// their overlap with the cells, for points it is all in the cell they are in.
Eigen::MatrixXd lengths_in_cells(const Scene& scene, const Profile& profile) {
  const std::size_t axis = axis_of(scene);
  const auto cells = static_cast<Eigen::Index>(
      std::lround((scene.grid_upper[axis] - scene.grid_lower[axis]) / scene.cell_size) + 2 * ghost_layers);
  const auto fill = [&]<class Shape>(Shape) {
    Eigen::MatrixXd lengths =
        Eigen::MatrixXd::Zero(cells, static_cast<Eigen::Index>(profile.position.size()));
    for (std::size_t p = 0; p < profile.position.size(); ++p) {
      const double x = profile.position[p] / scene.cell_size + ghost_layers;
      const double half_size = profile.half_size[p] / scene.cell_size;
      const std::int32_t first = static_cast<std::int32_t>(x) - Shape::nodes_before;
      std::array<double, Shape::width> weight, gradient;
      Shape::evaluate(x - first, half_size, 1.0, weight, gradient);
      double inside = 0.0;
      for (int k = 0; k + 1 < Shape::width; ++k) {
        inside -=
            gradient[static_cast<std::size_t>(k)] * profile.volume[p] / (width_of(scene) * scene.cell_size);
        lengths(first + k, static_cast<Eigen::Index>(p)) = inside;
      }
    }
    return lengths;
  };
  return scene.scheme == Scheme::mpm ? fill(LinearShape{}) : fill(GimpShape{});
}

/// Fraction of full gravity that acts in the end.
double final_fraction(const Gravity& gravity) { return gravity.fraction(gravity.settled_after()); }

/// Modulus of compression along a column [Pa]: Young's in one dimension; between rollers the sides cannot
/// give way.
double modulus_along(const Scene& scene) {
  const Material& material = scene.bodies.front().material;
  const double modulus = std::visit([](const auto& law) { return law.youngs_modulus; }, material);
  const auto* elastic = std::get_if<LinearElastic>(&material);
  if (scene.dimension == 1 || !elastic) return modulus;
  const double nu = elastic->poissons_ratio;
  return modulus * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
}

/// The column a scene describes, for the reference solutions.
reference::Column column_of(const Scene& scene) {
  const Body& body = scene.bodies.front();
  const std::size_t axis = axis_of(scene);
  const double gravity =
      -scene.gravity.acceleration[axis] * scene.gravity.level * final_fraction(scene.gravity);
  return {body.density * gravity, body.upper[axis] - body.lower[axis], modulus_along(scene)};
}

/// The profile with positions above the base of the column instead of the origin [m].
Profile heights_of(const Scene& scene, Profile profile) {
  for (double& x : profile.initial_position) x -= scene.grid_lower[axis_of(scene)];
  for (double& x : profile.position) x -= scene.grid_lower[axis_of(scene)];
  return profile;
}

/// A run of a column while it is judged.
struct ColumnRun {
  Judging& judging;
  const Scene& scene;
  reference::Column column;
  Profile profile;  ///< the record's, with positions above the column's base instead of the origin
};

std::size_t top_particle(const Profile& profile) {
  const auto& x = profile.initial_position;
  return static_cast<std::size_t>(std::max_element(x.begin(), x.end()) - x.begin());
}

/// How far the top edge of the topmost particle's domain has come down [m]: every scheme carries the volume,
/// and nothing gives way sideways, so the edge is half the current length above the particle.
double settlement_of(const Scene& scene, const Profile& profile) {
  const std::size_t top = top_particle(profile), axis = axis_of(scene);
  const auto highest =
      std::max_element(scene.bodies.begin(), scene.bodies.end(),
                       [axis](const Body& a, const Body& b) { return a.upper[axis] < b.upper[axis]; });
  const double length = scene.cell_size / highest->particles_per_cell[axis];
  return -(profile.displacement[top] + (profile.volume[top] / profile.initial_volume[top] - 1) * length / 2);
}

/// Height of the top above the base now [m].
double top_of(const ColumnRun& run) { return run.column.height - settlement_of(run.scene, run.profile); }

/// Error of the mean stress of every cell that the column fills, against the exact mean. What the grid's
/// equilibrium constrains is this mean; the share of each particle in it is left to the particles.
void judge_cell_means(ColumnRun& run, const std::string& name, const reference::ColumnSolution& exact) {
  const Profile& profile = run.profile;
  const double h = run.scene.cell_size;
  const auto filled = static_cast<std::size_t>(std::max(0.0, top_of(run) / h));
  if (filled == 0) return;
  const Eigen::VectorXd mean = lengths_in_cells(run.scene, profile) * as_vector(profile.stress);
  Values found(filled), expected(filled);
  for (std::size_t c = 0; c < filled; ++c) {
    const double lower = static_cast<double>(c) * h;
    found[c] = mean[static_cast<Eigen::Index>(c) + ghost_layers];
    expected[c] =
        (exact.stress(lower) + 4 * exact.stress(lower + h / 2) + exact.stress(lower + h)) / 6;  // Simpson
  }
  set_norms(run.judging, name + ".cell_stress", relative_norms(found, expected, Values(filled, 1.0)));
}

void judge_by_solution(ColumnRun& run, const std::string& name) {
  const Profile& profile = run.profile;
  const auto exact = reference::column_solution(name, run.column);
  const Values stress = map(profile.position, [&](double x) { return exact->stress(x); });
  const Values displacement = map(profile.initial_position, [&](double x) { return exact->displacement(x); });
  set_norms(run.judging, name + ".stress", relative_norms(profile.stress, stress, profile.volume));
  set_norms(run.judging, name + ".displacement",
            relative_norms(profile.displacement, displacement, profile.initial_volume));
  run.judging.set(name + ".settlement",
                  std::abs(settlement_of(run.scene, profile) / exact->settlement() - 1));
  run.judging.result.curves.push_back({"stress", name, profile.position, stress, "position"});
  run.judging.result.curves.push_back(
      {"displacement", name, profile.initial_position, displacement, "initial_position"});
  judge_cell_means(run, name, *exact);
}

void judge_by_equilibrium(ColumnRun& run) {
  const Profile& profile = run.profile;
  const Values exact =
      map(profile.initial_position, [&](double x) { return reference::equilibrium_stress(run.column, x); });
  set_norms(run.judging, "equilibrium.stress", relative_norms(profile.stress, exact, profile.volume));

  const Values error = difference(profile.stress, exact);
  const Values rough = rough_part(profile.position, error, profile.volume, 1.5 * run.scene.cell_size);
  run.judging.set("oscillation.hp",
                  weighted_norm(rough, profile.volume) / weighted_norm(exact, profile.volume));

  const double largest = std::abs(reference::equilibrium_stress(run.column, 0.0));
  run.judging.result.curves.push_back({"stress", "equilibrium", profile.position, exact, "position"});
  run.judging.result.curves.push_back({"stress_error", "run", profile.initial_position,
                                       map(error, [&](double e) { return e / largest; }),
                                       "initial_position"});
}

/// Share of the stress that the grid cannot see: its part along the directions that the map from particles to
/// cells shrinks to less than a tenth of the largest. With one particle per cell the map has full rank, only
/// just (a sawtooth of 50 particles centred on the nodes comes out of it 30 times smaller), so a cut at
/// round-off would let every sawtooth of a GIMP run pass.
double unseen_share(const Scene& scene, const Profile& profile) {
  constexpr double seen = 0.1;
  const Eigen::MatrixXd s = lengths_in_cells(scene, profile);
  const auto stress = as_vector(profile.stress);
  // The seen directions are S^T u over the eigenvectors u of S S^T, as few as there are cells.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(s * s.transpose());
  const double faintest = seen * seen * modes.eigenvalues().maxCoeff();
  Eigen::VectorXd parts = modes.eigenvectors().transpose() * (s * stress);
  for (Eigen::Index k = 0; k < parts.size(); ++k) {
    parts[k] = modes.eigenvalues()[k] < faintest ? 0.0 : parts[k] / modes.eigenvalues()[k];
  }
  const double share = (stress - s.transpose() * (modes.eigenvectors() * parts)).norm() / stress.norm();
  return share > 1e-12 ? share : 0.0;  // below is the round-off of the projection, not stress
}

void judge_model_form_floor(ColumnRun& run) {
  const auto hencky = reference::column_solution("hencky", run.column);
  const auto zhang = reference::column_solution("zhang", run.column);
  run.judging.set("floor.stress.l2", reference::stress_distance(*zhang, *hencky));
  run.judging.set("floor.settlement", std::abs(zhang->settlement() / hencky->settlement() - 1));
}

bool is_finite(const Values& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

/// What a column under its own weight needs.
std::string why_unsuited_to_columns(const std::string& reference, const Scene& scene) {
  if (scene.bodies.size() != 1) return "a single body";
  const Body& body = scene.bodies.front();
  const std::size_t axis = axis_of(scene);
  const std::string name = axis == 0 ? "x" : "y";
  if (scene.edges[axis][0] == Condition::free) return "a fixed " + name + "_lower edge";
  if (scene.edges[axis][1] != Condition::free) return "a free " + name + "_upper edge";
  if (!scene.rigid_bodies.empty() || !scene.surface_loads.empty() || scene.driven_motion)
    return "gravity as the only load";
  if (body.ring || body.density_ramp || body.initial_stress)
    return "a plain block that starts free of stress";
  if (body.lower[axis] != scene.grid_lower[axis]) return "a body that stands on the grid's lower edge";
  if (!(scene.gravity.acceleration[axis] < 0) || scene.gravity.level == 0)
    return "gravity towards the lower edge";
  if (!(final_fraction(scene.gravity) > 0)) return "gravity that still acts in the end";
  if (scene.dimension == 1) return "";
  if (reference == "zhang") return "one dimension";
  if (scene.edges[0] != std::array{Condition::roller, Condition::roller}) return "rollers on both sides";
  if (body.lower[0] != scene.grid_lower[0] || body.upper[0] != scene.grid_upper[0])
    return "a body as wide as the grid";
  if (scene.gravity.acceleration[0] != 0) return "gravity along the column";
  if (std::holds_alternative<MohrCoulomb>(body.material) && reference != "equilibrium")
    return "an elastic body";
  return "";
}

/// Whether nothing varies but along one axis: cells then stand for rows of cells, the topmost particle for
/// the top.
bool describes_a_column(const Scene& scene) {
  return !scene.bodies.empty() &&
         (scene.dimension == 1 || why_unsuited_to_columns("equilibrium", scene).empty());
}

void judge_column_run(ColumnRun& run) {
  const Profile& profile = run.profile;
  run.judging.set("settlement", settlement_of(run.scene, profile));
  run.judging.result.curves.push_back({"stress", "run", profile.position, profile.stress, "position"});
  run.judging.result.curves.push_back(
      {"displacement", "run", profile.initial_position, profile.displacement, "initial_position"});
  if (!is_finite(profile.stress) || !is_finite(profile.position)) return;
  run.judging.set("oscillation.ns", unseen_share(run.scene, profile));
  if (run.judging.asks_for("equilibrium")) judge_by_equilibrium(run);
  for (const char* name : {"hencky", "zhang"}) {
    if (run.judging.asks_for(name)) judge_by_solution(run, name);
  }
  if (run.judging.asks_for("hencky") && run.judging.asks_for("zhang")) judge_model_form_floor(run);
}

void judge(Judging& judging) {
  const Scene& scene = judging.scene();
  if (!describes_a_column(scene)) return;
  ColumnRun run{judging, scene, column_of(scene), heights_of(scene, judging.record.profile)};
  judge_column_run(run);
}

std::vector<Metric> catalogue() {
  std::vector<Metric> all;
  add_norms(all, "equilibrium.stress", "equilibrium",
            "error of the stress against -q (h0 - X), true for every law");
  for (const std::string name : {"hencky", "zhang"}) {
    const std::string law = name == "hencky" ? "Hencky's column" : "Zhang's column";
    add_norms(all, name + ".stress", name,
              "error of the stress at the particles' current places against " + law);
    add_norms(all, name + ".cell_stress", name,
              "error of each filled cell's mean stress, as the grid sees it, against " + law);
    add_norms(all, name + ".displacement", name, "error of the displacement against " + law);
    all.push_back(
        {name + ".settlement", "-", name, "relative error of the settlement of the top against " + law});
  }
  all.push_back({"floor.stress.l2", "-", "hencky",
                 "model-form floor: relative L2 distance of Zhang's stress from Hencky's"});
  all.push_back({"floor.settlement", "-", "hencky",
                 "model-form floor: Zhang's settlement relative to Hencky's, minus 1"});
  all.push_back(
      {"oscillation.hp", "-", "equilibrium",
       "HP: the error less its local linear fit (1.5 cells either side), relative to the exact stress"});
  all.push_back({"oscillation.ns", "-", "",
                 "NS, of a column: share of the stress in modes that the cells see at less than a tenth of "
                 "the best seen"});
  all.push_back({"settlement", "m", "", "how far the top edge has come down"});
  return all;
}

}  // namespace

NormFamily column_norms() {
  return {{"equilibrium", "hencky", "zhang"}, catalogue(), why_unsuited_to_columns, judge};
}

}  // namespace mpm::vv
