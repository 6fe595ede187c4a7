#include "vv/probe_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <string>
#include <variant>

#include "vv/scene_reader.hpp"
#include "vv/sweep.hpp"

namespace mpm::vv {
namespace {

// ---- probes
// -----------------------------------------------------------------------------------------------------

/// Whether a particle of a ring can lie within half a particle spacing of `at`: along a radius.
bool hits(const Ring& ring, double spacing, const PerAxis& at) {
  const double radius = std::hypot(at[0] - ring.center[0], at[1] - ring.center[1]);
  const double reach = (0.5 + 1e-9) * spacing;
  return radius >= ring.inner_radius - reach && radius <= ring.outer_radius + reach;
}

/// Whether a particle lies within one particle spacing of `at` along every axis, which is to say that `at`
/// lies in a body or at most half a spacing outside it.
bool hits(const Body& body, const Scene& scene, const PerAxis& at) {
  if (body.ring) {
    const double spacing =
        scene.cell_size / *std::min_element(body.particles_per_cell.begin(), body.particles_per_cell.end());
    if (!hits(*body.ring, spacing, at)) return false;
  }
  for (std::size_t axis = 0; axis < axes_of(scene); ++axis) {
    const double spacing = scene.cell_size / body.particles_per_cell[axis];
    // Of a spacing; lets a place exactly on the limit count whichever way its last bit was rounded.
    const double reach = (0.5 + 1e-9) * spacing;
    if (at[axis] < body.lower[axis] - reach || at[axis] > body.upper[axis] + reach) return false;
  }
  return true;
}

void require_hit(const JsonPlace& place, const RunRequest& run, const PerAxis& at) {
  const std::vector<Body>& bodies = run.scene.bodies;
  if (std::any_of(bodies.begin(), bodies.end(), [&](const Body& b) { return hits(b, run.scene, at); }))
    return;
  std::vector<std::string> lengths;
  for (const JsonPlace& length : place.elements()) lengths.push_back(describe(length.value()));
  throw Refusal(place.pointer(), "a place within one particle spacing of a particle",
                listed(lengths) + ", which hits none" + in_run(run));
}

/// What can be recorded of a target, with the components it has.
struct ProbeKind {
  const char* quantity;
  ProbeTarget target;
  enum class Components { none, vector, stress } components;
};

constexpr ProbeKind probe_kinds[] = {
    {"displacement", ProbeTarget::particle, ProbeKind::Components::vector},
    {"velocity", ProbeTarget::particle, ProbeKind::Components::vector},
    {"stress", ProbeTarget::particle, ProbeKind::Components::stress},
    {"displacement", ProbeTarget::rigid_body, ProbeKind::Components::vector},
    {"reaction", ProbeTarget::rigid_body, ProbeKind::Components::vector},
    {"load", ProbeTarget::rigid_body, ProbeKind::Components::none},
    {"displacement", ProbeTarget::body, ProbeKind::Components::vector},
    {"velocity", ProbeTarget::body, ProbeKind::Components::vector},
    {"weight", ProbeTarget::body, ProbeKind::Components::none},
    {"load", ProbeTarget::body, ProbeKind::Components::none},
    {"momentum", ProbeTarget::everything, ProbeKind::Components::vector},
    {"kinetic_energy", ProbeTarget::everything, ProbeKind::Components::none},
    {"strain_energy", ProbeTarget::everything, ProbeKind::Components::none},
    {"potential_energy", ProbeTarget::everything, ProbeKind::Components::none},
    {"stress_work", ProbeTarget::everything, ProbeKind::Components::none},
};

std::vector<std::string> probe_quantities() {
  std::vector<std::string> names;
  for (const ProbeKind& kind : probe_kinds) {
    if (!contains(names, kind.quantity)) names.push_back(kind.quantity);
  }
  return names;
}

const ProbeKind* find_probe_kind(const std::string& quantity, ProbeTarget target) {
  const auto kind = std::find_if(std::begin(probe_kinds), std::end(probe_kinds), [&](const ProbeKind& k) {
    return k.quantity == quantity && k.target == target;
  });
  return kind == std::end(probe_kinds) ? nullptr : &*kind;
}

/// The names in the scene that a quantity can be recorded of.
std::vector<std::string> probed_names(const Scene& scene, const std::string& quantity) {
  std::vector<std::string> names;
  if (find_probe_kind(quantity, ProbeTarget::rigid_body)) names = names_of(scene.rigid_bodies);
  if (find_probe_kind(quantity, ProbeTarget::body)) {
    const std::vector<std::string> bodies = names_of(scene.bodies);
    names.insert(names.end(), bodies.begin(), bodies.end());
  }
  return names;
}

/// What a probe of `quantity` with these keys looks at; of a named thing only whether there is a name.
ProbeTarget read_target(const JsonPlace& place, const std::string& quantity) {
  const bool particle = find_probe_kind(quantity, ProbeTarget::particle);
  const bool named =
      find_probe_kind(quantity, ProbeTarget::rigid_body) || find_probe_kind(quantity, ProbeTarget::body);
  std::vector<std::string> keys = {"id", "quantity"};
  if (particle) keys.push_back("at");
  if (named) keys.push_back("of");
  if (quantity == "momentum" || particle || quantity == "reaction") keys.push_back("component");
  keys.push_back("every");
  place.allow_only(keys);
  if (particle && named && place["at"].present() == place["of"].present()) {
    throw Refusal(place.pointer(), "either at or of", place["at"].present() ? "both" : "neither");
  }
  if (particle && (place["at"].present() || !named)) return ProbeTarget::particle;
  return named ? ProbeTarget::body : ProbeTarget::everything;
}

/// Finds the body or rigid body of the name in the scene of a run.
void read_named(const JsonPlace& place, const RunRequest& run, HistoryProbe& probe) {
  const std::vector<std::string> names = probed_names(run.scene, probe.quantity);
  if (names.empty()) place.refuse("the name of a rigid body, of which the scene has none");
  probe.of = place.one_of(names);
  const bool rigid = contains(names_of(run.scene.rigid_bodies), probe.of);
  probe.target = rigid ? ProbeTarget::rigid_body : ProbeTarget::body;
}

std::vector<std::string> component_names(const ProbeKind& kind, std::size_t axes) {
  return kind.components == ProbeKind::Components::stress ? keys_of(axes, {"xx"}, {"yy", "zz", "xy"})
                                                          : keys_of(axes, {"x"}, {"y"});
}

/// In other components a rigid body has no reaction.
void require_constrained(const JsonPlace& place, const RunRequest& run, const HistoryProbe& probe,
                         const std::string& component) {
  const auto body = std::find_if(run.scene.rigid_bodies.begin(), run.scene.rigid_bodies.end(),
                                 [&](const RigidBody& b) { return b.name == probe.of; });
  if (!body->constrains[component == "x" ? 0 : 1]) {
    throw Refusal(place.pointer(), "a component that " + probe.of + " constrains",
                  component + ", in which it has no reaction" + in_run(run));
  }
}

void read_component(const JsonPlace& place, const RunRequest& run, HistoryProbe& probe) {
  const ProbeKind& kind = *find_probe_kind(probe.quantity, probe.target);
  const std::size_t axes = axes_of(run.scene);
  if (kind.components != ProbeKind::Components::none) {
    const std::vector<std::string> names = component_names(kind, axes);
    probe.component = place.present() ? place.one_of(names) : names[axes - 1];
  }
  if (probe.quantity == "reaction") require_constrained(place, run, probe, probe.component);
  if (probe.quantity == "load" && probe.target == ProbeTarget::rigid_body)
    require_constrained(place, run, probe, axes == 1 ? "x" : "y");
}


/// Checks a probe against the scene of a run and fills in what only the scene tells.
void read_probed(const JsonPlace& place, const RunRequest& run, HistoryProbe& probe) {
  if (place["at"].present()) {
    probe.at = read_per_axis(place["at"], axes_of(run.scene), QuantityKind::length);
    require_hit(place["at"], run, probe.at);
  }
  if (probe.target == ProbeTarget::body || probe.target == ProbeTarget::rigid_body)
    read_named(place["of"], run, probe);
  read_component(place["component"], run, probe);
  if (probe.quantity == "stress_work" && !run.scene.sums_work)
    place["quantity"].refuse("a quantity that the scene keeps",
                             ", which needs sums_work to be true" + in_run(run));
}

HistoryProbe read_probe(const JsonPlace& place, const std::vector<RunRequest>& runs,
                        const std::vector<HistoryProbe>& earlier) {
  HistoryProbe probe;
  probe.quantity = place["quantity"].one_of(probe_quantities());
  probe.target = read_target(place, probe.quantity);
  probe.id = place["id"].own_identifier(ids_of(earlier));
  probe.every = place["every"].quantity(QuantityKind::time);
  if (probe.every <= 0.0) place["every"].refuse("a time above zero");
  read_probed(place, runs.front(), probe);
  for (const RunRequest& run : runs) {
    HistoryProbe again = probe;
    read_probed(place, run, again);
    const bool named = probe.target == ProbeTarget::body || probe.target == ProbeTarget::rigid_body;
    if ((again.target != probe.target && !named) || again.component != probe.component) {
      throw Refusal(place.pointer(), "a probe that means the same in every run",
                    "one that means something else" + in_run(run));
    }
  }
  return probe;
}

// ---- snapshots
// --------------------------------------------------------------------------------------------------

std::vector<std::string> displacement_probes(const std::vector<HistoryProbe>& probes) {
  std::vector<std::string> ids;
  for (const HistoryProbe& probe : probes) {
    if (probe.quantity == "displacement") ids.push_back(probe.id);
  }
  return ids;
}

double read_snapshot_time(const JsonPlace& place, const std::vector<RunRequest>& runs) {
  const double time = place.quantity(QuantityKind::time);
  if (time < 0.0) place.refuse("a time, zero or above");
  for (const RunRequest& run : runs) {
    if (time > latest_end(run.scene))
      place.refuse("a time before the run has ended", ", which is later" + in_run(run));
  }
  return time;
}

SnapshotRequest read_snapshot(const JsonPlace& place, const std::vector<RunRequest>& runs,
                              const std::vector<HistoryProbe>& probes) {
  place.allow_only({"time", "probe", "reaches", "end"});
  const JsonPlace time = place["time"], probe = place["probe"], reaches = place["reaches"],
                  end = place["end"];
  const bool passing = probe.present() || reaches.present();
  const int ways = (time.present() ? 1 : 0) + (passing ? 1 : 0) + (end.present() ? 1 : 0);
  if (ways != 1) {
    throw Refusal(place.pointer(), "either time, or probe and reaches, or end",
                  ways == 0 ? "none of them" : "more than one of them");
  }
  SnapshotRequest snapshot;
  if (time.present()) {
    snapshot.when = SnapshotRequest::When::time;
    snapshot.time = read_snapshot_time(time, runs);
  } else if (passing) {
    const std::vector<std::string> ids = displacement_probes(probes);
    if (ids.empty()) probe.refuse("the id of a displacement probe, of which this case has none");
    snapshot.when = SnapshotRequest::When::passing;
    snapshot.probe = probe.one_of(ids);
    snapshot.value = reaches.quantity(QuantityKind::length);
  } else if (!end.flag()) {
    end.refuse("true");
  }
  return snapshot;
}

}  // namespace

std::vector<HistoryProbe> read_probes(const JsonPlace& place, const std::vector<RunRequest>& runs) {
  std::vector<HistoryProbe> probes;
  if (!place.present()) return probes;
  for (const JsonPlace& element : place.elements()) probes.push_back(read_probe(element, runs, probes));
  return probes;
}

std::vector<SnapshotRequest> read_snapshots(const JsonPlace& place, const std::vector<RunRequest>& runs,
                                            const std::vector<HistoryProbe>& probes) {
  std::vector<SnapshotRequest> snapshots;
  if (!place.present()) return snapshots;
  for (const JsonPlace& element : place.elements()) {
    snapshots.push_back(read_snapshot(element, runs, probes));
    for (std::size_t earlier = 0; earlier + 1 < snapshots.size(); ++earlier) {
      if (snapshots[earlier] == snapshots.back())
        element.refuse("each moment once", ", the moment of an earlier one");
    }
  }
  return snapshots;
}

}  // namespace mpm::vv
