#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "vv/case_file.hpp"

/// Texts of cases that are right, to be read as they are or with something changed, and what a refusal says.
namespace mpm::test {

using vv::Case;
using vv::CaseError;
using vv::Json;

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  EXPECT_TRUE(stream.is_open()) << file;
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

/// A case that uses everything a case may have, and is right.
inline Json valid_case() {
  return Json::parse(R"({
    "$schema": "../case.schema.json",
    "id": "column",
    "title": "A column",
    "figure_of_paper": "Figure 1",
    "description": "A column settles under its own weight.",
    "claims": [{ "claim": "It comes to rest.", "finding": "depends", "gates": ["equilibrium"], "remark": "On damping." }],
    "notes": ["It is short."],
    "quick": false,
    "repeat_on_other_threads": true,
    "scene": {
      "dimension": 1,
      "scheme": "cpgimp",
      "update_order": "usl",
      "precision": "float",
      "flip_fraction": 0.9,
      "damping": 0.8,
      "grid": {
        "cell_size": "0.1 m",
        "lower": ["0 m"],
        "upper": ["1.2 m"],
        "edges": { "x_lower": "fixed", "x_upper": "free" }
      },
      "bodies": [
        {
          "name": "lower",
          "lower": ["0 m"],
          "upper": ["50 cm"],
          "particles_per_cell": [2],
          "density": "1000 kg/m^3",
          "material": { "law": "linear_elastic", "youngs_modulus": "10000 kPa", "poissons_ratio": 0.3 }
        }
      ],
      "gravity": { "acceleration": ["-9.8 m/s^2"], "level": 10, "loading": { "type": "ramp", "duration": "1 s" } },
      "time_step": { "stable_fraction": 0.2 },
      "termination": {
        "type": "at_rest",
        "unbalanced_force_ratio": 1e-8,
        "kinetic_energy_ratio": 1e-12,
        "deadline": "5 s"
      }
    },
    "sweep": [
      { "parameter": "/scene/grid/cell_size", "values": ["0.1 m", "0.05 m", "0.025 m"] },
      { "parameter": "/scene/scheme", "values": ["mpm", "cpgimp"] }
    ],
    "references": ["equilibrium", "hencky"],
    "probes": [{ "id": "top", "quantity": "displacement", "at": ["50 cm"], "every": "0.01 s" }],
    "gates": [
      {
        "id": "equilibrium",
        "metric": "equilibrium.stress.l2",
        "where": { "/scene/scheme": ["cpgimp"], "/scene/grid/cell_size": ["0.1 m", "0.025 m"] },
        "at_most": 0.002,
        "basis": "requirement",
        "reason": "Asked for."
      },
      {
        "id": "reduction",
        "metric": "hencky.stress.l2",
        "statistic": "reduction",
        "across": "/scene/grid/cell_size",
        "where": { "/scene/scheme": ["mpm"] },
        "at_least": 4,
        "basis": "theory",
        "reason": "Second order.",
        "must_fail": true
      },
      {
        "id": "order",
        "metric": "hencky.stress.l2",
        "statistic": "last_order",
        "across": "/scene/grid/cell_size",
        "at_least": 1,
        "basis": "fit",
        "reason": "Seen."
      }
    ],
    "figures": [
      {
        "id": "stress",
        "kind": "profiles",
        "quantity": "stress",
        "panels": "/scene/grid/cell_size",
        "series": "/scene/scheme",
        "references": ["hencky"],
        "caption": "Stress."
      },
      {
        "id": "convergence",
        "kind": "convergence",
        "over": "/scene/grid/cell_size",
        "series": "/scene/scheme",
        "metrics": ["hencky.stress.l2"],
        "where": { "/scene/scheme": ["cpgimp"] },
        "caption": "Convergence."
      },
      { "id": "bars", "kind": "bars", "metrics": ["equilibrium.stress.l2"], "caption": "Errors." },
      { "id": "settling", "kind": "history", "quantity": "top", "series": "/scene/scheme", "caption": "Settling." }
    ]
  })");
}

/// The same column with a second body on it, which no reference solution describes.
inline Json two_bodies() {
  Json text = valid_case();
  text["scene"]["bodies"].push_back(Json::parse(R"({
          "name": "upper",
          "lower": ["0.5 m"],
          "upper": ["1 m"],
          "particles_per_cell": [1],
          "density": "2.43 g/cm^3",
          "material": { "law": "zhang_elastic", "youngs_modulus": "10 MPa" }
        })"));
  text["references"] = Json::array();
  for (const char* key : {"figures", "claims"}) text.erase(key);
  text["gates"] = Json::parse(
      R"([{ "id": "completed", "metric": "completed", "at_least": 1, "basis": "requirement", "reason": "Asked for." }])");
  return text;
}

/// A block of soil in plane strain.
inline Json soil_case() {
  Json text = two_bodies();
  Json& scene = text["scene"];
  scene["dimension"] = 2;
  scene["objectivity"] = "jaumann";
  scene["grid"]["lower"].push_back("0 m");
  scene["grid"]["upper"].push_back("1.2 m");
  scene["grid"]["edges"]["y_lower"] = "fixed";
  scene["grid"]["edges"]["y_upper"] = "free";
  scene["bodies"].erase(1);
  Json& body = scene["bodies"][0];
  body["lower"].push_back("0 m");
  body["upper"].push_back("1 m");
  body["particles_per_cell"].push_back(2);
  body["velocity"] = {"0 m/s", "-2 cm/s"};
  body["material"] = {{"law", "mohr_coulomb"}, {"youngs_modulus", "1000 kPa"},
                      {"poissons_ratio", 0.3}, {"friction_angle", "20 deg"},
                      {"cohesion", "0.5 kPa"}, {"dilation_angle", "0 deg"}};
  scene["gravity"]["acceleration"].push_back("-9.8 m/s^2");
  text["probes"][0]["at"].push_back("50 cm");
  return text;
}

