#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "vv/verdict.hpp"

namespace mpm::reports {

/// A figure of the report as a PNG file's bytes, or why there is none.
struct DrawnFigure {
  std::string case_id, figure_id;
  std::string png;      ///< empty if it could not be drawn
  int pixel_width = 0;  ///< of the PNG
  std::string failure;  ///< empty if it could be drawn
};

/// Draws every figure that the judged cases ask for, in their order. What cannot be drawn carries its reason.
std::vector<DrawnFigure> draw_figures(const vv::CampaignVerdict& verdict);

/// The report as one self-contained HTML page: pictures are embedded, nothing is loaded from elsewhere. It
/// states only what the verdict holds; every text of the verdict is escaped.
std::string report_html(const vv::CampaignVerdict& verdict, const std::vector<DrawnFigure>& figures);

/// Writes `report.html` and `figures/<case>-<figure>.png` into `directory`, each file as a whole or not at
/// all. Throws std::system_error when a file cannot be written and, after everything else is written,
/// CanvasError when a figure could not be drawn.
void write_report(const vv::CampaignVerdict& verdict, const std::filesystem::path& directory);

}  // namespace mpm::reports
