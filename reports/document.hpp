#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "reports/performance.hpp"
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

/// A figure of the section on speed, drawn or not, with its caption.
struct DrawnPerformanceFigure {
  DrawnFigure drawn;    ///< case_id is "performance"
  std::string caption;  ///< markup
  /// Index of the earlier measurements it compares with; none of the present ones by themselves.
  std::optional<std::size_t> history;
};

/// The report as one self-contained HTML page: pictures are embedded, nothing is loaded from elsewhere. It
/// states only what the verdict and the measurements of speed hold; all their texts are escaped.
std::string report_html(const vv::CampaignVerdict& verdict, const std::vector<DrawnFigure>& figures,
                        const PerformanceEvidence& performance = {},
                        const std::vector<DrawnPerformanceFigure>& performance_figures = {});

/// Writes `report.html` and `figures/<case>-<figure>.png` into `directory`, each file as a whole or not at
/// all; figures of speed are those of a case "performance". Throws std::system_error when a file cannot be
/// written and, after everything else is written, CanvasError when a figure could not be drawn.
void write_report(const vv::CampaignVerdict& verdict, const std::filesystem::path& directory,
                  const PerformanceEvidence& performance = {});

}  // namespace mpm::reports
