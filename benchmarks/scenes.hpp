#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "solver/simulation.hpp"

namespace mpm::bench {

enum class Law { linear_elastic, mohr_coulomb };

/// What is simulated, and how.
struct SceneChoice {
  enum class Model {
    column,   ///< of Figure 1, one dimension, linear elastic
    footing,  ///< of benchmarks/cases/footing_paper.json, plane strain
  };
  Model model = Model::footing;
  Scheme scheme = Scheme::cpgimp;
  UpdateOrder order = UpdateOrder::musl;
  Law law = Law::mohr_coulomb;
  Precision precision = Precision::float64;
  std::int64_t particles = 0;  ///< wanted; the scene comes as near as whole cells allow
};

/// Names as case files and results have them.
std::string name_of(SceneChoice::Model model);
std::string name_of(Scheme scheme);
std::string name_of(UpdateOrder order);
std::string name_of(Law law);
std::string name_of(Precision precision);  ///< float64 or float32

/// Where the case files are: the project that the environment's MPMVV_ROOT names, or the one built from.
std::filesystem::path project_root();
std::filesystem::path footing_case();  ///< file of the paper's footing

/// A scene that goes on for as long as anybody asks.
///
/// The column has `particles` cells, 10G, and otherwise the case's own numbers.
///
/// The footing keeps its shape while the cells shrink or grow: ground and block are the paper's numbers of
/// cells times sqrt(particles / 8832), rounded. Walls, damping and gravity are the case's; the block keeps
/// its initial density and the time step is half the stable one. With Mohr–Coulomb the ground starts in the
/// active state, K0 = tan^2(45 deg - phi/2): on the limit everywhere, so that a return to the limit is needed
/// by some of the particles anywhere, as in ground that fails, and cannot be left out for whole regions. An
/// elastic ground starts with the same stress. Throws CaseError or SceneError if the case cannot be read.
Scene scene_of(const SceneChoice& choice);

/// Threads a simulation can use.
int available_threads();

/// The one place that starts simulations, so that whatever they need is said once.
Simulation simulation_of(const Scene& scene, int threads);

}  // namespace mpm::bench