/// A footing on ground that becomes heavier, with a surcharge beside it.
inline Json footing_case() {
  Json text = soil_case();
  text.erase("sweep");
  text.erase("notes");
  Json& scene = text["scene"];
  scene["time_step"] = {{"stable_fraction", 0.2}};
  scene["termination"] = {{"type", "at_time"}, {"time", "2 s"}};
  scene["sums_strain"] = true;
  scene["gravity"]["acceleration"] = {"0 m/s^2", "-9.8 m/s^2"};
  scene["grid"]["edges"]["x_lower"] = "roller";
  Json& body = scene["bodies"][0];
  body["upper"] = {"1 m", "50 cm"};
  body["density_ramp"] = {{"final_density", "2 t/m^3"}, {"start", "100 ms"}, {"duration", "1 s"}};
  body["initial_stress"] = {{"type", "geostatic"}, {"surface", "0.5 m"}, {"k0", 0.5}};
  Json second = body;
  second["name"] = "plate";
  second["lower"] = {"0 m", "0.6 m"};
  second["upper"] = {"1 m", "1.2 m"};
  second.erase("velocity");
  second.erase("density_ramp");
  second["ring"] = {{"center", {"0.5 m", "0.9 m"}}, {"inner_radius", "10 cm"}, {"outer_radius", "30 cm"}};
  second["initial_stress"] = {{"type", "uniform"}, {"xx", "-10 kPa"}, {"xy", "1 kPa"}};
  second["material"] = {{"law", "linear_elastic"}, {"youngs_modulus", "1 MPa"}, {"poissons_ratio", 0.3}};
  scene["bodies"].push_back(second);
  scene["rigid_bodies"] = Json::parse(R"([
    { "name": "footing", "lower": ["0 m", "0.5 m"], "upper": ["0.2 m", "0.6 m"], "constrains": ["y"],
      "velocity": ["0 m/s", "-1 mm/s"], "angular_velocity": "0.5 rad/s", "start": "10 ms", "ramp": "0.1 s" },
    { "name": "plug", "lower": ["0.4 m", "0.8 m"], "upper": ["0.6 m", "1 m"] }])");
  scene["surface_loads"] = Json::parse(R"([
    { "body": "lower", "edge": "y_upper", "from": "0.2 m", "to": "0.5 m", "traction": ["0 Pa", "-2 kPa"], "ramp": "0.2 s" }])");
  text["probes"] = Json::parse(R"([
    { "id": "corner", "quantity": "stress", "component": "zz", "at": ["0.5 m", "0.5 m"], "every": "0.1 s" },
    { "id": "settlement", "quantity": "displacement", "of": "footing", "every": "0.01 s" },
    { "id": "pressure", "quantity": "reaction", "of": "footing", "every": "0.01 s" },
    { "id": "mean", "quantity": "velocity", "of": "plate", "component": "x", "every": "0.01 s" },
    { "id": "weight", "quantity": "weight", "of": "lower", "every": "0.01 s" },
    { "id": "momentum", "quantity": "momentum", "every": "0.01 s" },
    { "id": "energy", "quantity": "kinetic_energy", "every": "0.01 s" }])");
  text["snapshots"] = Json::parse(
      R"([{ "time": "0 s" }, { "time": "0.1 s" }, { "probe": "settlement", "reaches": "-5 mm" }, { "end": true }])");
  text["figures"] = Json::parse(R"([
    { "id": "strain", "kind": "fields", "quantity": "max_shear_strain", "caption": "Strain." },
    { "id": "load", "kind": "curves", "quantity": "pressure", "references": [], "caption": "Pressure." }])");
  return text;
}

/// A bar that is driven through a standing wave.
inline Json wave_case() {
  Json text = two_bodies();
  text.erase("sweep");
  Json& scene = text["scene"];
  scene["bodies"].erase(1);
  scene["bodies"][0]["upper"] = {"1 m"};
  scene["bodies"][0]["material"] = {
      {"law", "neo_hookean"}, {"youngs_modulus", "10 MPa"}, {"poissons_ratio", 0.3}};
  scene["driven_motion"] = {{"solution", "standing_wave"}, {"amplitude", "5 cm"}, {"length", "1 m"}};
  scene["gravity"]["level"] = 0;
  scene["termination"] = {{"type", "at_time"}, {"time", "0.02 s"}};
  text["probes"] = Json::parse(R"([{ "id": "energy", "quantity": "strain_energy", "every": "1 ms" }])");
  return text;
}

inline Case parsed(const Json& text) { return vv::parse_case(text.dump(2), "column.json"); }

/// The message of the CaseError that reading the text throws, or an empty text.
inline std::string refusal_of(const std::string& text) {
  try {
    vv::parse_case(text, "column.json");
    return "";
  } catch (const CaseError& error) {
    return error.what();
  }
}

/// Checks one line: "file: pointer: expected ... , found ...", with these phrases in their places.
inline void expect_message(const std::string& message, const std::string& file, const std::string& pointer,
                           const std::string& expected, const std::string& found) {
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  const std::string start = file + ": " + pointer + ": expected ";
  EXPECT_TRUE(message.starts_with(start)) << "should start with " << start << "\n" << message;
  const std::size_t middle = message.rfind(", found ");
  ASSERT_NE(middle, std::string::npos) << message;
  EXPECT_LT(message.find(expected), middle) << expected << "\n" << message;
  EXPECT_NE(message.find(found, middle), std::string::npos) << found << "\n" << message;
}

}  // namespace mpm::test
