#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/measured.hpp"
#include "benchmarks/results.hpp"

namespace mpm::bench {

/// A scene as a case has it, and how many threads share its steps.
struct FeatureScene {
  std::string what;  ///< what it has, or has in its place, in a few words
  Json text;         ///< of the key `scene`
  int threads = 1;
  bool watched = true;  ///< for energy that comes from nowhere, as every run of a case is
};

/// What a case may say in so many words and need not say.
struct Spelled {
  FeatureScene scene;       ///< `what` is what is said
  bool is_of_with = false;  ///< leaving it out is the scene with the feature, else the one without
};

/// Something that a scene can have or do without.
struct Feature {
  std::string name;   ///< "feature/damping"
  std::string title;  ///< "local damping"
  FeatureScene without, with;
  std::optional<Spelled> spelled;  ///< none where leaving it out is the only way to say so
};

/// The features that have a price, each shown on the leanest scene that can have it: the paper's footing, or
/// the column of Figure 1, with uGIMP, USL and elastic bodies in double precision unless the feature is one
/// of these. Those that need more threads than there are, are left out. Throws CaseError.
std::vector<Feature> features();

struct FeatureEffort {
  int rounds = 25;
  int turns = 9;                ///< of each scene in a round
  double seconds_each = 0.002;  ///< duration of a turn, about [s]; below the time slices of other programs
};

/// Measures features in rounds. In a round every feature has its time, in random order: its scenes are built
/// anew, so that a lucky place in memory does not last, and take short turns, so that a slow minute falls on
/// all of them. Times are compared within a turn; a round counts with the median of its turns. Turns and
/// rounds disturbed by other programs do not count, as in `measure`. What cannot be measured is left out and
/// said in `errors`.
std::vector<FeatureResult> measure_features(const std::vector<Feature>& features, const FeatureEffort& effort,
                                            const std::function<void(const std::string&)>& progress,
                                            std::vector<std::string>& errors);

}  // namespace mpm::bench
