#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "vv/json_reader.hpp"
#include "vv/norms.hpp"

/// To which class each run of a case belongs, and gates on it.
namespace mpm::vv {

/// The metric whose gates name classes instead of a threshold.
inline const std::string class_metric = "class";

/// The key `classification` of a case whose runs and probes are there; nothing if `place` is absent. `read_metric`
/// reads the name of a metric that the case measures. Throws Refusal.
std::optional<Classification> read_classification(
    const JsonPlace& place, const Case& read,
    const std::function<std::string(const JsonPlace&)>& read_metric);

/// The classes that a gate lets pass, at least one. Throws Refusal.
std::vector<StabilityClass> read_classes(const JsonPlace& place);

/// Metrics that tell what the class was told by.
const std::vector<Metric>& classification_catalogue();

/// Tells the class of a run whose other metrics are there, and adds the metrics of the catalogue. Does nothing in a
/// case that does not ask. A run whose signal is too short to tell is left without a class.
void classify(const Case& definition, RunVerdict& run);

/// For a person: "oscillating: ringing 0.031 (limit 0.01)"; of a run without a class why it has none.
std::string diagnosis_of(const Case& definition, const RunVerdict& run);

/// Applies a gate that names classes to a run.
GateResult class_result(const Case& definition, const Gate& gate, const RunVerdict& run);

}  // namespace mpm::vv
