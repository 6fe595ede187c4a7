#include "reports/validation_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "reports/figures.hpp"
#include "vv/measurement.hpp"

namespace mpm::reports {
namespace {

using data = PageData;

std::string percent(double ratio) { return number_markup(100.0 * ratio, 2) + "\u00a0%"; }

std::string chip_of(vv::Agreement agreement) {
  switch (agreement) {
    case vv::Agreement::validated:
      return chip("pass", "validated at this level");
    case vv::Agreement::model_error:
      return chip("contrary", "model error detected");
    case vv::Agreement::inconclusive:
    case vv::Agreement::no_measurement:
      return chip("open", name_of(agreement));
    case vv::Agreement::not_compared:
      break;
  }
  return chip("fail", name_of(agreement));
}

/// "Bui08, Figure 12".
std::string source_of(const vv::CurveFile& file) { return file.citation + ", " + file.place; }

std::string uncertainty_text(const vv::StatedUncertainty& uncertainty, const std::string& unit) {
  using Kind = vv::StatedUncertainty::Kind;
  switch (uncertainty.kind) {
    case Kind::not_stated:
      return "not stated";
    case Kind::none:
      return "none";
    case Kind::absolute:
      return fmt::format("{}{}{}", number_markup(uncertainty.value / vv::si_of_unit(unit)),
                         unit == "1" ? "" : " ", unit == "1" ? "" : unit);
    case Kind::relative:
      return percent(uncertainty.value);
  }
  return "not stated";
}

/// What a reader of the verdict must know beside it.
std::string caveats_of(const vv::CurveFile& file, std::size_t column) {
  std::string caveats;
  if (!file.columns[column].experimental.stated())
    caveats += "The experiment's own uncertainty is not stated: u_D is a lower bound. ";
  if (file.used_for_calibration)
    caveats += "A model was calibrated to this measurement: agreement would not be validation. ";
  return caveats;
}

data comparison_row(const vv::CurveComparison& found, const std::string& runs) {
  data row = object({{"runs", runs}, {"chip", chip_of(found.agreement)}, {"lack", found.lack}});
  if (!found.lack.empty()) return row;
  row.set("numbers", flag(true));
  for (const auto& [name, value] :
       {std::pair("inside", found.inside), std::pair("level", found.level), std::pair("bias", found.bias),
        std::pair("largest_error", found.largest_error), std::pair("excess", found.excess),
        std::pair("l2", found.distance.l2)})
    row.set(name, percent(value));
  for (const auto& [name, value] :
       {std::pair("magnitude", found.distance.magnitude), std::pair("phase", found.distance.phase),
        std::pair("comprehensive", found.distance.comprehensive)})
    row.set(name, number_markup(value, 2));
  return row;
}

const vv::CurveComparison* comparison_of(const vv::RunVerdict& run, const std::string& measurement) {
  for (const vv::CurveComparison& comparison : run.comparisons)
    if (comparison.measurement == measurement) return &comparison;
  return nullptr;
}

/// One entry a measurement, with a row for every run that was compared; one row if it is missing.
data comparisons_of(const vv::CaseVerdict& verdict) {
  data entries = list();
  for (const vv::Measurement& measurement : verdict.definition.measurements) {
    data rows = list();
    for (const vv::RunVerdict& run : verdict.runs) {
      const vv::CurveComparison* found = comparison_of(run, measurement.id);
      if (!found) continue;
      const bool missing = found->agreement == vv::Agreement::no_measurement;
      rows << comparison_row(*found, missing ? "all runs" : name_of_run(run.parameters));
      if (missing) break;  // every run lacks the same
    }
    data entry = object({{"id", measurement.id},
                         {"title", measurement.file->title},
                         {"source", source_of(*measurement.file)},
                         {"caveats", caveats_of(*measurement.file, measurement.column)},
                         {"asked", percent(measurement.accuracy)},
                         {"reason", measurement.reason}});
    entry.set("rows", rows);
    entries << entry;
  }
  return entries;
}

data paired_rows(const vv::CaseVerdict& verdict) {
  data rows = list();
  for (std::size_t k = 0; k < verdict.pairs.size(); ++k) {
    const vv::PairsVerdict& pairs = verdict.pairs[k];
    const vv::PairedPrediction& request = verdict.definition.pairs[k];
    const vv::ModelFactor& factor = pairs.factor;
    data row = object({{"case_id", verdict.definition.id},
                       {"title", pairs.title},
                       {"source", source_of(*request.file)},
                       {"count", std::to_string(pairs.pairs.size())},
                       {"lack", pairs.lack}});
    if (pairs.lack.empty()) {
      row.set("bias", number_markup(factor.bias, 3));
      row.set("confidence", number_markup(factor.bias_low, 3) + " … " + number_markup(factor.bias_high, 3));
      row.set("scatter", percent(factor.scatter));
      row.set("model_scatter", request.file->columns[request.column].experimental.stated()
                                   ? percent(factor.model_scatter)
                                   : std::string("– (experiment’s not stated)"));
      row.set("range", number_markup(factor.least, 3) + " … " + number_markup(factor.greatest, 3));
    }
    rows << row;
  }
  return rows;
}

/// "validated at this level 3 ×, model error detected 1 ×".
std::string tally_of(const vv::CaseVerdict& verdict, const std::string& measurement) {
  std::map<vv::Agreement, int> counts;
  for (const vv::RunVerdict& run : verdict.runs)
    if (const vv::CurveComparison* found = comparison_of(run, measurement)) ++counts[found->agreement];
  std::string tally;
  for (const auto& [agreement, count] : counts) {
    if (!tally.empty()) tally += ' ';
    tally += chip_of(agreement);
    if (count > 1) tally += fmt::format(" {} ×", count);
  }
  return tally;
}

data curve_file_row(const vv::CurveFile& file, const std::set<std::string>& cases) {
  std::string users, uncertainties;
  for (const std::string& id : cases) users += (users.empty() ? "" : ", ") + id;
  for (const vv::CurveColumn& column : file.columns) {
    uncertainties += fmt::format("{}{}: read to {}, measured to {}", uncertainties.empty() ? "" : "; ",
                                 column.name, uncertainty_text(column.digitisation, column.unit),
                                 uncertainty_text(column.experimental, column.unit));
  }
  data notes = list();
  for (const std::string& note : file.notes) notes << object({{"text", note}});
  data row = object({{"id", file.id},
                     {"title", file.title},
                     {"source", source_of(file)},
                     {"doi", file.doi},
                     {"by_way_of", file.by_way_of},
                     {"origin", file.missing ? "missing" : file.origin},
                     {"count", file.missing ? "–" : std::to_string(file.rows.size())},
                     {"uncertainties", uncertainties},
                     {"licence", file.licence},
                     {"calibration", file.used_for_calibration ? "yes" : "no"},
                     {"hash", file.hash},
                     {"cases", users}});
  set_list(row, "notes", notes);
  return row;
}

}  // namespace

void set_validation(PageData& section, const vv::CaseVerdict& verdict) {
  set_list(section, "comparisons", comparisons_of(verdict));
  set_list(section, "paired", paired_rows(verdict));
}

void set_validation_overview(PageData& page, const vv::CampaignVerdict& verdict) {
  data validations = list(), paired = list(), files = list();
  std::map<std::string, std::pair<const vv::CurveFile*, std::set<std::string>>> used;
  std::set<std::pair<std::string, std::string>> formulas;
  for (const vv::CaseVerdict& c : verdict.cases) {
    for (const auto& file : vv::curve_files_of(c.definition)) {
      used[file->id].first = file.get();
      used[file->id].second.insert(c.definition.id);
    }
    if (c.status == vv::CaseStatus::not_run) continue;
    for (const vv::Measurement& measurement : c.definition.measurements) {
      validations << object({{"case_id", c.definition.id},
                             {"title", measurement.file->title},
                             {"source", source_of(*measurement.file)},
                             {"tally", tally_of(c, measurement.id)}});
    }
    const data rows = paired_rows(c);
    for (std::size_t k = 0; k < c.pairs.size(); ++k) {
      const vv::PairedPrediction& request = c.definition.pairs[k];
      // A formula says the same in every case that asks it.
      const bool told =
          !request.formula.empty() && !formulas.insert({request.formula, request.file->id}).second;
      if (!told) paired << rows.list_value()[k];
    }
  }
  for (const auto& [id, entry] : used) files << curve_file_row(*entry.first, entry.second);
  set_list(page, "validations", validations);
  set_list(page, "all_paired", paired);
  set_list(page, "curve_files", files);
}

}  // namespace mpm::reports
