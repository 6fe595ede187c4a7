#include "vv/rounding_reader.hpp"

#include <algorithm>

#include "vv/rounding.hpp"
#include "vv/scene_reader.hpp"
#include "vv/sweep.hpp"

namespace mpm::vv {
namespace {

bool is_finer_at_each_value(const SweepAxis& axis, const Case& read) {
  return refines(axis, axis.values, read_subject(JsonPlace(&read.text, "")));
}

}  // namespace

std::optional<RoundingRequest> read_rounding(const JsonPlace& place, const Case& read) {
  if (!place.present()) return std::nullopt;
  place.allow_only({"baseline", "cells"});
  RoundingRequest request;
  const JsonPlace baseline = place["baseline"];
  request.baseline = read_where(baseline, read.sweep);
  if (request.baseline.empty()) baseline.refuse("a value of at least one axis");
  for (const Selector& selector : request.baseline) {
    if (selector.values.size() != 1)
      baseline[selector.parameter].refuse("the one value that the others are compared with");
  }
  if (const JsonPlace cells = place["cells"]; cells.present()) {
    const SweepAxis& axis = read_axis(cells, read.sweep);
    const bool taken = std::any_of(request.baseline.begin(), request.baseline.end(),
                                   [&](const Selector& each) { return each.parameter == axis.parameter; });
    if (taken) cells.refuse("an axis that is not one of the baseline's");
    if (axis.values.size() < 2 || !is_finer_at_each_value(axis, read))
      cells.refuse("a parameter that makes the cell size smaller from each value to the next");
    request.cells = axis.parameter;
  }
  return request;
}

std::vector<std::string> rounding_metric_names(const std::optional<RoundingRequest>& request) {
  if (!request) return {};
  std::vector<std::string> names;
  for (const char* what : {"displacement", "stress", "share"})
    names.push_back(std::string(rounding_prefix) + what);
  return names;
}

}  // namespace mpm::vv
