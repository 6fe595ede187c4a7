#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

/// Measured and published curves with their provenance, as the files of reference/curves/ hold them.
namespace mpm::vv {

/// A standard uncertainty (one sigma) that belongs to every value of a column.
struct StatedUncertainty {
  enum class Kind {
    not_stated,  ///< nobody says
    none,        ///< there is none of this kind, as of the digitisation of a printed table
    absolute,    ///< `value` in the column's SI unit
    relative,    ///< `value` times the magnitude of each value
  };
  Kind kind = Kind::not_stated;
  double value = 0.0;

  bool stated() const { return kind != Kind::not_stated; }
  /// Of one value, in its unit; 0 where nothing is stated.
  double of(double column_value) const;
};

/// One quantity of a curve file.
struct CurveColumn {
  std::string name;       ///< an identifier, for example "settlement"
  std::string unit;       ///< as the file has it, for example "mm"; "1" for a ratio
  std::string dimension;  ///< what the unit measures: length, pressure, ratio, ...
  std::string meaning;    ///< one line for a person
  StatedUncertainty digitisation, experimental;
};

/// A curve, or a table of single measurements, or the place of one that is missing.
struct CurveFile {
  std::string id, title;
  bool missing = false;              ///< a slot: what is to be measured is known, the numbers are not
  std::string citation, doi, place;  ///< key in reference/bibliography.md; DOI or empty; "Figure 3"
  std::string by_way_of;  ///< whose digitisation or compilation the numbers come from; may be empty
  std::string origin;     ///< digitised, table, formula or simulated
  std::vector<CurveColumn> columns;
  std::optional<std::size_t> abscissa;  ///< column the rows ascend in; none of a table of single measurements
  std::vector<std::string> row_names;   ///< one a row, or none
  std::vector<std::vector<double>> rows;  ///< SI units (angles in degrees); none of a slot
  std::string licence;
  bool used_for_calibration = false;  ///< whether a model that is compared with it was adjusted to it
  std::vector<std::string> notes;
  std::string hash;  ///< of the numbers, see `hash_of_values`; empty of a slot
  std::filesystem::path file;

  /// The values of one column, one a row.
  std::vector<double> column(std::size_t index) const;
};

/// Reads and checks a curve file. Throws CaseError for the first thing wrong: a key that is missing or
/// unknown, a unit that is not known, an abscissa that does not ascend, a row that is there twice or has a
/// value too many, a number that is not finite, a hash that is not that of the numbers, or an id that is not
/// the file's name.
CurveFile read_curve_file(const std::filesystem::path& file);

/// As `read_curve_file`, for a text already in memory; `file` only names it.
CurveFile parse_curve_file(const std::string& text, const std::filesystem::path& file);

/// Hash of what was measured: names and units of the columns, names of the rows, and the rows as they are
/// written in the file; 16 hexadecimal digits. Provenance can be amended without changing it, numbers cannot.
std::string hash_of_values(const nlohmann::ordered_json& curve_file);

/// What a unit of a curve file measures: "length", "pressure", ..., "ratio" for "1"; empty if it is not
/// known.
std::string dimension_of_unit(const std::string& unit);

/// One of a unit that is known, in SI units: 0.001 for "mm".
double si_of_unit(const std::string& unit);

/// Directory of the curve files that come with the program.
std::filesystem::path shipped_curves();

}  // namespace mpm::vv
