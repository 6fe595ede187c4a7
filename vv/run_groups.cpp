#include "vv/run_groups.hpp"

#include <algorithm>

namespace mpm::vv {
namespace {

bool selects(const std::vector<Selector>& where, const Parameters& parameters) {
  return std::all_of(where.begin(), where.end(), [&](const Selector& selector) {
    const Json* value = value_of(parameters, selector.parameter);
    return value &&
           std::find(selector.values.begin(), selector.values.end(), *value) != selector.values.end();
  });
}

Parameters without(const Parameters& parameters, const std::string& pointer) {
  Parameters rest;
  for (const auto& entry : parameters) {
    if (entry.first != pointer) rest.push_back(entry);
  }
  return rest;
}

}  // namespace

const Json* value_of(const Parameters& parameters, const std::string& pointer) {
  for (const auto& [name, value] : parameters) {
    if (name == pointer) return &value;
  }
  return nullptr;
}

std::vector<std::size_t> selected_runs(const Case& definition, const std::vector<Selector>& where) {
  std::vector<std::size_t> selected;
  for (std::size_t run = 0; run < definition.runs.size(); ++run) {
    if (selects(where, definition.runs[run].parameters)) selected.push_back(run);
  }
  return selected;
}

std::vector<RunGroup> groups_across(const Case& definition, const std::vector<std::size_t>& runs,
                                    const std::string& across) {
  std::vector<RunGroup> groups;
  for (std::size_t run : runs) {
    const Parameters& parameters = definition.runs[run].parameters;
    if (!value_of(parameters, across)) continue;
    const Parameters fixed = without(parameters, across);
    auto group =
        std::find_if(groups.begin(), groups.end(), [&](const RunGroup& g) { return g.fixed == fixed; });
    if (group == groups.end()) group = groups.insert(groups.end(), RunGroup{fixed, {}});
    group->runs.push_back(run);
  }
  const auto coarser = [&](std::size_t a, std::size_t b) {
    return definition.runs[a].scene.cell_size > definition.runs[b].scene.cell_size;
  };
  for (RunGroup& group : groups) std::stable_sort(group.runs.begin(), group.runs.end(), coarser);
  return groups;
}

}  // namespace mpm::vv
