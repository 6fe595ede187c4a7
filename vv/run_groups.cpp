#include "vv/run_groups.hpp"

#include <algorithm>

namespace mpm::vv {
namespace {

Parameters without(const Parameters& parameters, const std::string& pointer) {
  Parameters rest;
  for (const auto& entry : parameters) {
    if (entry.first != pointer) rest.push_back(entry);
  }
  return rest;
}

Parameters only(const Parameters& parameters, const std::vector<std::string>& pointers) {
  Parameters some;
  for (const auto& entry : parameters)
    if (std::find(pointers.begin(), pointers.end(), entry.first) != pointers.end()) some.push_back(entry);
  return some;
}

}  // namespace

const Json* value_of(const Parameters& parameters, const std::string& pointer) {
  for (const auto& [name, value] : parameters) {
    if (name == pointer) return &value;
  }
  return nullptr;
}

bool selects(const std::vector<Selector>& where, const Parameters& parameters) {
  return std::all_of(where.begin(), where.end(), [&](const Selector& selector) {
    const Json* value = value_of(parameters, selector.parameter);
    return value &&
           std::find(selector.values.begin(), selector.values.end(), *value) != selector.values.end();
  });
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

std::vector<RunGroup> groups_alike_in(const Case& definition, const std::vector<std::string>& parameters) {
  std::vector<RunGroup> groups;
  for (std::size_t run = 0; run < definition.runs.size(); ++run) {
    const Parameters fixed = only(definition.runs[run].parameters, parameters);
    auto group =
        std::find_if(groups.begin(), groups.end(), [&](const RunGroup& g) { return g.fixed == fixed; });
    if (group == groups.end()) group = groups.insert(groups.end(), RunGroup{fixed, {}});
    group->runs.push_back(run);
  }
  return groups;
}

}  // namespace mpm::vv
