#include "vv/norms.hpp"

#include <algorithm>
#include <cmath>

#include "vv/classification.hpp"
#include "vv/judging.hpp"
#include "vv/metamorphic.hpp"
#include "vv/step_cost.hpp"

namespace mpm::vv {
namespace {

const std::vector<NormFamily>& families() {
  static const std::vector<NormFamily> all{column_norms(),      footing_norms(), mechanism_norms(),
                                           collapse_norms(),    motion_norms(),  element_norms(),
                                           conservation_norms(), stability_norms()};
  return all;
}

double count_non_finite(const Record& record) {
  double count = 0;
  const auto add = [&](const Values& values) {
    count += static_cast<double>(
        std::count_if(values.begin(), values.end(), [](double value) { return !std::isfinite(value); }));
  };
  const Profile& p = record.profile;
  for (const Values* field : {&p.position, &p.displacement, &p.stress, &p.volume, &p.half_size}) add(*field);
  // The profile is a part of the final state.
  count = std::max(count, static_cast<double>(record.non_finite_values));
  for (const History& history : record.histories) add(history.value);
  for (const ElementCurve& path : record.paths) add(path.value);
  for (const auto& [name, value] : record.measured) add({value});
  return count;
}

double largest_compression(const Profile& profile) {
  double largest = 0.0;
  for (std::size_t p = 0; p < profile.volume.size(); ++p) {
    largest = larger(largest, 1 - profile.volume[p] / profile.initial_volume[p]);
  }
  return largest;
}

/// What is measured of every run, whatever it is about.
std::vector<Metric> general_metrics() {
  std::vector<Metric> all;
  all.push_back({"largest_compression", "-", "", "1 - the least ratio of current to initial volume"});
  all.push_back({"cell_crossings", "-", "", "particle centres that changed cell, counted every step"});
  all.push_back({"unbalanced_force_ratio", "-", "",
                 "unbalanced force felt by the particles at the end / total weight"});
  all.push_back({"kinetic_energy_ratio", "-", "",
                 "kinetic energy of the grid at the end / (total weight * cell size)"});
  for (const Metamorphosis& metamorphosis : metamorphosis_catalogue()) {
    all.push_back({metamorphic_prefix + metamorphosis.name, "-", "",
                   "largest relative difference to the run of the same scene otherwise described: " +
                       metamorphosis.meaning});
  }
  all.push_back({"mass_change", "-", "", "relative change of the total mass, end against start"});
  all.push_back({"non_finite_values", "-", "", "values in the record that are not finite numbers"});
  all.push_back(
      {"bits_differ", "-", "", "0 if a repeat on another number of threads ends in the same bits, else 1"});
  all.push_back({"completed", "-", "", "1 if the run ended where it was meant to, else 0"});
  all.push_back({"steps", "-", "", "time steps done"});
  all.push_back({"energy_ratio", "-", "",
                 "largest energy of motion over all energy that had gone in; above 1 some came from nowhere"});
  all.push_back({"particle_steps", "-", "", "time steps times particles: the noise-free cost"});
  all.push_back(
      {"counted_bytes", "-", "", "bytes that the steps move between memory and processor, counted"});
  all.push_back({"counted_operations", "-", "", "floating-point operations of the steps, counted"});
  return all;
}

/// What is measured of every run of a scene, whatever it is about.
void judge_scene(Judging& judging) {
  const Record& record = judging.record;
  judging.set("energy_ratio", record.largest_energy_ratio);
  judging.set("cell_crossings", static_cast<double>(record.cell_crossings));
  const CountedWork work = counted_work(judging.scene(), record.cost.particle_steps);
  judging.set("particle_steps", work.particle_steps);
  judging.set("counted_bytes", work.bytes);
  judging.set("counted_operations", work.operations);
  if (record.failure.empty()) judging.set("mass_change", std::abs(record.relative_mass_change));
  for (const History& history : record.histories) {
    judging.result.curves.push_back({history.id, "run", history.time, history.value, "time"});
  }
  if (!record.completed()) return;
  judging.set("largest_compression", largest_compression(record.profile));
  judging.set("unbalanced_force_ratio", record.unbalanced_force_ratio);
  judging.set("kinetic_energy_ratio", record.kinetic_energy_ratio);
}

std::vector<Metric> make_catalogue() {
  std::vector<Metric> all;
  for (const NormFamily& family : families()) {
    all.insert(all.end(), family.metrics.begin(), family.metrics.end());
  }
  const std::vector<Metric> general = general_metrics();
  all.insert(all.end(), general.begin(), general.end());
  const std::vector<Metric>& classes = classification_catalogue();
  all.insert(all.end(), classes.begin(), classes.end());
  return all;
}

std::vector<std::string> make_reference_catalogue() {
  std::vector<std::string> all;
  for (const NormFamily& family : families()) {
    all.insert(all.end(), family.references.begin(), family.references.end());
  }
  return all;
}

}  // namespace

const History* history_of(const Judging& judging, const std::string& quantity, const std::string& component) {
  for (std::size_t i = 0; i < judging.definition.probes.size(); ++i) {
    const HistoryProbe& probe = judging.definition.probes[i];
    if (probe.quantity == quantity && (component.empty() || probe.component == component)) {
      return &judging.record.histories.at(i);
    }
  }
  return nullptr;
}

double larger(double a, double b) { return a >= b || std::isnan(a) ? a : b; }

RelativeNorms relative_norms(const Values& found, const Values& exact, const Values& weight) {
  double e1 = 0, e2 = 0, em = 0, n1 = 0, n2 = 0, nm = 0;
  for (std::size_t p = 0; p < found.size(); ++p) {
    const double error = std::abs(found[p] - exact[p]), norm = std::abs(exact[p]);
    e1 += weight[p] * error;
    n1 += weight[p] * norm;
    e2 += weight[p] * error * error;
    n2 += weight[p] * norm * norm;
    em = larger(em, error);
    nm = larger(nm, norm);
  }
  return {e1 / n1, std::sqrt(e2 / n2), em / nm};
}

void set_norms(Judging& judging, const std::string& name, const RelativeNorms& norms) {
  judging.set(name + ".l1", norms.l1);
  judging.set(name + ".l2", norms.l2);
  judging.set(name + ".linf", norms.linf);
}

void add_norms(std::vector<Metric>& catalogue, const std::string& field, const std::string& reference,
               const std::string& what) {
  catalogue.push_back(
      {field + ".l1", "-", reference, what + ": L1, volume weighted, relative to the exact field"});
  catalogue.push_back(
      {field + ".l2", "-", reference, what + ": L2, volume weighted, relative to the exact field"});
  catalogue.push_back(
      {field + ".linf", "-", reference, what + ": largest error relative to the largest exact value"});
}

void Judging::set(const std::string& name, double value) {
  if (std::isfinite(value)) result.metrics[name] = value;
}

bool Judging::asks_for(const std::string& reference) const {
  return contains(definition.references, reference);
}

std::size_t axis_of(const Scene& scene) { return static_cast<std::size_t>(scene.dimension) - 1; }

const std::vector<Metric>& metric_catalogue() {
  static const std::vector<Metric> catalogue = make_catalogue();
  return catalogue;
}

const std::vector<std::string>& reference_catalogue() {
  static const std::vector<std::string> catalogue = make_reference_catalogue();
  return catalogue;
}

std::string why_unsuited(const std::string& reference, const Scene& scene) {
  for (const NormFamily& family : families()) {
    if (contains(family.references, reference)) return family.why_unsuited(reference, scene);
  }
  return "to be known";
}

std::string why_unsuited(const std::string& reference, const RunRequest& request) {
  if (!request.element) return why_unsuited(reference, request.scene);
  return reference == "closed_form" ? "" : "a scene";
}

std::string why_not_judged(const std::string& reference, const Case& definition, const RunRequest& request) {
  for (const NormFamily& family : families()) {
    if (!contains(family.references, reference)) continue;
    return family.why_not_judged ? family.why_not_judged(reference, definition, request) : "";
  }
  return "to be known";
}

Judgement judge(const Case& definition, const RunRequest& request, const Record& record) {
  Judging judging{definition, request, record, {}};
  judging.set("completed", record.completed() ? 1 : 0);
  judging.set("steps", static_cast<double>(record.cost.steps));
  judging.set("non_finite_values", count_non_finite(record));
  if (definition.survey) {
    stability_norms().judge(judging);
    return judging.result;
  }
  if (!request.element) judge_scene(judging);
  for (const auto& [name, value] : record.measured) judging.set(name, value);
  for (const NormFamily& family : families()) {
    if (family.judge_course && !request.element) family.judge_course(judging);
  }
  if (!record.completed()) return judging.result;
  for (const NormFamily& family : families()) family.judge(judging);
  return judging.result;
}

}  // namespace mpm::vv
