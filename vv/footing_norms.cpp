#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "reference/bearing_capacity.hpp"
#include "reference/elastic_strip.hpp"
#include "vv/curve_shape.hpp"
#include "vv/judging.hpp"
#include "vv/load_curve.hpp"

namespace mpm::vv {
namespace {

/// Only the last part of the settlement is judged as the state reached: its share of the whole.
constexpr double judged_share = 0.2;

// ---- what each reference needs

double degrees(double angle) { return angle * 180 / std::numbers::pi; }

/// The range in which the exact factor of weight is known.
bool has_slip_line_field(double friction_angle) {
  return degrees(friction_angle) >= 1.0 && degrees(friction_angle) <= 50.0;
}

bool has_strength(const MohrCoulomb& soil, const Footing& footing) {
  return soil.friction_angle == 0.0 || soil.cohesion > 0.0 || footing.weight > 0.0 || footing.surcharge > 0.0;
}

const char* const lacks_law = "ground of Mohr-Coulomb's law";
const char* const lacks_strength = "something that gives the ground strength: cohesion, surcharge or weight";

std::string why_no_limit_load(const Footing& footing) {
  const auto* soil = std::get_if<MohrCoulomb>(&footing.ground->material);
  if (!soil) return lacks_law;
  if (footing.weight > 0.0 && (soil->cohesion > 0.0 || footing.surcharge > 0.0))
    return "either weight or strength without weight, since only one term at a time is exact";
  if (!has_strength(*soil, footing)) return lacks_strength;
  if (footing.weight > 0.0 && !has_slip_line_field(soil->friction_angle))
    return "a friction angle from 1 to 50 degrees, where the factor of weight is known";
  return "";
}

std::string why_no_embedded_limit(const Footing& footing) {
  const auto* soil = std::get_if<MohrCoulomb>(&footing.ground->material);
  if (!soil) return lacks_law;
  if (!has_strength(*soil, footing)) return lacks_strength;
  if (footing.weight > 0.0 && soil->friction_angle > 0.0 && !has_slip_line_field(soil->friction_angle))
    return "a friction angle of zero or from 1 to 50 degrees, where the factor of weight is known";
  return "";
}

std::string why_no_terzaghi(const Footing& footing) {
  const auto* soil = std::get_if<MohrCoulomb>(&footing.ground->material);
  if (!soil) return lacks_law;
  if (footing.roughness() == reference::Roughness::smooth) return "a rough footing";
  if (!has_strength(*soil, footing)) return lacks_strength;
  if (footing.weight > 0.0 && soil->friction_angle > 0.0 &&
      !reference::terzaghi_ngamma_chart(soil->friction_angle))
    return "a friction angle of 0, 15, 20, 25 or 30 degrees, for which the chart's factor of weight is "
           "quoted";
  return "";
}

/// What the stiffness of an elastic layer needs of everything but the ground's law.
std::string why_no_layer(const Scene& scene, const Footing& footing) {
  if (scene.edges[1][0] != Condition::fixed) return "ground that stands on a fixed y_lower edge";
  if (!footing.half) return "a half model, its axis a roller at the grid's lower edge";
  if (scene.edges[0][1] != Condition::roller || footing.ground->upper[0] != scene.grid_upper[0])
    return "ground that reaches to a roller on its far side";
  return "";
}

/// Young's modulus and Poisson's ratio of small strains of the laws that respond as an elastic layer at
/// first.
std::optional<LinearElastic> elasticity_of(const Material& material) {
  if (const auto* elastic = std::get_if<LinearElastic>(&material)) return *elastic;
  const auto* soil = std::get_if<MohrCoulomb>(&material);
  return soil ? std::optional(LinearElastic{soil->youngs_modulus, soil->poissons_ratio}) : std::nullopt;
}

std::string why_no_elastic_strip(const Scene& scene, const Footing& footing) {
  const auto* elastic = std::get_if<LinearElastic>(&footing.ground->material);
  if (!elastic) return "linear elastic ground";
  if (elastic->poissons_ratio > 0.49) return "Poisson's ratio up to 0.49";
  if (footing.ground->initial_stress) return "ground that starts free of stress";
  if (footing.weight != 0.0 || footing.surcharge != 0.0) return "ground without weight or surcharge";
  return why_no_layer(scene, footing);
}

std::string why_no_elastic_layer(const Scene& scene, const Footing& footing) {
  const std::optional<LinearElastic> elastic = elasticity_of(footing.ground->material);
  if (!elastic) return "ground that is linear elastic or of Mohr-Coulomb's law";
  if (elastic->poissons_ratio > 0.49) return "Poisson's ratio up to 0.49";
  return why_no_layer(scene, footing);
}

std::string why_unsuited_to_footings(const std::string& reference, const Scene& scene) {
  std::string missing = why_no_footing(scene);
  if (missing.empty()) missing = why_not_only_pressed(scene);
  if (!missing.empty()) return missing;
  const Footing footing = footing_of(scene);
  if (reference == "limit_analysis") return why_no_limit_load(footing);
  if (reference == "terzaghi") return why_no_terzaghi(footing);
  if (reference == "embedded_limit") return why_no_embedded_limit(footing);
  return reference == "elastic_strip" ? why_no_elastic_strip(scene, footing)
                                      : why_no_elastic_layer(scene, footing);
}

std::string why_not_recorded(const std::string&, const Case& definition, const RunRequest& request) {
  return why_no_load_curve(definition, request.scene);
}

// ---- the references

/// Solves once for each key: a sweep over schemes asks for the same again and again. Each place that calls it
/// has results of its own, since no two have the same type of `solve`.
template <class Key, class Solve>
auto solved_once(const Key& key, const Solve& solve) {
  static std::mutex mutex;
  static std::map<Key, decltype(solve())> solved;
  const std::lock_guard lock(mutex);
  const auto known = solved.find(key);
  return known != solved.end() ? known->second : solved.emplace(key, solve()).first->second;
}

/// The exact factor of weight; none of it adds to the strength of soil without friction.
double exact_ngamma_of(double friction_angle, reference::Roughness roughness) {
  if (friction_angle == 0.0) return 0.0;
  const std::pair key(friction_angle, roughness == reference::Roughness::rough);
  return solved_once(key, [&] { return reference::exact_ngamma(friction_angle, roughness); });
}

reference::SecantStiffness stiffness_of(const reference::ElasticStrip& strip) {
  const std::tuple key(strip.half_width, strip.layer_depth, strip.side_distance, strip.youngs_modulus,
                       strip.poissons_ratio, strip.roughness == reference::Roughness::rough);
  return solved_once(key, [&] { return reference::secant_stiffness(strip); });
}

/// The exact stiffness of the ground as long as it is elastic [Pa/m].
double elastic_stiffness(const Footing& footing) {
  const Body& ground = *footing.ground;
  const LinearElastic elastic = *elasticity_of(ground.material);
  return stiffness_of({footing.width, ground.upper[1] - ground.lower[1], ground.upper[0] - ground.lower[0],
                       elastic.youngs_modulus, elastic.poissons_ratio, footing.roughness()})
      .value;
}

/// The mean pressure [Pa] below a footing that has gone down by `embedment` [m], by exact factors of
/// associated flow and superposition [DavisBooker71]. The soil above its base loads what lies below, and no
/// more: neither its strength nor what has heaved beside the footing counts.
double exact_pressure(const Footing& footing, double embedment) {
  const auto& soil = std::get<MohrCoulomb>(footing.ground->material);
  const double phi = soil.friction_angle;
  const double ngamma = footing.weight > 0.0 ? exact_ngamma_of(phi, footing.roughness()) : 0.0;
  return reference::superposed_capacity({.width = footing.full_width(),
                                         .cohesion = soil.cohesion,
                                         .surcharge = footing.surcharge + footing.weight * embedment,
                                         .unit_weight = footing.weight},
                                        {reference::exact_nc(phi), reference::exact_nq(phi), ngamma});
}

/// Terzaghi's for a footing on the surface [Pa]: his factors of cohesion and surcharge, his chart's of
/// weight.
double terzaghi_pressure(const Footing& footing) {
  const auto& soil = std::get<MohrCoulomb>(footing.ground->material);
  const double phi = soil.friction_angle;
  const double ngamma = footing.weight > 0.0 && phi > 0.0 ? *reference::terzaghi_ngamma_chart(phi) : 0.0;
  return reference::superposed_capacity({.width = footing.full_width(),
                                         .cohesion = soil.cohesion,
                                         .surcharge = footing.surcharge,
                                         .unit_weight = footing.weight},
                                        {reference::terzaghi_nc(phi), reference::terzaghi_nq(phi), ngamma});
}

// ---- the load curve and those of the references

/// The samples of the last part of the settlement.
Values judged_part(const LoadCurve& curve, const Values& values) {
  Values part;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (curve.settlement[k] >= (1 - judged_share) * curve.settlement.back()) part.push_back(values[k]);
  }
  return part;
}

double mean_of(const Values& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

void draw_line(Judging& judging, const std::string& reference, const Values& settlement,
               const Values& pressure) {
  judging.result.curves.push_back({"pressure", reference, settlement, pressure, "settlement"});
}

double largest_of(const Values& values) {
  return std::accumulate(values.begin(), values.end(), values.front(), larger);
}

/// From the pressure before the footing moves to the largest of the run, or to its deepest settlement.
void draw_elastic_layer(Judging& judging, const Footing& footing, const LoadCurve& curve) {
  const double stiffness = elastic_stiffness(footing);
  const double first = footing.block ? curve.pressure.front() : 0.0;
  const double end = std::min(largest_of(curve.settlement), (largest_of(curve.pressure) - first) / stiffness);
  draw_line(judging, "elastic_layer", {0.0, end}, {first, first + stiffness * end});
}

void draw_references(Judging& judging, const Footing& footing, const LoadCurve& curve) {
  const double deepest = largest_of(curve.settlement);
  if (judging.asks_for("limit_analysis")) {
    const double exact = exact_pressure(footing, 0.0);
    draw_line(judging, "limit_analysis", {0.0, deepest}, {exact, exact});
  }
  if (judging.asks_for("elastic_strip"))
    draw_line(judging, "elastic_strip", {0.0, deepest}, {0.0, elastic_stiffness(footing) * deepest});
  if (judging.asks_for("terzaghi")) {
    const double surface = terzaghi_pressure(footing);
    draw_line(judging, "terzaghi", {0.0, deepest}, {surface, surface});
  }
  if (judging.asks_for("embedded_limit"))
    draw_line(judging, "embedded_limit", {0.0, deepest},
              {exact_pressure(footing, 0.0), exact_pressure(footing, deepest)});
  if (judging.asks_for("elastic_layer")) draw_elastic_layer(judging, footing, curve);
}

// ---- metrics

void judge_by_limit_load(Judging& judging, const Footing& footing, const LoadCurve& curve) {
  const double exact = exact_pressure(footing, 0.0);
  const Values reached = judged_part(curve, curve.pressure);
  const auto [least, most] = std::minmax_element(reached.begin(), reached.end());
  const double mean = mean_of(reached);
  judging.set("limit_analysis.pressure", mean);
  judging.set("limit_analysis.overshoot", mean / exact - 1);
  judging.set("limit_analysis.shortfall", 1 - mean / exact);
  judging.set("limit_analysis.peak_overshoot", largest_of(curve.pressure) / exact - 1);
  judging.set("limit_analysis.spread", (*most - *least) / mean);
}

void judge_by_stiffness(Judging& judging, const Footing& footing, const LoadCurve& curve) {
  const double exact = elastic_stiffness(footing);
  const double stiffness =
      mean_of(judged_part(curve, curve.pressure)) / mean_of(judged_part(curve, curve.settlement));
  judging.set("elastic_strip.stiffness", std::abs(stiffness / exact - 1));
  judging.set("elastic_strip.overshoot", stiffness / exact - 1);
}

void judge_knees(Judging& judging, const CurveShape& shape) {
  const Polyline &one = shape.fit(1), &two = shape.fit(2), &three = shape.fit(3);
  judging.set("load_curve.bend_settlement", two.x[1]);
  judging.set("load_curve.bend_pressure", two.y[1]);
  judging.set("load_curve.bend_ratio", two.slope(1) / two.slope(0));
  judging.set("load_curve.straightness_gain_2", 1 - two.rms_residual / one.rms_residual);
  judging.set("load_curve.first_bend_settlement", three.x[1]);
  judging.set("load_curve.first_bend_pressure", three.y[1]);
  judging.set("load_curve.second_bend_settlement", three.x[2]);
  judging.set("load_curve.second_bend_pressure", three.y[2]);
  judging.set("load_curve.straightness_gain_3", 1 - three.rms_residual / two.rms_residual);
  judging.set("load_curve.phases", shape.phases());
}

/// Whatever the run tells on its way, be it completed or not.
void judge_course(Judging& judging) {
  if (!why_no_footing(judging.scene()).empty()) return;
  const Footing footing = footing_of(judging.scene());
  const std::optional<LoadCurve> curve = load_curve_of(judging.definition, judging.scene(), judging.record);
  if (!curve) return;
  draw_line(judging, "run", curve->settlement, curve->pressure);
  draw_references(judging, footing, *curve);
  judging.set("load_curve.deepest", largest_of(curve->settlement));
  const std::optional<CurveShape> shape = shape_of(*curve);
  if (!shape) return;
  judge_knees(judging, *shape);
  judging.set("load_curve.final_slope", shape->final_slope);
  if (!shape->initial_stiffness) return;
  judging.set("load_curve.initial_stiffness", *shape->initial_stiffness);
  if (judging.asks_for("elastic_layer"))
    judging.set("elastic_layer.stiffness_ratio", *shape->initial_stiffness / elastic_stiffness(footing));
}

/// What the run has reached in the end, over what a theory allows there.
void judge_by_theories(Judging& judging, const Footing& footing, const LoadCurve& curve) {
  const std::optional<CurveShape> shape = shape_of(curve);
  if (!shape) return;
  if (judging.asks_for("terzaghi"))
    judging.set("terzaghi.exceeded_by", shape->final_pressure / terzaghi_pressure(footing) - 1);
  if (judging.asks_for("embedded_limit")) {
    const double exact = exact_pressure(footing, largest_of(curve.settlement));
    judging.set("embedded_limit.exceeded_by", shape->final_pressure / exact - 1);
  }
}

void judge(Judging& judging) {
  if (!why_no_footing(judging.scene()).empty()) return;
  const Footing footing = footing_of(judging.scene());
  const std::optional<LoadCurve> curve = load_curve_of(judging.definition, judging.scene(), judging.record);
  if (!curve) return;
  if (judging.asks_for("limit_analysis")) judge_by_limit_load(judging, footing, *curve);
  if (judging.asks_for("elastic_strip")) judge_by_stiffness(judging, footing, *curve);
  if (judging.asks_for("terzaghi") || judging.asks_for("embedded_limit"))
    judge_by_theories(judging, footing, *curve);
}

std::vector<Metric> catalogue() {
  const std::string last = "over the last fifth of the settlement";
  return {
      {"limit_analysis.pressure", "Pa", "limit_analysis", "mean pressure below the strip " + last},
      {"limit_analysis.overshoot", "-", "limit_analysis",
       "that pressure over the exact limit pressure, minus 1"},
      {"limit_analysis.shortfall", "-", "limit_analysis", "the same the other way round: 1 minus the ratio"},
      {"limit_analysis.peak_overshoot", "-", "limit_analysis",
       "largest pressure over the exact limit pressure, minus 1"},
      {"limit_analysis.spread", "-", "limit_analysis", "range of the pressure over its mean, " + last},
      {"elastic_strip.stiffness", "-", "elastic_strip",
       "relative error of pressure over settlement, both means " + last},
      {"elastic_strip.overshoot", "-", "elastic_strip", "the same with its sign: positive is too stiff"},
      {"load_curve.bend_settlement", "m", "", "knee of the best two straight pieces"},
      {"load_curve.bend_pressure", "Pa", "", "the two pieces' pressure there"},
      {"load_curve.bend_ratio", "-", "", "slope after that knee over slope before"},
      {"load_curve.straightness_gain_2", "-", "", "1 - what two pieces leave over what one leaves"},
      {"load_curve.first_bend_settlement", "m", "", "first knee of the best three straight pieces"},
      {"load_curve.first_bend_pressure", "Pa", "", "the three pieces' pressure there"},
      {"load_curve.second_bend_settlement", "m", "", "second knee of the best three straight pieces"},
      {"load_curve.second_bend_pressure", "Pa", "", "the three pieces' pressure there"},
      {"load_curve.straightness_gain_3", "-", "", "1 - what three pieces leave over what two leave"},
      {"load_curve.phases", "-", "",
       "straight pieces needed to stay within 2 % of the largest pressure; 5 if four do not"},
      {"load_curve.initial_stiffness", "Pa/m", "",
       "slope at first of a parabola through the first third of the pressure gained up to the bend"},
      {"load_curve.final_slope", "Pa/m", "", "slope of the straight line " + last},
      {"load_curve.deepest", "m", "", "largest settlement reached"},
      {"elastic_layer.stiffness_ratio", "-", "elastic_layer",
       "initial stiffness over the exact one of the elastic layer"},
      {"terzaghi.exceeded_by", "-", "terzaghi",
       "pressure at the deepest settlement over Terzaghi's for the surface, minus 1"},
      {"embedded_limit.exceeded_by", "-", "embedded_limit",
       "pressure at the deepest settlement over the limit with that embedment, minus 1"},
  };
}

}  // namespace

NormFamily footing_norms() {
  return {{"limit_analysis", "elastic_strip", "terzaghi", "embedded_limit", "elastic_layer"},
          catalogue(),
          why_unsuited_to_footings,
          judge,
          why_not_recorded,
          judge_course};
}

}  // namespace mpm::vv
