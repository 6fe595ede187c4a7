#include "vv/advice_match.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "vv/json_reader.hpp"
#include "vv/run_groups.hpp"
#include "vv/scene_match.hpp"
#include "vv/scene_reader.hpp"
#include "vv/sweep.hpp"

namespace mpm::vv {
namespace {

const std::string root = "/scene";

/// The value at a pointer below /scene; null if there is none.
const Json* value_at(const Json& scene, const std::string& pointer) {
  const Json::json_pointer place(pointer.substr(root.size()));
  return scene.contains(place) ? &scene.at(place) : nullptr;
}

std::string text_at(const Json& scene, const std::string& pointer) {
  const Json* value = value_at(scene, pointer);
  return value ? describe(*value) : "nothing";
}

bool same_at(const Json& one, const Json& other, const std::string& pointer) {
  const Json *first = value_at(one, pointer), *second = value_at(other, pointer);
  return first && second ? same_value(*first, *second) : first == second;
}

/// Whether the value is one of these or, being a number, lies between them.
bool among(const Json& value, const std::vector<Json>& values) {
  const std::optional<Magnitude> magnitude = magnitude_of(value);
  bool below = false, above = false;
  for (const Json& other : values) {
    if (same_value(value, other)) return true;
    const std::optional<Magnitude> bound = magnitude_of(other);
    if (!magnitude || !bound || !bound->comparable_with(*magnitude)) continue;
    below = below || bound->value < magnitude->value;
    above = above || bound->value > magnitude->value;
  }
  return below && above;
}

std::string listed_values(const std::vector<Json>& values) {
  std::vector<std::string> texts;
  for (const Json& value : values) texts.push_back(describe(value));
  return listed(texts);
}

// ---- one problem of the case ----

/// Reads the problem of a scene along the axes of a measured trade.
class ProblemReader {
 public:
  ProblemReader(const MeasuredCase& measured, const std::vector<const TradeVerdict*>& trades,
                const std::vector<SweepAxis>& axes, const std::vector<std::string>& decided)
      : measured_(measured), trades_(trades), axes_(axes), decided_(decided) {}

  AskedProblem read(Json scene) const {
    AskedProblem asked{.scene = std::move(scene), .problem = {}, .near = {}, .differences = {}};
    for (const std::string& pointer : differences(asked.scene, measured_.scene, root, decided_))
      asked.differences.push_back(
          {pointer, text_at(asked.scene, pointer), text_at(measured_.scene, pointer)});
    for (const SweepAxis& axis : axes_) {
      const std::optional<Json> value =
          axis.variants.empty() ? own_value(axis, asked.scene) : own_variant(axis, asked.scene);
      if (value) asked.problem.emplace_back(axis.parameter, *value);
    }
    asked.near = problems_near(trades_, asked.problem);
    for (const SweepAxis& axis : axes_) compare(axis, asked);
    const bool between_in_several =
        asked.near.kind == NearProblems::Kind::between && asked.near.problems.size() > 2;
    if (asked.differences.empty() && (asked.near.problems.empty() || between_in_several))
      asked.differences.push_back(
          {root, "between measured problems in several numbers", "one number at most"});
    return asked;
  }

 private:
  static std::optional<Json> own_value(const SweepAxis& axis, const Json& scene) {
    const Json* value = value_at(scene, axis.parameter);
    return value ? std::optional(*value) : std::nullopt;
  }

  /// The variant that the scene has, if any.
  std::optional<Json> own_variant(const SweepAxis& axis, const Json& scene) const {
    const std::vector<std::string> places = places_of(axis);
    for (std::size_t k = 0; k < axis.values.size(); ++k) {
      const Json varied = with_value(axis, k, {root, measured_.scene}).text;
      if (std::all_of(places.begin(), places.end(),
                      [&](const std::string& place) { return same_at(scene, varied, place); }))
        return axis.values[k];
    }
    return std::nullopt;
  }

  /// The values of an axis that the near problems have; all of them where nothing is near.
  std::vector<std::size_t> near_values(const SweepAxis& axis, const NearProblems& near) const {
    std::vector<std::size_t> chosen;
    for (std::size_t k = 0; k < axis.values.size(); ++k) {
      const auto has = [&](const TradeVerdict* trade) {
        const Json* value = value_of(trade->problem, axis.parameter);
        return value && same_value(*value, axis.values[k]);
      };
      if (near.problems.empty() || std::any_of(near.problems.begin(), near.problems.end(), has))
        chosen.push_back(k);
    }
    return chosen;
  }

