#include "vv/element_test.hpp"
#include "vv/judging.hpp"

namespace mpm::vv {
namespace {

std::string why_unsuited_to_elements(const std::string&, const Scene&) { return "an element test"; }

/// An element test is judged by its curves; what only the law could tell has been measured already.
void judge(Judging& judging) {
  if (!judging.request.element) return;
  const ElementTest& test = *judging.request.element;
  for (const auto& [name, value] : judge_element_curves(test, judging.record.paths)) judging.set(name, value);
  for (const ElementCurve& path : judging.record.paths)
    judging.result.curves.push_back({path.id, "run", path.strain, path.value, "strain"});
  for (const ElementCurve& path : closed_form(test, judging.record.paths))
    judging.result.curves.push_back({path.id, "closed_form", path.strain, path.value, "strain"});
}

std::vector<Metric> catalogue() {
  std::vector<Metric> all;
  for (const ElementMetric& metric : element_metrics()) {
    all.push_back({metric.name, "-", metric.needs_closed_form ? "closed_form" : "", metric.meaning});
  }
  return all;
}

}  // namespace

NormFamily element_norms() { return {{"closed_form"}, catalogue(), why_unsuited_to_elements, judge}; }

}  // namespace mpm::vv
