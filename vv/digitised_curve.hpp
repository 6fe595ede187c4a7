#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "vv/digitiser.hpp"

namespace mpm::vv {

/// What a curve file says of digitised numbers beside the numbers.
struct CurveLabels {
  std::string id;
  std::string abscissa_unit, ordinate_unit;  ///< of the figure's axes
  std::string first_column;                  ///< name of the axis whose column stands first
  std::string citation, doi, place;          ///< see CurveFile; doi may be empty
  std::string picture;                       ///< name, size and hash of the picture, for a person
  std::string program;                       ///< what digitised it
};

/// The text of a curve file (see vv/curve_file.hpp) with a digitised series, whose id is `labels.id`. Numbers
/// stay in the units of the figure's axes. What the source tells and a picture does not is marked `fill in`.
///
/// With a `slot`, a curve file without numbers or one whose numbers are replaced, everything that it says of
/// the source, the columns' meaning, experimental uncertainty and licence is kept. Throws DigitiseError when
/// its columns are not those of the figure's axes, measured in units of the same kind, when it has another
/// source than `labels`, and when two points have the same abscissa within a hundredth of its uncertainty.
std::string curve_text(const DigitisedSeries& series, const DigitiseRequest& request,
                       const CurveLabels& labels, const std::optional<nlohmann::ordered_json>& slot);

/// A standard uncertainty with two digits, rounded up: "0.035 mm", or of a logarithmic axis "1.2 %".
std::string uncertainty_text(double uncertainty, AxisScale scale, const std::string& unit);

}  // namespace mpm::vv
