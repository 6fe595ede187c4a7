#pragma once

#include <string>
#include <vector>

#include "vv/norms.hpp"

/// What the families of norms share; nobody but vv/norms.cpp and the families includes this.
namespace mpm::vv {

using Values = std::vector<double>;

/// Everything the norms of one run are computed from, and what they say.
struct Judging {
  const Case& definition;
  const RunRequest& request;
  const Record& record;
  Judgement result;

  const Scene& scene() const { return request.scene; }
  /// Keeps a finite value only.
  void set(const std::string& name, double value);
  /// Whether the case wants to be judged by a reference solution.
  bool asks_for(const std::string& reference) const;
};

/// The larger of two; not a number if either is not, where std::max may lose it.
double larger(double a, double b);

/// L1 and L2 weighted, L-infinity; each relative to the same norm of the exact field.
struct RelativeNorms {
  double l1, l2, linf;
};

/// Of values with one weight each. An error that is not a number makes every norm so.
RelativeNorms relative_norms(const Values& found, const Values& exact, const Values& weight);

void set_norms(Judging& judging, const std::string& name, const RelativeNorms& norms);

/// The three entries of a catalogue for the norms of one field.
void add_norms(std::vector<Metric>& catalogue, const std::string& field, const std::string& reference,
               const std::string& what);

/// The history of the first probe of a quantity, and component if one is named; null without such a probe.
const History* history_of(const Judging& judging, const std::string& quantity,
                          const std::string& component = "");

/// The axis along which gravity acts and columns stand: the last one.
std::size_t axis_of(const Scene& scene);

/// A family of norms: the reference solutions it knows, what it measures, and how.
struct NormFamily {
  std::vector<std::string> references;
  std::vector<Metric> metrics;
  /// Empty, or what the reference solution needs that the scene lacks.
  std::string (*why_unsuited)(const std::string& reference, const Scene& scene);
  /// Judges a run that completed.
  void (*judge)(Judging& judging);
  /// Empty, or what the reference solution needs that the case does not record; null if it needs no probe and
  /// no snapshot.
  std::string (*why_not_judged)(const std::string& reference, const Case& definition,
                                const RunRequest& request) = nullptr;
  /// Judges what any run of a scene has left on its way, whether it completed or not, before `judge`; null if
  /// the family needs a completed run for all it says.
  void (*judge_course)(Judging& judging) = nullptr;
};

NormFamily column_norms();        ///< columns settled under their own weight
NormFamily footing_norms();       ///< rigid strips and heavy blocks that press on the ground
NormFamily mechanism_norms();     ///< how the ground gives way below a footing; needs no reference solution
NormFamily collapse_norms();      ///< what a granular column leaves; needs no reference solution
NormFamily motion_norms();        ///< motions whose course is known
NormFamily element_norms();       ///< the constitutive law alone, without particles or grid
NormFamily conservation_norms();  ///< what no motion may change; needs no reference solution
NormFamily stability_norms();     ///< of surveys of time steps, and of nothing else

}  // namespace mpm::vv
