#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "solver/scene.hpp"
#include "vv/curve_file.hpp"
#include "vv/element_test.hpp"
#include "vv/model_choice.hpp"
#include "vv/survey.hpp"

namespace mpm::reference {
class ManufacturedSolution;
}

namespace mpm::vv {

using Json = nlohmann::ordered_json;

/// Bad input, in one line: file, JSON pointer, what was expected there and what was found.
class CaseError : public std::runtime_error {
 public:
  CaseError(const std::string& file, const std::string& pointer, const std::string& expected,
            const std::string& found)
      : std::runtime_error(file + ": " + (pointer.empty() ? "/" : pointer) + ": expected " + expected + ", found " + found) {}
};

enum class Comparison { at_most, at_least };

/// What a gate compares: a metric of each run, or a property of the series of a metric or curve along an axis
/// of the sweep. A series goes from the coarsest cell size to the finest, runs of one size in the order of
/// the sweep.
enum class Statistic {
  value,         ///< the metric itself, one result per run
  reduction,     ///< first / last of the series
  worst_ratio,   ///< largest (next / previous) along the series; below 1 means it falls at every step
  last_order,    ///< observed order of the last pair
  least_ratio,   ///< smallest (next / previous) along the series; above 1 means it grows at every step
  spread,        ///< (largest - smallest) / magnitude of the mean, of the series
  curve_spread,  ///< how far apart the curves of the series are: `curve_spread` of vv/curves.hpp
  discretisation_uncertainty,  ///< of the finest value: `grid_convergence` of vv/grid_convergence.hpp
  power_exponent,     ///< n of the least-squares power law metric = c over^n of the series
  power_coefficient,  ///< c of the same
  bias,           ///< of pairs: `ModelFactor::bias` of vv/measurement.hpp
  scatter,        ///< of pairs: `ModelFactor::scatter`
  model_scatter,  ///< of pairs: `ModelFactor::model_scatter`
};

/// A sweep value that restricts a gate or a figure to some runs: parameter and allowed values.
struct Selector {
  std::string parameter;  ///< as the axis of the sweep has it
  std::vector<Json> values;
};

struct Gate {
  std::string id;
  std::string metric;  ///< a name in `metric_catalogue()` of vv/norms.hpp or a reading; empty for a curve
  std::string curve;   ///< of curve_spread: name of a curve of the runs
  std::string over;    ///< of power laws: the metric that is the abscissa
  std::string pairs;   ///< of bias and scatter: id of the case's pairs
  std::optional<double> from, up_to;  ///< of curve_spread: its ends; else those that all curves share
  double within = 0.0;                ///< of curve_spread: half-width of a moving mean; 0 for none
  Statistic statistic = Statistic::value;
  std::string across;  ///< swept parameter that makes the series, for the series statistics; else empty
  std::vector<Selector> where;
  Comparison comparison = Comparison::at_most;
  double threshold = 0.0;
  std::string basis;   ///< theory, requirement, fit or reference_uncertainty
  std::string reason;  ///< why this threshold, for a person
  bool must_fail = false;  ///< a control: the configuration is known to be bad and the gate must turn red
  std::vector<StabilityClass> classes = {};  ///< of the metric `class`: those that pass; its comparison is not read
  std::string advice = {};  ///< of the same, for a person: what to do in such a scene; may be empty
};

/// What a claim turned out to be, as long as the gates it rests on are good.
enum class Finding {
  seen,      ///< the runs show what is claimed
  not_seen,  ///< the runs show that it is not so here
  depends,   ///< on circumstances the remark names
  untested,  ///< for want of what the remark names; rests on no gate
};

/// A statement of the paper or of theory that the case puts to the test.
struct Claim {
  std::string text;  ///< who says what, and where
  Finding finding = Finding::seen;
  std::vector<std::string> gates;  ///< ids of the gates that establish the finding, at least one; none if untested
  std::string remark;              ///< for a person; required unless the claim is seen
};

/// Another place of the scene that changes together with a swept parameter.
struct Follower {
  std::string parameter;     ///< JSON pointer into the case, below /scene or /element
  std::vector<Json> values;  ///< one for each value of the axis
};

/// A setting of the scene that has a name.
struct Variant {
  std::string name;                               ///< for a person; unlike the axis's other variants'
  std::vector<std::pair<std::string, Json>> set;  ///< JSON pointer below /scene or /element, and what it becomes
  std::vector<std::string> remove = {};           ///< JSON pointers to what the scene is without
};

/// What a sweep goes through: the values of a parameter, or variants of the scene.
struct SweepAxis {
  std::string parameter;    ///< JSON pointer into the case, below /scene or /element, which alone names the runs;
                            ///< of variants the name of the axis, an identifier
  std::vector<Json> values;  ///< of variants their names
  std::vector<Follower> with = {};
  std::vector<Variant> variants = {};  ///< one for each value, or none
};

/// What a history probe looks at.
enum class ProbeTarget {
  particle,    ///< the particle nearest to `at` (initial place): displacement, velocity, stress
  // A name may belong to a rigid body in some runs of a sweep and to a body in others; the scene tells.
  rigid_body,  ///< the rigid body named `of`: displacement; reaction and load, means since the last sample
  body,        ///< all particles of the body named `of`: displacement and velocity (means by mass), weight, load
  everything,  ///< all particles: momentum, kinetic_energy, strain_energy
};

/// A history probe: one number every `every` seconds.
struct HistoryProbe {
  std::string id;
  std::string quantity;   ///< see `target`
  std::string component;  ///< x or y of a vector, xx, yy, zz or xy of a stress, empty of an energy and of a weight
  ProbeTarget target = ProbeTarget::particle;
  PerAxis at{};        ///< of a particle: initial place [m]
  std::string of;      ///< of a body or rigid body: its name
  double every = 0.0;  ///< sampling interval [s]
};

/// A moment at which the state of every particle is kept.
struct SnapshotRequest {
  enum class When { time, passing, end };
  When when = When::end;
  double time = 0.0;   ///< the first step that ends at or after it [s]
  std::string probe;   ///< passing: id of a displacement probe ...
  double value = 0.0;  ///< ... and the value it reaches or crosses for the first time at one of its samples [m]

