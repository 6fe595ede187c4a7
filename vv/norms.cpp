#include "vv/norms.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "reference/column.hpp"
#include "solver/shape_functions.hpp"

namespace mpm::vv {
namespace {

using Values = std::vector<double>;

/// L1 and L2 weighted by volume, L-infinity; each relative to the same norm of the exact field.
struct RelativeNorms {
  double l1, l2, linf;
};

RelativeNorms relative_norms(const Values& found, const Values& exact, const Values& weight) {
  double e1 = 0, e2 = 0, em = 0, n1 = 0, n2 = 0, nm = 0;
  for (std::size_t p = 0; p < found.size(); ++p) {
    const double error = std::abs(found[p] - exact[p]), norm = std::abs(exact[p]);
    e1 += weight[p] * error;
    n1 += weight[p] * norm;
    e2 += weight[p] * error * error;
    n2 += weight[p] * norm * norm;
    // Not std::max: it would drop an error that is not a number.
    if (!(error <= em)) em = error;
    nm = std::max(nm, norm);
  }
  return {e1 / n1, std::sqrt(e2 / n2), em / nm};
}

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

/// Particles within `reach` of a place, or the three nearest if there are fewer. Positions need not be
/// sorted.
std::vector<std::size_t> neighbours(const Values& position, double place, double reach) {
  std::vector<std::size_t> order(position.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto distance = [&](std::size_t p) { return std::abs(position[p] - place); };
  const auto within = static_cast<std::size_t>(
      std::count_if(order.begin(), order.end(), [&](std::size_t p) { return distance(p) <= reach; }));
  const std::size_t count = std::min(std::max<std::size_t>(within, 3), order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
                    [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
  order.resize(count);
  return order;
}

/// Value at `place` of the weighted least-squares line through the chosen points.
double line_through(const Values& x, const Values& y, const Values& weight,
                    const std::vector<std::size_t>& chosen, double place) {
  double w = 0, wx = 0, wy = 0, wxx = 0, wxy = 0;
  for (std::size_t p : chosen) {
    const double d = x[p] - place;
    w += weight[p];
    wx += weight[p] * d;
    wy += weight[p] * y[p];
    wxx += weight[p] * d * d;
    wxy += weight[p] * d * y[p];
  }
  const double determinant = w * wxx - wx * wx;
  // All points in one place have no line; their mean is the value there.
  if (!(determinant > 1e-12 * w * wxx)) return wy / w;
  return (wxx * wy - wx * wxy) / determinant;
}

/// The axis a column stands along: the last one.
std::size_t axis_of(const Scene& scene) { return static_cast<std::size_t>(scene.dimension) - 1; }

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
      const std::int32_t first = Shape::first_node(x, half_size);
      std::array<double, Shape::width> weight, gradient;
      Shape::evaluate(x, half_size, first, weight, gradient);
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

/// Everything the norms of one run are computed from.
struct Judging {
  const Case& definition;
  const Scene& scene;
  const Record& record;
  reference::Column column;
  Profile heights;  ///< the record's, with positions above the column's base
  Judgement result;

  const Profile& profile() const { return heights; }
  void set(const std::string& name, double value) {
    if (std::isfinite(value)) result.metrics[name] = value;
  }
  void set_norms(const std::string& name, const RelativeNorms& norms) {
    set(name + ".l1", norms.l1);
    set(name + ".l2", norms.l2);
    set(name + ".linf", norms.linf);
  }
  bool asks_for(const std::string& reference) const {
    const auto& all = definition.references;
    return std::find(all.begin(), all.end(), reference) != all.end();
  }
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
double top_of(const Judging& judging) {
  return judging.column.height - settlement_of(judging.scene, judging.profile());
}

/// Error of the mean stress of every cell that the column fills, against the exact mean. What the grid's
/// equilibrium constrains is this mean; the share of each particle in it is left to the particles.
void judge_cell_means(Judging& judging, const std::string& name, const reference::ColumnSolution& exact) {
  const Profile& profile = judging.profile();
  const double h = judging.scene.cell_size;
  const auto filled = static_cast<std::size_t>(std::max(0.0, top_of(judging) / h));
  if (filled == 0) return;
  const Eigen::VectorXd mean = lengths_in_cells(judging.scene, profile) * as_vector(profile.stress);
  Values found(filled), expected(filled);
  for (std::size_t c = 0; c < filled; ++c) {
    const double lower = static_cast<double>(c) * h;
    found[c] = mean[static_cast<Eigen::Index>(c) + ghost_layers];
    expected[c] =
        (exact.stress(lower) + 4 * exact.stress(lower + h / 2) + exact.stress(lower + h)) / 6;  // Simpson
  }
  judging.set_norms(name + ".cell_stress", relative_norms(found, expected, Values(filled, 1.0)));
}

void judge_by_solution(Judging& judging, const std::string& name) {
  const Profile& profile = judging.profile();
  const auto exact = reference::column_solution(name, judging.column);
  const Values stress = map(profile.position, [&](double x) { return exact->stress(x); });
  const Values displacement = map(profile.initial_position, [&](double x) { return exact->displacement(x); });
  judging.set_norms(name + ".stress", relative_norms(profile.stress, stress, profile.volume));
  judging.set_norms(name + ".displacement",
                    relative_norms(profile.displacement, displacement, profile.initial_volume));
  judging.set(name + ".settlement",
              std::abs(settlement_of(judging.scene, profile) / exact->settlement() - 1));
  judging.result.curves.push_back({"stress", name, profile.position, stress, "position"});
  judging.result.curves.push_back(
      {"displacement", name, profile.initial_position, displacement, "initial_position"});
  judge_cell_means(judging, name, *exact);
}

void judge_by_equilibrium(Judging& judging) {
  const Profile& profile = judging.profile();
  const Values exact = map(profile.initial_position,
                           [&](double x) { return reference::equilibrium_stress(judging.column, x); });
  judging.set_norms("equilibrium.stress", relative_norms(profile.stress, exact, profile.volume));

  const Values error = difference(profile.stress, exact);
  Values rough(error.size());
  for (std::size_t p = 0; p < error.size(); ++p) {
    const auto near = neighbours(profile.position, profile.position[p], 1.5 * judging.scene.cell_size);
    rough[p] = error[p] - line_through(profile.position, error, profile.volume, near, profile.position[p]);
  }
  judging.set("oscillation.hp", weighted_norm(rough, profile.volume) / weighted_norm(exact, profile.volume));

  const double largest = std::abs(reference::equilibrium_stress(judging.column, 0.0));
  judging.result.curves.push_back({"stress", "equilibrium", profile.position, exact, "position"});
  judging.result.curves.push_back({"stress_error", "run", profile.initial_position,
                                   map(error, [&](double e) { return e / largest; }), "initial_position"});
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

void judge_model_form_floor(Judging& judging) {
  const auto hencky = reference::column_solution("hencky", judging.column);
  const auto zhang = reference::column_solution("zhang", judging.column);
  judging.set("floor.stress.l2", reference::stress_distance(*zhang, *hencky));
  judging.set("floor.settlement", std::abs(zhang->settlement() / hencky->settlement() - 1));
}

bool is_finite(const Values& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

double count_non_finite(const Record& record) {
  double count = 0;
  const auto add = [&](const Values& values) {
    count += static_cast<double>(
        std::count_if(values.begin(), values.end(), [](double value) { return !std::isfinite(value); }));
  };
  const Profile& p = record.profile;
  for (const Values* field : {&p.position, &p.displacement, &p.stress, &p.volume, &p.half_size}) add(*field);
  for (const History& history : record.histories) add(history.value);
  for (const ElementCurve& path : record.paths) add(path.value);
  for (const auto& [name, value] : record.measured) add({value});
  return count;
}

/// Cells stand for rows of cells only where nothing varies sideways.
bool describes_a_column(const Scene& scene) {
  return scene.dimension == 1 || why_unsuited("equilibrium", scene).empty();
}

void judge_final_state(Judging& judging) {
  const Profile& profile = judging.profile();
  judging.set("settlement", settlement_of(judging.scene, profile));
  double least = 1.0;
  for (std::size_t p = 0; p < profile.volume.size(); ++p) {
    least = std::min(least, profile.volume[p] / profile.initial_volume[p]);
  }
  judging.set("largest_compression", 1 - least);
  judging.set("unbalanced_force_ratio", judging.record.unbalanced_force_ratio);
  judging.set("kinetic_energy_ratio", judging.record.kinetic_energy_ratio);
  judging.result.curves.push_back({"stress", "run", profile.position, profile.stress, "position"});
  judging.result.curves.push_back(
      {"displacement", "run", profile.initial_position, profile.displacement, "initial_position"});
  if (!is_finite(profile.stress) || !is_finite(profile.position)) return;
  if (describes_a_column(judging.scene)) judging.set("oscillation.ns", unseen_share(judging.scene, profile));
  if (judging.asks_for("equilibrium")) judge_by_equilibrium(judging);
  for (const char* name : {"hencky", "zhang"}) {
    if (judging.asks_for(name)) judge_by_solution(judging, name);
  }
  if (judging.asks_for("hencky") && judging.asks_for("zhang")) judge_model_form_floor(judging);
}

std::vector<Metric> make_catalogue() {
  std::vector<Metric> all;
  const auto add_norms = [&](const std::string& field, const std::string& reference,
                             const std::string& what) {
    all.push_back(
        {field + ".l1", "-", reference, what + ": L1, volume weighted, relative to the exact field"});
    all.push_back(
        {field + ".l2", "-", reference, what + ": L2, volume weighted, relative to the exact field"});
    all.push_back(
        {field + ".linf", "-", reference, what + ": largest error relative to the largest exact value"});
  };
  add_norms("equilibrium.stress", "equilibrium",
            "error of the stress against -q (h0 - X), true for every law");
  for (const std::string name : {"hencky", "zhang"}) {
    const std::string law = name == "hencky" ? "Hencky's column" : "Zhang's column";
    add_norms(name + ".stress", name, "error of the stress at the particles' current places against " + law);
    add_norms(name + ".cell_stress", name,
              "error of each filled cell's mean stress, as the grid sees it, against " + law);
    add_norms(name + ".displacement", name, "error of the displacement against " + law);
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
  all.push_back({"largest_compression", "-", "", "1 - the least ratio of current to initial volume"});
  all.push_back({"cell_crossings", "-", "", "particle centres that changed cell, counted every step"});
  all.push_back({"unbalanced_force_ratio", "-", "",
                 "unbalanced force felt by the particles at the end / total weight"});
  all.push_back({"kinetic_energy_ratio", "-", "",
                 "kinetic energy of the grid at the end / (total weight * cell size)"});
  all.push_back({"mass_change", "-", "", "relative change of the total mass, end against start"});
  all.push_back({"non_finite_values", "-", "", "values in the record that are not finite numbers"});
  all.push_back(
      {"bits_differ", "-", "", "0 if a repeat on another number of threads ends in the same bits, else 1"});
  all.push_back({"completed", "-", "", "1 if the run ended where it was meant to, else 0"});
  all.push_back({"steps", "-", "", "time steps done"});
  all.push_back({"particle_steps", "-", "", "time steps times particles: the noise-free cost"});
  for (const ElementMetric& metric : element_metrics()) {
    all.push_back({metric.name, "-", metric.needs_closed_form ? "closed_form" : "", metric.meaning});
  }
  return all;
}

/// An element test is judged by its curves; what only the law could tell has been measured already.
Judgement judge_element(const ElementTest& test, const Record& record) {
  Judgement result;
  result.metrics = record.measured;
  result.metrics.merge(judge_element_curves(test, record.paths));
  result.metrics["completed"] = record.completed() ? 1 : 0;
  result.metrics["steps"] = static_cast<double>(record.cost.steps);
  result.metrics["non_finite_values"] = count_non_finite(record);
  std::erase_if(result.metrics, [](const auto& metric) { return !std::isfinite(metric.second); });
  for (const ElementCurve& path : record.paths)
    result.curves.push_back({path.id, "run", path.strain, path.value, "strain"});
  for (const ElementCurve& path : closed_form(test, record.paths))
    result.curves.push_back({path.id, "closed_form", path.strain, path.value, "strain"});
  return result;
}

}  // namespace

const std::vector<Metric>& metric_catalogue() {
  static const std::vector<Metric> catalogue = make_catalogue();
  return catalogue;
}

const std::vector<std::string>& reference_catalogue() {
  static const std::vector<std::string> catalogue{"equilibrium", "hencky", "zhang", "closed_form"};
  return catalogue;
}

std::string why_unsuited(const std::string& reference, const Scene& scene) {
  if (reference == "closed_form") return "an element test";
  // Every other reference solution there is describes a column under its own weight.
  const Body& body = scene.bodies.front();
  const std::size_t axis = axis_of(scene);
  const std::string name = axis == 0 ? "x" : "y";
  if (scene.bodies.size() != 1) return "a single body";
  if (scene.edges[axis][0] == Condition::free) return "a fixed " + name + "_lower edge";
  if (scene.edges[axis][1] != Condition::free) return "a free " + name + "_upper edge";
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

std::string why_unsuited(const std::string& reference, const RunRequest& request) {
  if (!request.element) return why_unsuited(reference, request.scene);
  return reference == "closed_form" ? "" : "a scene";
}

Judgement judge(const Case& definition, const RunRequest& request, const Record& record) {
  if (request.element) return judge_element(*request.element, record);
  Judging judging{
      definition, request.scene, record, column_of(request.scene), heights_of(request.scene, record.profile),
      {}};
  judging.set("completed", record.completed() ? 1 : 0);
  judging.set("cell_crossings", static_cast<double>(record.cell_crossings));
  judging.set("steps", static_cast<double>(record.cost.steps));
  judging.set("particle_steps", static_cast<double>(record.cost.particle_steps));
  judging.set("non_finite_values", count_non_finite(record));
  if (record.failure.empty()) judging.set("mass_change", std::abs(record.relative_mass_change));
  for (const History& history : record.histories) {
    judging.result.curves.push_back({history.id, "run", history.time, history.value, "time"});
  }
  if (record.completed()) judge_final_state(judging);
  return judging.result;
}

}  // namespace mpm::vv
