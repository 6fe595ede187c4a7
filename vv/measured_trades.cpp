#include "vv/measured_trades.hpp"

#include <algorithm>
#include <fstream>

#include "vv/json_reader.hpp"
#include "vv/run_groups.hpp"
#include "vv/scene_match.hpp"
#include "vv/scene_reader.hpp"
#include "vv/sweep.hpp"

namespace mpm::vv {
namespace {

std::vector<std::pair<std::string, Json>> parameters_from(const Json& json) {
  std::vector<std::pair<std::string, Json>> parameters;
  for (const auto& [axis, value] : json.items()) parameters.emplace_back(axis, value);
  return parameters;
}

/// What could not be measured is null.
double number_from(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

Timing timing_from(const Json& json) {
  return {.median = json.at("median"),
          .low = json.at("low"),
          .high = json.at("high"),
          .repeats = json.at("repeats"),
          .whole = json.at("whole")};
}

TradePoint point_from(const Json& json) {
  TradePoint point;
  point.run = json.at("run");
  point.configuration = parameters_from(json.at("configuration"));
  point.family = json.at("family");
  point.cell_size = number_from(json.at("cell_size"));
  point.error = number_from(json.at("error"));
  point.uncertainty = number_from(json.at("uncertainty"));
  point.failure = json.at("failure");
  point.of_reference = json.at("of_reference");
  if (!json.at("seconds").is_null()) point.timing = timing_from(json.at("seconds"));
  point.work = {number_from(json.at("particle_steps")), number_from(json.at("bytes")),
                number_from(json.at("operations"))};
  return point;
}

TradeReference reference_from(const Json& json) {
  return {.source = json.at("source"),
          .x = json.at("x"),
          .y = json.at("y"),
          .spread = json.at("spread"),
          .uncertainty = number_from(json.at("uncertainty"))};
}

MeasuredTrade trade_from(const Json& json, const Json& runs) {
  MeasuredTrade trade;
  trade.verdict.title = json.at("title");
  trade.verdict.problem = parameters_from(json.at("problem"));
  trade.verdict.error_name = json.at("error_name");
  trade.verdict.reference = reference_from(json.at("reference"));
  for (const Json& point : json.at("points")) {
    trade.verdict.points.push_back(point_from(point));
    trade.changes.push_back(point.at("changes"));
    trade.program_hashes.push_back(runs.at(trade.verdict.points.back().run).at("program_hash"));
  }
  return trade;
}

MeasuredCase case_from(const Json& json) {
  MeasuredCase measured;
  measured.id = json.at("id");
  measured.scene = json.at("scene");
  measured.definition = json.at("definition");
  measured.sweep = read_sweep(JsonPlace(&measured.definition, "")["sweep"], {"/scene", measured.scene});
  for (const Json& trade : json.at("trades")) measured.trades.push_back(trade_from(trade, json.at("runs")));
  return measured;
}

bool is_of_problem(const SweepAxis& axis, const MeasuredTrade& trade) {
  return value_of(trade.verdict.problem, axis.parameter) != nullptr;
}

}  // namespace

std::vector<std::string> MeasuredCase::configured_places(const MeasuredTrade& trade) const {
  std::vector<std::string> places;
  for (const SweepAxis& axis : sweep) {
    if (is_of_problem(axis, trade)) continue;
    for (const std::string& place : places_of(axis)) places.push_back(place);
  }
  return places;
}

std::vector<SweepAxis> MeasuredCase::problem_axes(const MeasuredTrade& trade) const {
  std::vector<SweepAxis> axes = sweep;
  std::erase_if(axes, [&](const SweepAxis& axis) { return !is_of_problem(axis, trade); });
  return axes;
}

const std::vector<std::string>& defining_keys() {
  static const std::vector<std::string> keys = {"sweep", "references", "probes", "snapshots",
                                                "cuts",  "readings",   "trades"};
  return keys;
}

MeasuredCampaign read_measured_campaign(const std::filesystem::path& directory) {
  MeasuredCampaign campaign;
  campaign.file = directory / "results.json";
  std::ifstream stream(campaign.file, std::ios::binary);
  if (!stream) throw std::runtime_error(campaign.file.string() + ": no such file");
  try {
    const Json json = Json::parse(stream);
    campaign.revision = json.at("revision");
    campaign.date = json.at("date");
    campaign.processor = json.at("processor");
    for (const Json& entry : json.at("cases")) {
      const Json trades = entry.value("trades", Json::array());
      if (!trades.empty() && entry.contains("scene")) campaign.cases.push_back(case_from(entry));
    }
  } catch (const std::exception& error) {
    throw std::runtime_error(campaign.file.string() + ": not the results of a campaign: " + error.what());
  }
  return campaign;
}

}  // namespace mpm::vv