  friend bool operator==(const SnapshotRequest&, const SnapshotRequest&) = default;
};

/// A number read off a curve of each run: the metric `reading.<id>`.
struct Reading {
  std::string id;
  std::string title;    ///< one line for a person, for example "pressure at 25 mm"
  std::string curve;    ///< name of a curve of the runs
  double at = 0.0;      ///< abscissa: a settlement [m], of an element test a strain [-]
  double within = 0.0;  ///< half-width of the mean taken there; 0 interpolates between the samples
  std::string over;  ///< a reference solution by whose curve, read alike, the number is divided; may be empty
};

/// A scalar of a snapshot along a straight line through the scene: a curve of each run.
struct Cut {
  std::string id;        ///< names the curve
  std::string quantity;  ///< a name in `field_catalogue()` of vv/field_map.hpp
  int snapshot = 0;      ///< index into the case's snapshots
  std::size_t along = 0;  ///< axis that the line runs along, 0 or 1: the abscissa is the place along it
  double at = 0.0;       ///< where the line crosses the other axis [m]
};

/// A measured curve that a curve of the runs is compared with.
struct Measurement {
  std::string id;
  std::shared_ptr<const CurveFile> file;
  std::size_t column = 1;  ///< the ordinate
  std::string curve;       ///< name of a curve of the runs
  std::vector<Selector> where;  ///< the runs that are compared
  std::string numerical;        ///< axis of refinement whose runs tell the uncertainty of the discretisation; may be empty
  std::vector<std::string> inputs;  ///< axes whose values are all as likely: what is not known of the scene
  double within = 0.0;    ///< half-width of the mean that the runs' curves are read with; 0 for none
  double accuracy = 0.0;  ///< what 2 u_val is asked to be at most, over the largest measured magnitude [-]
  std::string reason;     ///< why that accuracy, for a person
};

/// Single measurements beside what a formula or the runs predict for them.
struct PairedPrediction {
  std::string id, title;
  std::shared_ptr<const CurveFile> file;
  std::size_t column = 0;  ///< what was measured
  std::string formula;     ///< predicted by a formula of reference/ over the other columns; or
  std::string metric;      ///< by a metric of the runs
  std::string across;      ///< whose axis has the names of the rows for values
  std::vector<Selector> where;
};

/// Runs as configurations of a problem, weighed by error and cost. The error is a metric or, with `curve`, the
/// distance of a curve from that of the finest runs or of a baseline.
struct TradeRequest {
  std::string title;                  ///< what the error is of, for a person: "stress of the column"
  std::vector<std::string> problems;  ///< axes of the sweep whose values are other problems, not other configurations
  std::string metric;                 ///< name of the error; empty with a curve
  std::string curve;                  ///< name of a curve of the runs; empty with a metric
  std::vector<std::vector<Selector>> finest;  ///< of a curve: the runs of each family that stand for the truth, two at least
  /// Of a curve, instead of the finest: the run of each problem that the others are compared with as it is, so that the
  /// error is what they change.
  std::vector<Selector> baseline;
  double from = 0.0, up_to = 0.0;     ///< of a curve: the stretch of abscissae
  double within = 0.0;                ///< of a curve: half-width of the mean that it is read with; 0 for none
  std::string family;                 ///< axis whose values have colours of their own; may be empty
  std::vector<double> asked;          ///< errors that a table of advice is written for, from large to small [-]
};

/// Advice taken from another case and put to the test by the runs of this one.
struct AdviceTest {
  std::string of;             ///< id of the case whose trade gives the advice
  std::vector<double> asked;  ///< errors asked for [-]
};

/// How the class of each run is told: the key `classification` of a case.
struct Classification {
  std::string probe;     ///< id of the probe whose signal should become constant; may be empty
  double from = 0.0;     ///< the signal's window begins there [s]
  double scale = 0.0;    ///< of the signal, SI unit of its quantity; 0 takes its largest magnitude
  bool stress = false;   ///< whether the stress along the last axis is searched for a zig-zag
  std::string error;     ///< metric that tells the error; may be empty
  BehaviourLimits limits;
};

/// What rounding does to each run: the key `rounding` of a case. Runs are compared with the one that differs from them
/// in the axes of the baseline alone.
struct RoundingRequest {
  std::vector<Selector> baseline;  ///< values of axes that make the run to compare with: double, in order
  std::string cells;  ///< axis of the cell size, from coarse to fine; the error of the cells is estimated along it
};

/// The part of a two-dimensional scene that a figure shows.
struct ViewRequest {
  PerAxis lower{}, upper{};  ///< [m], lower below upper along both axes
};

/// A picture the report draws from the verdict of the case.
struct FigureRequest {
  std::string id;
  std::string kind;      ///< profiles, convergence, bars, history, curves, fields, model, decomposition, comparison, pairs, trend, trade, stability
  std::string caption;
  std::string panels;    ///< swept parameter that separates panels; may be empty
  std::string series;    ///< swept parameter that separates curves; may be empty
  std::string quantity;  ///< profiles: stress, displacement or stress_error; history: probe id; curves: name of a
                         ///< curve; fields: a name in `field_catalogue()` of vv/field_map.hpp
  std::vector<std::string> metrics;     ///< convergence, bars
  std::string over;                     ///< convergence: refined parameter
  std::vector<std::string> references;  ///< profiles, curves: names of reference solutions drawn beside the runs
  std::vector<Selector> where;
  std::vector<int> snapshots = {};  ///< fields: indices into the case's snapshots; empty draws all
  std::string unavailable = {};     ///< fields, curves: why there is no measurement to compare with; may be empty
  std::optional<ViewRequest> view = std::nullopt;  ///< fields: the part to show; without one, all particles
  bool marks = false;                              ///< curves: whether the bends that were found are marked
  std::vector<double> stages = {};  ///< curves of pressure: settlements of note, from small to large [m]
  std::vector<std::string> measurements = {};  ///< comparison: compared; fields: drawn on top as lines. Ids of the case's
  std::vector<std::string> pairs = {};         ///< pairs: ids of the case's paired predictions
  std::string trade = {};                      ///< trade: title of one of the case's trades
  /// Stability: the axis along x of the map; time steps are along y.
  std::string map_axis = {};
  std::string abscissa = {};                   ///< trend: the metric along x; `metrics` are along y, `over` the axis
  /// Trend: published curves drawn beside the runs.
  std::vector<std::shared_ptr<const CurveFile>> published = {};
};

/// One run of a sweep: its parameters, the resolved scene or element test, and its own text (for hashing).
struct RunRequest {
  std::vector<std::pair<std::string, Json>> parameters;  ///< parameter and value of each axis, in sweep order
  Json scene_text;  ///< the case's /scene or /element, the parameters put in
  /// What each axis of the sweep changes in this run, in sweep order: {"set": {pointer: value}, "remove": [pointer]}.
  std::vector<Json> changes = {};
  Scene scene;      ///< checked, and what is simulated: see `model`; without bodies for an element test
  std::shared_ptr<const reference::ManufacturedSolution> motion = nullptr;  ///< what drives the scene; may be null
  std::optional<ElementTest> element = std::nullopt;  ///< checked; stands in place of the scene
  int threads = 1;                                    ///< share the work of each step; they change no bit
  ModelRequest model_request = {};
  std::string refusal = {};  ///< why the scene cannot be simulated, of a case that allows it; then `scene` is not checked
  std::vector<ModelChoice> model = {};         ///< how `scene` came from what is written, and why
  std::optional<double> width = std::nullopt;  ///< of a strip of which `scene` is the column [m]
};

/// One case file, checked: every run it asks for can start.
struct Case {
  std::string id, title, description;
  std::string figure_of_paper;              ///< for example "Figure 1"; may be empty
  std::vector<Claim> claims;                ///< what the paper (or theory) says that this case puts to the test
  std::vector<std::string> notes;           ///< what a reader should know
  bool quick = true;                        ///< part of `report --quick`
  bool study = false;                       ///< too long for the tests; the full report runs it
  bool repeat_on_other_threads = false;     ///< run everything a second time on another number of threads: `bits_differ`
  std::vector<int> repeat_on_threads = {};  ///< the same on each of these numbers of threads for the work of a step
  std::vector<std::string> metamorphoses;   ///< other descriptions to run every scene in: names in vv/metamorphic.hpp
  std::vector<std::string> references;      ///< reference solutions to judge against, of `reference_catalogue()`
  std::vector<SweepAxis> sweep;
  std::vector<RunRequest> runs;
  std::vector<HistoryProbe> probes;
  std::vector<SnapshotRequest> snapshots;
  std::vector<Cut> cuts;
  std::vector<Measurement> measurements;
  std::vector<PairedPrediction> pairs;
  std::vector<Reading> readings;
  std::vector<TradeRequest> trades;
  std::optional<AdviceTest> advice;
  std::optional<SurveyRequest> survey;  ///< every run is a survey of its time steps
  std::optional<Classification> classification;
  std::optional<RoundingRequest> rounding;
  std::vector<Gate> gates;
  std::vector<FigureRequest> figures;
  std::filesystem::path file;
  Json text;
};

/// Every curve file a case compares with or draws, each once, in the order of the case.
std::vector<std::shared_ptr<const CurveFile>> curve_files_of(const Case& definition);

/// Reads, validates (against vv/case.schema.json too) and expands a case file. Throws CaseError for the first
/// thing wrong with the file, with any scene it sweeps over, or with a gate, probe or figure it asks for.
///
/// The scene must be valid both as written and with every combination of swept values put in. The runs come in
/// the order of the sweep, the last axis varying fastest.
Case read_case(const std::filesystem::path& file);

/// As `read_case`, for a text already in memory; `file` only names it in messages and in the result.
Case parse_case(const std::string& text, const std::filesystem::path& file);

}  // namespace mpm::vv
