#pragma once

#include <string>
#include <vector>

#include "reports/plot.hpp"
#include "vv/case_file.hpp"

namespace mpm::reports {

/// A scene to be drawn as it stands before its first step.
struct ModelPanel {
  std::string title;  ///< markup; may be empty
  Scene scene;        ///< two-dimensional
};

/// Drawings of scenes. One alone has its words and a magnified detail beside it, several stand two in a row
/// with their words below.
struct ModelPlot {
  std::vector<ModelPanel> panels;
  std::vector<std::string> notes;  ///< markup, set under the picture
  double width = 482.0;            ///< of the whole picture [pt]
  std::string stamp;               ///< markup, small, along the lower edge
};

/// How many particles a body is made of. `cell_size` [m].
std::size_t particle_count(const Body& body, double cell_size);

/// What a body is made of, line by line in markup: name and law, parameters, density, particles.
std::vector<std::string> words_of_body(const Body& body, const Scene& scene);

/// Draws the grid with its cells, the bodies as their particles (as blocks where those would be smaller than
/// a printer's dot), rigid bodies hatched, what holds the edges, surface loads, gravity, and the extent of
/// every body that lies inside the grid. In the layout a panel's frame is the grid, its points are the
/// particles, its annotations all that is written. Throws CanvasError, and std::invalid_argument for a scene
/// that is not two-dimensional.
Picture draw(const ModelPlot& plot, double pixels_per_point = 10.0 / 3.0);

}  // namespace mpm::reports