  void compare(const SweepAxis& axis, AskedProblem& asked) const {
    const std::vector<std::size_t> near = near_values(axis, asked.near);
    if (!axis.variants.empty()) {
      if (!value_of(asked.problem, axis.parameter))
        asked.differences.push_back({axis.parameter, "none of its variants", listed_values(axis.values)});
      return;
    }
    std::vector<Follower> followed = axis.with;
    followed.push_back({axis.parameter, axis.values});
    for (const Follower& follower : followed) {
      std::vector<Json> values;
      for (const std::size_t k : near) values.push_back(follower.values[k]);
      const Json* own = value_at(asked.scene, follower.parameter);
      if (own && among(*own, values)) continue;
      asked.differences.push_back(
          {follower.parameter, text_at(asked.scene, follower.parameter), listed_values(values)});
    }
  }

  const MeasuredCase& measured_;
  const std::vector<const TradeVerdict*>& trades_;
  const std::vector<SweepAxis>& axes_;
  const std::vector<std::string>& decided_;  ///< places that the configurations or the problem change
};

// ---- the problems of the case ----

/// A scene of the case, and the swept values that make it.
struct SweptScene {
  Parameters values;
  Json scene;
};

/// The scene as written, or one for every combination of the case's own values along axes of the problem.
std::vector<SweptScene> scenes_of(const Case& asked, const std::vector<std::string>& swept) {
  std::vector<SweptScene> scenes = {{{}, asked.text.at("scene")}};
  for (const SweepAxis& axis : asked.sweep) {
    if (!contains(swept, axis.parameter)) continue;
    std::vector<SweptScene> next;
    for (const SweptScene& each : scenes) {
      for (std::size_t k = 0; k < axis.values.size(); ++k) {
        next.push_back({each.values, with_value(axis, k, {root, each.scene}).text});
        next.back().values.emplace_back(axis.parameter, axis.values[k]);
      }
    }
    scenes = std::move(next);
  }
  return scenes;
}

/// Keeps the problem that is named, by what it is swept over or by its place among the measured ones.
void keep_named(const std::string& name, const std::vector<SweptScene>& scenes, TradeMatch& match) {
  std::vector<AskedProblem>& problems = match.problems;
  std::vector<std::string> names;
  std::vector<AskedProblem> kept;
  for (std::size_t k = 0; k < problems.size(); ++k) {
    const Parameters& values = scenes[k].values.empty() ? problems[k].problem : scenes[k].values;
    names.push_back(scope_of(values));
    if (names.back() == name || scope_of(problems[k].problem) == name) kept.push_back(problems[k]);
  }
  if (kept.empty()) match.differences.push_back({problem_option, name, listed(names)});
  problems = std::move(kept);
}

}  // namespace

bool TradeMatch::between() const {
  return std::any_of(problems.begin(), problems.end(), [](const AskedProblem& asked) {
    return asked.near.kind == NearProblems::Kind::between;
  });
}

std::vector<const TradeVerdict*> TradeMatch::near() const {
  std::vector<const TradeVerdict*> all;
  for (const AskedProblem& asked : problems)
    for (const TradeVerdict* trade : asked.near.problems)
      if (std::find(all.begin(), all.end(), trade) == all.end()) all.push_back(trade);
  return all;
}

TradeMatch match_trade(const Case& asked, const MeasuredCase& measured, const std::string& title,
                       const std::string& problem) {
  TradeMatch match{.measured = &measured, .title = title};
  std::vector<const TradeVerdict*> trades;
  std::vector<SweepAxis> axes;
  for (const MeasuredTrade& trade : measured.trades) {
    if (trade.verdict.title != title) continue;
    trades.push_back(&trade.verdict);
    axes = measured.problem_axes(trade);
    match.configured = measured.configured_places(trade);
  }
  std::vector<std::string> decided = match.configured;
  for (const SweepAxis& axis : axes) {
    for (const std::string& place : places_of(axis)) decided.push_back(place);
    const auto sweeps_it = [&](const SweepAxis& own) { return own.parameter == axis.parameter; };
    if (std::any_of(asked.sweep.begin(), asked.sweep.end(), sweeps_it)) match.swept.push_back(axis.parameter);
  }
  const ProblemReader reader(measured, trades, axes, decided);
  const std::vector<SweptScene> scenes = scenes_of(asked, match.swept);
  for (const SweptScene& each : scenes) match.problems.push_back(reader.read(each.scene));
  const bool some_alike = std::any_of(match.problems.begin(), match.problems.end(),
                                      [](const AskedProblem& each) { return each.differences.empty(); });
  if (!problem.empty() && some_alike) keep_named(problem, scenes, match);
  for (const AskedProblem& each : match.problems) {
    for (const Difference& difference : each.differences)
      if (std::find(match.differences.begin(), match.differences.end(), difference) ==
          match.differences.end())
        match.differences.push_back(difference);
  }
  return match;
}

}  // namespace mpm::vv
