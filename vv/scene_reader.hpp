#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "solver/scene.hpp"
#include "vv/element_test.hpp"
#include "vv/json_reader.hpp"
#include "vv/model_choice.hpp"

namespace mpm::reference {
class ManufacturedSolution;
}

/// From the text of a scene or of an element test to one that can start.
namespace mpm::vv {

/// What a case puts to the test: the text of its scene or of its element test, and which of the two it is.
struct Subject {
  std::string pointer;  ///< /scene or /element
  JsonPlace::Json text;

  bool is_element() const;
};

/// A scene, or an element test in its place, every value of which has been checked.
struct CheckedSubject {
  Scene scene;                                                    ///< without bodies for an element test
  std::shared_ptr<const reference::ManufacturedSolution> motion;  ///< what drives the scene; may be null
  std::optional<ElementTest> element;
  ModelRequest model;  ///< how much of the scene is to be simulated
};

/// Takes the scene or the element test out of a case, unchecked. Throws Refusal unless there is exactly one.
Subject read_subject(const JsonPlace& place);

/// Reads what can start. Throws Refusal, its pointer at or below the subject's, for the first thing wrong.
CheckedSubject read_checked(const Subject& subject);

/// The cell size of a scene whose values are of the right type but may be impossible [m]. Throws Refusal.
double read_cell_size(const Subject& scene);

std::size_t axes_of(const Scene& scene);

/// One quantity per dimension, in SI units. Throws Refusal for more or fewer.
PerAxis read_per_axis(const JsonPlace& place, std::size_t axes, QuantityKind kind);

/// `one` in one dimension, in two dimensions `more_in_two` after it.
std::vector<std::string> keys_of(std::size_t axes, std::vector<std::string> one,
                                 const std::vector<std::string>& more_in_two);

}  // namespace mpm::vv
