#include "reports/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "reports/figure_parts.hpp"
#include "reports/stability_figures.hpp"
#include "reports/trade_figures.hpp"
#include "reports/typography.hpp"
#include "reports/validation_figures.hpp"
#include "vv/curves.hpp"
#include "vv/norms.hpp"

namespace mpm::reports {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr double profile_margin = 0.12;  // of the reference's range, on either side
constexpr std::size_t many_series = 6;   // a lone panel with more takes the whole width
constexpr double largest_error_shown = 10.0;  // relative errors above 1000 % say no more than "wrong"

const Color floor_color{0.45, 0.45, 0.45, 1.0};
const Color gate_color{0.75, 0.0, 0.15, 1.0};

// ---- names
// ----------------------------------------------------------------------------------------------------

std::string last_word(const std::string& pointer) {
  std::string word = pointer.substr(pointer.rfind('/') + 1);
  std::replace(word.begin(), word.end(), '_', ' ');
  return word;
}

std::string scheme_name(const std::string& scheme) {
  if (scheme == "mpm") return "MPM";
  if (scheme == "ugimp") return "uGIMP";
  if (scheme == "cpgimp") return "cpGIMP";
  return escaped(scheme);
}

std::string plain_text(const vv::Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{:g}", value.get<double>());
  if (value.is_object())
    for (const char* key : {"law", "type", "name"})
      if (value.contains(key) && value[key].is_string()) return value[key].get<std::string>();
  return value.dump();
}

/// "ramped load over 1 s", "sudden load", "staged load (5, 3, 1 times full)".
std::string loading_name(const vv::Json& loading) {
  const std::string type = loading.value("type", "");
  std::string name = type == "ramp"     ? "ramped load"
                     : type == "step"   ? "sudden load"
                     : type == "staged" ? "staged load"
                                        : type;
  if (loading.contains("duration")) name += " over " + plain_text(loading["duration"]);
  if (loading.contains("fractions") && loading["fractions"].is_array()) {
    std::string fractions;
    for (const vv::Json& fraction : loading["fractions"])
      fractions += (fractions.empty() ? "" : ", ") + plain_text(fraction);
    name += " (" + fractions + " times full)";
  }
  return escaped(name);
}

/// [2, 2] is "2 × 2 particles per cell".
std::string particles_name(const vv::Json& per_axis) {
  std::string name;
  for (const vv::Json& count : per_axis) name += (name.empty() ? "" : " × ") + escaped(plain_text(count));
  return name + " particles per cell";
}

std::string millimetres(double metres) { return fmt::format("{:.4g}", metres * 1e3); }

std::string norm_name(const std::string& norm) {
  if (norm == "l1") return "<i>L</i><sub>1</sub>";
  if (norm == "l2") return "<i>L</i><sub>2</sub>";
  if (norm == "linf" || norm == "l_inf" || norm == "loo") return "<i>L</i><sub>∞</sub>";
  return escaped(norm);
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts{""};
  for (const char c : text) {
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

/// What a person calls something that has a name in case files.
struct Named {
  const char* name;
  const char* full;   ///< in a legend, markup
  const char* brief;  ///< after "against", markup
};

constexpr Named reference_names[] = {
    {"equilibrium", "equilibrium, exact for every law", "equilibrium"},
    {"hencky", "Hencky, exact for the rate law", "Hencky"},
    {"zhang", "Zhang, the published solution", "Zhang"},
    {"manufactured", "manufactured solution, exact motion", "the manufactured solution"},
    {"limit_analysis", "limit analysis, exact limit load", "limit analysis"},
    {"elastic_strip", "elastic strip, exact stiffness", "the elastic strip"},
    {"free_fall", "free fall, exact motion", "free fall"},
    {"rotation", "rigid rotation, exact stress", "rigid rotation"},
    {"closed_form", "closed form", "the closed form"},
    {"terzaghi", "Terzaghi, surface", "Terzaghi"},
    {"embedded_limit", "limit analysis, current embedment", "limit analysis at the current embedment"},
    {"elastic_layer", "elastic layer", "the elastic layer"},
};

constexpr std::pair<const char*, const char*> metric_names[] = {
    {"oscillation.hp", "high-pass content HP of the error"},
    {"oscillation.ns", "null-space content NS of the stress"},
    {"limit_analysis.overshoot", "overshoot of the exact limit load"},
    {"limit_analysis.shortfall", "shortfall of the exact limit load"},
    {"limit_analysis.peak_overshoot", "overshoot of the peak load"},
    {"limit_analysis.spread", "spread of the limit load"},
    {"limit_analysis.pressure", "pressure at the limit"},
    {"elastic_strip.stiffness", "error of stiffness against the elastic strip"},
    {"elastic_strip.overshoot", "excess of stiffness over the elastic strip"},
    {"free_fall.displacement", "error of displacement in free fall"},
    {"free_fall.stress", "stress in free fall"},
    {"rotation.stress", "error of stress under rotation"},
    {"momentum_change", "change of momentum"},
    {"energy_loss", "loss of energy"},
    {"energy_gain", "gain of energy"},
    {"bar.frequency", "error of the bar’s frequency"},
    {"bar.amplitude", "error of the bar’s amplitude"},
    {"element.oracle", "distance from every other way to return"},
    {"element.excess", "stress beyond the limit"},
    {"element.plastic_work", "least plastic work"},
    {"element.rotation", "difference when turned"},
    {"element.exchange", "difference when axes are exchanged"},
    {"element.stress", "error of stress against the closed form"},
    {"element.volume", "error of volume against the closed form"},
    {"element.dilation", "error of dilation against the closed form"},
    {"element.limit", "error of the limit against the closed form"},
    {"energy_balance.kinetic", "share of the energy still in motion"},
    {"energy_balance.dissipated", "share of the energy in plastic work"},
    {"energy_balance.numerical_loss", "share of the energy lost by the numerics"},
    {"collapse.aspect_ratio", "aspect ratio <i>H</i><sub>0</sub>/<i>L</i><sub>0</sub>"},
    {"collapse.run_out", "run-out (<i>L</i><sub>f</sub> − <i>L</i><sub>0</sub>)/<i>L</i><sub>0</sub>"},
    {"collapse.deposit_height", "height of the deposit <i>H</i><sub>f</sub>/<i>L</i><sub>0</sub>"},
    {"collapse.area_change", "change of area"},
    {"load_curve.bend_pressure", "ultimate pressure"},
};

const Named* named_reference(const std::string& reference) {
  for (const Named& known : reference_names)
    if (reference == known.name) return &known;
  return nullptr;
}

/// "<i>L</i><sub>2</sub> error of stress" of "hencky.stress.l2", "error of settlement" of
/// "hencky.settlement"; nothing of a metric that compares with no reference.
std::string error_name(const std::string& metric) {
  const std::vector<std::string> parts = split(metric, '.');
  const bool compares = parts[0] == "equilibrium" || parts[0] == "hencky" || parts[0] == "zhang" ||
                        parts[0] == "manufactured" || parts[0] == "floor";
  if (!compares || parts.size() < 2) return "";
  return (parts.size() > 2 ? norm_name(parts[2]) + " error of " : "error of ") + escaped(spaced(parts[1]));
}

std::string short_name_of_reference(const std::string& reference) {
  const Named* known = named_reference(reference);
  return known ? known->brief : escaped(capitalised(reference));
}

// ---- ranges
// -----------------------------------------------------------------------------------------------------

/// Whole of a logarithmic axis: the values up to `largest_error_shown`, with room around them.
Range logarithmic_range(const std::vector<double>& values) {
  Extent extent;
  for (const double value : values)
    if (value > 0.0 && value <= largest_error_shown) extent.include(value);
  if (extent.empty()) return {1e-3, largest_error_shown};
  const double decades = std::max(1.0, std::log10(extent.upper / extent.lower));
  const double room = std::pow(10.0, 0.08 * decades + 0.1);
  return {extent.lower / room, extent.upper * room};
}

// ---- profiles
// ---------------------------------------------------------------------------------------------------

int dimension_of(const std::vector<Member>& members) {
  return members.empty() || !members.front().scene ? 1 : members.front().scene->dimension;
}

Quantity quantity_of(const std::string& name, int dimension) {
  if (name == "stress") return {1e-3, "stress <i>σ</i> [kPa]"};
  if (name == "displacement") return {1e3, "displacement <i>u</i> [mm]"};
  if (name == "velocity") return {1e3, "velocity <i>v</i> [mm/s]"};
  const std::string per = dimension == 1 ? "/m²" : "/m";  // of the dimensions the model does not have
  if (name == "reaction") return {1e-3, "reaction [kN" + per + "]"};
  if (name == "weight") return {1e-3, "weight [kN" + per + "]"};
  if (name == "kinetic_energy") return {1.0, "kinetic energy [J" + per + "]"};
  if (name == "strain_energy") return {1.0, "strain energy [J" + per + "]"};
  if (name == "potential_energy") return {1.0, "potential energy [J" + per + "]"};
  if (name == "stress_work") return {1.0, "work of the stresses [J" + per + "]"};
  if (name == "momentum") return {1.0, "momentum [N s" + per + "]"};
  if (name == "stress_error") return {1.0, "error of stress / max |<i>σ</i><sub>exact</sub>|"};
  return {1.0, escaped(name)};
}

std::string height_label(const std::string& x_name) {
  if (x_name == "position") return "height <i>x</i> [m]";
  if (x_name == "initial_position") return "initial height <i>X</i> [m]";
  return escaped(x_name);
}

Look reference_look(std::size_t number) {
  Look look;
  look.color = black;
  look.line_width = 0.9;
  if (number == 1) look.dash = {5.0, 2.0};
  if (number == 2) look.dash = {1.5, 1.5};
  return look;
}

/// Whether two reference curves are one solution: their values reach equally far, to 1 %, and where both
/// stand over the same places they are equal to as much.
bool are_alike(const vv::Curve& a, const vv::Curve& b) {
  const double reach_a = extent_of(a.y).reach(), reach_b = extent_of(b.y).reach();
  const double close = 0.01 * std::max(reach_a, reach_b) + 1e-300;
  if (std::abs(reach_a - reach_b) > close) return false;
  if (a.x != b.x) return true;
  for (std::size_t i = 0; i < a.y.size(); ++i)
    if (std::abs(a.y[i] - b.y[i]) > close) return false;
  return true;
}

/// The reference curves of a panel, one of each kind: runs of one panel share their exact solution, so the
/// one that spans most stands for all.
std::vector<const vv::Curve*> reference_curves(const std::vector<Member>& members, const std::string& name,
                                               const std::string& source) {
  std::vector<const vv::Curve*> kept;
  const auto span = [](const vv::Curve* c) { return extent_of(c->x).upper - extent_of(c->x).lower; };
  for (const Member& member : members) {
    const vv::Curve* curve = curve_of(*member.run, name, source);
    if (!curve || curve->x.empty()) continue;
    const auto same = std::find_if(kept.begin(), kept.end(),
                                   [curve](const vv::Curve* other) { return are_alike(*curve, *other); });
    if (same == kept.end())
      kept.push_back(curve);
    else if (span(curve) > span(*same))
      *same = curve;
  }
  return kept;
}

/// A profile has its abscissa along the vertical axis.
PlotCurve profile_curve(const vv::Curve& curve, const std::string& label, const Look& look, double factor) {
  PlotCurve plotted{label, look, curve.y, curve.x, 0};
  for (double& value : plotted.x) value *= factor;
  return plotted;
}

PlotCurve sorted_by_height(PlotCurve curve) {
  std::vector<std::size_t> order(curve.y.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&curve](std::size_t a, std::size_t b) { return curve.y[a] < curve.y[b]; });
  PlotCurve sorted{curve.label, curve.look, {}, {}, 0};
  for (const std::size_t i : order) {
    sorted.x.push_back(curve.x[i]);
    sorted.y.push_back(curve.y[i]);
  }
  return sorted;
}

PlotCurve zero_line(const Range& heights) {
  Look look;
  look.line_width = 0.6;
  return {"", look, {0.0, 0.0}, {heights.lower, heights.upper}, 0};
}

Panel profile_panel(const std::vector<Member>& members, const vv::FigureRequest& request,
                    const std::string& title) {
  const Quantity quantity = quantity_of(request.quantity, dimension_of(members));
  Panel panel;
  panel.title = title;
  panel.x.label = quantity.label;
  Extent values, heights;
  values.include(0.0);
  heights.include(0.0);
  std::string x_name = "position";
  for (std::size_t i = 0; i < request.references.size(); ++i)
    for (const vv::Curve* curve : reference_curves(members, request.quantity, request.references[i])) {
      panel.curves.push_back(sorted_by_height(profile_curve(*curve, name_of_reference(request.references[i]),
                                                            reference_look(i), quantity.factor)));
      for (const double v : panel.curves.back().x) values.include(v);
      for (const double h : panel.curves.back().y) heights.include(h);
    }
  const bool referenced = !panel.curves.empty() && values.upper > values.lower;
  std::vector<Extent> value_extents, height_extents;
  for (const Member& member : members) {
    const vv::Curve* curve = curve_of(*member.run, request.quantity, "run");
    if (!curve) continue;
    x_name = curve->x_name;
    Look look = look_of_series(member.look);
    look.line_width = 0.0;
    panel.curves.push_back(profile_curve(*curve, member.series, look, quantity.factor));
    value_extents.push_back(extent_of(curve->y, quantity.factor));
    height_extents.push_back(extent_of(curve->x));
  }
  if (!referenced) {
    const Extent tame = tame_extent(value_extents);
    values.include(tame.lower);
    values.include(tame.upper);
  }
  if (heights.upper <= heights.lower) heights.include(tame_extent(height_extents).upper);
  panel.x.range = values.widened(profile_margin);
  panel.y.range = {heights.lower, heights.upper + 0.05 * (heights.upper - heights.lower)};
  if (!(panel.y.range.upper > panel.y.range.lower)) panel.y.range.upper = panel.y.range.lower + 1.0;
  panel.y.label = height_label(x_name);
  if (request.quantity == "stress_error") panel.curves.insert(panel.curves.begin(), zero_line(panel.y.range));
  panel.notes =
      notes_on_runs(members, [&](const Member& m) { return !curve_of(*m.run, request.quantity, "run"); });
  return panel;
}

// ---- histories
// --------------------------------------------------------------------------------------------------

Panel history_panel(const std::vector<Member>& members, const vv::CaseVerdict& verdict,
                    const vv::FigureRequest& request, const std::string& title) {
  Panel panel;
  panel.title = title;
  const auto& probes = verdict.definition.probes;
  const auto probe = std::find_if(probes.begin(), probes.end(),
                                  [&request](const vv::HistoryProbe& p) { return p.id == request.quantity; });
  const Quantity quantity =
      quantity_of(probe != probes.end() ? probe->quantity : request.quantity, dimension_of(members));
  panel.x.label = "time <i>t</i> [s]";
  panel.y.label = quantity.label;
  const std::size_t symbol_end = panel.y.label.find("</i>");
  if (probe != probes.end() && symbol_end != std::string::npos)
    panel.y.label.insert(symbol_end + 4, "<sub>" + escaped(probe->id) + "</sub>");
  std::vector<Extent> extents;
  Extent times;
  times.include(0.0);
  const auto add = [&](const vv::Curve& curve, const std::string& label, const Look& look) {
    PlotCurve plotted{label, look, curve.x, curve.y, layer_of(look)};
    for (double& value : plotted.y) value *= quantity.factor;
    for (const double t : plotted.x) times.include(t);
    extents.push_back(extent_of(plotted.y));
    panel.curves.push_back(std::move(plotted));
  };
  for (const Member& member : members) {
    if (const vv::Curve* curve = curve_of(*member.run, request.quantity, "run"))
      add(*curve, member.series, line_look(member));
  }
  for (std::size_t i = 0; i < request.references.size(); ++i)
    for (const vv::Curve* curve : reference_curves(members, request.quantity, request.references[i]))
      add(*curve, name_of_reference(request.references[i]), reference_look(i));
  panel.x.range = times.upper > times.lower ? Range{times.lower, times.upper} : Range{0.0, 1.0};
  panel.y.range = tame_extent(extents).widened(0.08);
  panel.notes =
      notes_on_runs(members, [&](const Member& m) { return !curve_of(*m.run, request.quantity, "run"); });
  return panel;
}

// ---- curves over anything
// ------------------------------------------------------------------------------------------

/// Puts values in the unit that suits their reach and names the axis after it.
double set_unit(Axis& axis, const std::string& name, double reach) {
  const AxisWords words = words_of_curve(name);
  const Quantity shown = shown_unit(words.unit, reach);
  axis.label = words.words + (words.unit.empty() ? "" : " [" + shown.label + "]");
  return shown.factor;
}

/// The names of the reference solutions drawn beside a quantity: those asked for, or all there are.
std::vector<std::string> references_of(const std::vector<Member>& members, const vv::FigureRequest& request) {
  if (!request.references.empty()) return request.references;
  std::vector<std::string> names;
  for (const Member& member : members)
    for (const vv::Curve& curve : member.run->curves)
      if (curve.name == request.quantity && curve.source != "run" &&
          std::find(names.begin(), names.end(), curve.source) == names.end())
        names.push_back(curve.source);
  return names;
}

/// A curve of the verdict in its place in the picture.
struct Line {
  const vv::Curve* curve = nullptr;
  std::string label;
  Look look;
  int layer = 0;
  std::optional<Look> sample = std::nullopt;  ///< in the legend, when it is not the curve's own look
};

/// The member that alone has a curve like this; null if several have.
const Member* only_owner(const std::vector<Member>& members, const vv::Curve& curve) {
  const Member* owner = nullptr;
  for (const Member& member : members) {
    const vv::Curve* own = curve_of(*member.run, curve.name, curve.source);
    if (!own || !are_alike(*own, curve)) continue;
    if (owner) return nullptr;
    owner = &member;
  }
  return owner;
}

std::vector<Line> lines_of(const std::vector<Member>& members, const vv::FigureRequest& request) {
  std::vector<Line> lines;
  for (const Member& member : members)
    if (const vv::Curve* curve = curve_of(*member.run, request.quantity, "run")) {
      const Look look = line_look(member);
      lines.push_back({curve, member.series, look, layer_of(look)});
    }
  const std::vector<std::string> references = references_of(members, request);
  for (std::size_t i = 0; i < references.size(); ++i) {
    const std::vector<const vv::Curve*> curves = reference_curves(members, request.quantity, references[i]);
    for (const vv::Curve* curve : curves) {
      Line line{curve, name_of_reference(references[i]), dashed_reference_look(i), 3};
      if (const Member* owner = curves.size() > 1 ? only_owner(members, *curve) : nullptr) {
        // Thin and pale beside the run of its colour, whose own line may be dashed too.
        line.sample = line.look;
        line.look.color = tint(line_look(*owner).color, 0.25);
        line.look.line_width = 0.8;
      }
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

/// Two metrics that together are a place on a load curve.
struct Bend {
  const char *settlement, *pressure;
  std::size_t order;  ///< 0 the first of its curve, 1 the second
};

/// The bends a curve was found to have: of three straight pieces two, of two pieces one, of one piece none.
std::vector<Bend> bends_of(const vv::RunVerdict& run) {
  const double phases = metric_of(run, "load_curve.phases");
  const Bend only{"load_curve.bend_settlement", "load_curve.bend_pressure", 0},
      first{"load_curve.first_bend_settlement", "load_curve.first_bend_pressure", 0},
      second{"load_curve.second_bend_settlement", "load_curve.second_bend_pressure", 1};
  if (phases < 1.5) return {};
  if (phases > 2.5) return {first, second};
  return {only};
}

/// Marks the bends of the curves where the metrics say they are; the axes are in their units already.
void mark_bends(Panel& panel, const std::vector<Member>& members, double settlement_factor,
                double pressure_factor) {
  const auto look = [](std::size_t order, const Color& color) {
    return order == 0 ? mark_look(MarkerShape::circle, 5.4, color)
                      : mark_look(MarkerShape::triangle, 4.6, color);
  };
  std::array<bool, 2> any{};
  for (const Member& member : members)
    for (const Bend& bend : bends_of(*member.run)) {
      const double settlement = metric_of(*member.run, bend.settlement),
                   pressure = metric_of(*member.run, bend.pressure);
      if (!std::isfinite(settlement) || !std::isfinite(pressure)) continue;
      any[bend.order] = true;
      panel.curves.push_back({"",
                              look(bend.order, line_look(member).color),
                              {pressure * pressure_factor},
                              {settlement * settlement_factor},
                              4});
    }
  if (any[0]) panel.curves.push_back({"bend of the straight pieces fitted", look(0, ink), {}, {}, 0});
  if (any[1]) panel.curves.push_back({"second bend", look(1, ink), {}, {}, 0});
}

/// 1 is "(i)"; numbers beyond ten are written in digits.
std::string stage_label(std::size_t number) {
  static constexpr const char* numerals[] = {"i", "ii", "iii", "iv", "v", "vi", "vii", "viii", "ix", "x"};
  return number <= std::size(numerals) ? fmt::format("({})", numerals[number - 1])
                                       : fmt::format("({})", number);
}

/// Says in the legend that there is no measurement, and why: there if it fits, else below the panel.
void explain_unavailable(Panel& panel, const std::string& why, bool alone) {
  const double room = alone ? 290.0 : 430.0;     // of a legend entry's words [pt]
  constexpr std::size_t longest_measured = 200;  // bytes; more never fit on a line
  Look look;
  look.color = {0.6, 0.6, 0.6, 1.0};
  look.line_width = 1.3;
  look.dash = {2.0, 4.0};
  std::string label = "measured: not available";
  const std::string whole = label + ", " + escaped(why);
  if (whole.size() < longest_measured && text_width(whole) <= room)
    label = whole;
  else
    panel.notes.push_back("Measured: not available (" + escaped(why) + ")");
  panel.curves.push_back({label, look, {}, {}, 0});
}

/// The tame part of values that start at zero or go through it, with room at the ends that are not zero.
Range range_from_zero(const std::vector<Extent>& extents) {
  Extent tame = tame_extent(extents);
  tame.include(0.0);
  const Range wide = tame.widened(0.06);
  return {tame.lower < 0.0 ? wide.lower : 0.0, tame.upper > 0.0 || tame.lower >= 0.0 ? wide.upper : 0.0};
}

/// A load–settlement curve is drawn as geotechnical engineers do: the load to the right, the settlement down.
Panel curve_panel(const std::vector<Member>& members, const vv::FigureRequest& request,
                  const std::string& title) {
  const std::vector<Line> lines = lines_of(members, request);
  Panel panel;
  panel.title = title;
  std::vector<Extent> across, along;
  for (const Line& line : lines) {
    across.push_back(extent_of(line.curve->x));
    along.push_back(extent_of(line.curve->y));
  }
  across.push_back(extent_of(request.stages));
  const std::string x_name = lines.empty() ? "" : lines.front().curve->x_name;
  const bool settles = request.quantity == "pressure";
  Axis& x = settles ? panel.y : panel.x;
  Axis& y = settles ? panel.x : panel.y;
  const Range x_range = range_from_zero(across), y_range = range_from_zero(along);
  const double x_factor = set_unit(x, x_name, std::max(-x_range.lower, x_range.upper));
  const double y_factor = set_unit(y, request.quantity, std::max(-y_range.lower, y_range.upper));
  x.range = {x_range.lower * x_factor, x_range.upper * x_factor};
  y.range = {y_range.lower * y_factor, y_range.upper * y_factor};
  x.reversed = settles;
  for (const Line& line : lines) {
    if (line.sample) panel.curves.push_back({line.label, *line.sample, {}, {}, 0});
    PlotCurve curve{line.label, line.look, line.curve->x, line.curve->y, line.layer};
    for (double& value : curve.x) value *= x_factor;
    for (double& value : curve.y) value *= y_factor;
    if (settles) std::swap(curve.x, curve.y);
    panel.curves.push_back(std::move(curve));
  }
  panel.notes =
      notes_on_runs(members, [&](const Member& m) { return !curve_of(*m.run, request.quantity, "run"); });
  if (settles && request.marks) mark_bends(panel, members, x_factor, y_factor);
  for (std::size_t k = 0; k < request.stages.size(); ++k)
    panel.levels.push_back({request.stages[k] * x_factor, stage_label(k + 1), "", {muted, 0.6, {1.0, 2.0}}});
  if (!request.unavailable.empty()) explain_unavailable(panel, request.unavailable, title.empty());
  return panel;
}

// ---- fields
// -----------------------------------------------------------------------------------------------------

constexpr double scale_percentile = 0.995;  // where a colour scale ends if a few values lie far beyond
constexpr double far_beyond = 0.5;          // of the span between the percentiles
constexpr double view_percentile = 0.999;   // of the places, on either side

/// Markup of a field's name; it never ends in a unit.
std::string name_of_field(const std::string& quantity) {
  static const std::map<std::string, std::string> known{
      {"displacement", "displacement |<i>u</i>|"},
      {"displacement_x", "displacement <i>u<sub>x</sub></i>"},
      {"displacement_y", "displacement <i>u<sub>y</sub></i>"},
      {"speed", "speed |<i>v</i>|"},
      {"stress_xx", "stress <i>σ<sub>xx</sub></i>, tension positive"},
      {"stress_yy", "stress <i>σ<sub>yy</sub></i>, tension positive"},
      {"stress_zz", "stress <i>σ<sub>zz</sub></i>, tension positive"},
      {"stress_xy", "shear stress <i>σ<sub>xy</sub></i>"},
      {"mean_stress", "mean stress, tension positive"},
      {"max_shear_stress", "largest shear stress in the plane"},
      {"max_shear_strain", "largest shear strain in the plane <i>γ</i>"},
  };
  const auto found = known.find(quantity);
  return found == known.end() ? escaped(spaced(quantity)) : found->second;
}

/// The value below which a part of the values lies; they become partly sorted.
double percentile(std::vector<double>& values, double part) {
  const auto at = static_cast<std::ptrdiff_t>(std::llround(part * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

/// The part of one axis to show: all particles, or nearly all when a few that flew off would shrink the rest.
Range view_range(const std::vector<const vv::FieldMap*>& maps,
                 const std::vector<double> vv::FieldMap::*center,
                 const std::vector<double> vv::FieldMap::*half_size) {
  std::vector<double> centers;
  Extent whole;
  double largest = 0.0;
  for (const vv::FieldMap* map : maps)
    for (std::size_t p = 0; p < map->value.size(); ++p) {
      const double at = (map->*center)[p], half = (map->*half_size)[p];
      if (!std::isfinite(at) || !std::isfinite(half)) continue;
      centers.push_back(at);
      whole.include(at - half);
      whole.include(at + half);
      largest = std::max(largest, half);
    }
  if (centers.empty()) return {0.0, 1.0};
  const double lower = percentile(centers, 1.0 - view_percentile) - largest,
               upper = percentile(centers, view_percentile) + largest;
  if (whole.upper - whole.lower > 1.5 * (upper - lower)) return Extent{lower, upper}.widened(0.05);
  return {whole.lower, whole.upper};
}

/// Where the colours of values between `lower` and `upper` (lower <= upper) begin and end.
ColorScale scale_between(const std::string& quantity, double lower, double upper) {
  ColorScale scale;
  const double reach = std::max(std::abs(lower), std::abs(upper));
  const bool both_signs = lower < 0.0 && upper > 0.0 && std::min(-lower, upper) >= 0.1 * reach;
  const bool of_either_sign = quantity == "stress_xy" || quantity == "displacement_x";
  if (both_signs || of_either_sign) {
    scale.map = ColorMap::diverging;
    scale.range = {-reach, reach};
  } else {
    // A scale that leaves zero out shows small differences, and hides how small they are.
    const bool varies_little = std::min(std::abs(lower), std::abs(upper)) > 0.5 * reach;
    scale.range = varies_little ? Range{lower, upper} : Range{std::min(lower, 0.0), std::max(upper, 0.0)};
  }
  if (!(scale.range.upper > scale.range.lower)) scale.range = {lower - 0.5 * reach, upper + 0.5 * reach};
  if (!(scale.range.upper > scale.range.lower)) scale.range = {0.0, 1.0};
  return scale;
}

/// The scale of the tame values together. It ends at a percentile on the side where a few lie far beyond;
/// what of all values lies beyond its ends is told.
ColorScale color_scale(const std::vector<const vv::FieldMap*>& tame,
                       const std::vector<const vv::FieldMap*>& all, const vv::FieldQuantity& quantity) {
  std::vector<double> values;
  for (const vv::FieldMap* map : tame)
    std::copy_if(map->value.begin(), map->value.end(), std::back_inserter(values),
                 [](double v) { return std::isfinite(v); });
  if (values.empty()) values = {0.0};
  const auto [smallest, largest] = std::minmax_element(values.begin(), values.end());
  const double tame_least = *smallest, tame_most = *largest;
  double lower = percentile(values, 1.0 - scale_percentile), upper = percentile(values, scale_percentile);
  const double far = far_beyond * (upper - lower);
  if (tame_most - upper <= far) upper = tame_most;
  if (lower - tame_least <= far) lower = tame_least;
  ColorScale scale = scale_between(quantity.name, lower, upper);
  const Quantity shown =
      shown_unit(quantity.unit, std::max(std::abs(scale.range.lower), std::abs(scale.range.upper)));
  scale.factor = shown.factor;
  scale.label = name_of_field(quantity.name) + " [" + shown.label + "]";
  Extent everything;
  for (const vv::FieldMap* map : all)
    for (const double value : map->value) everything.include(value);
  if (everything.lower < scale.range.lower) scale.below = everything.lower * shown.factor;
  if (everything.upper > scale.range.upper) scale.above = everything.upper * shown.factor;
  scale.range = {scale.range.lower * shown.factor, scale.range.upper * shown.factor};
  return scale;
}

/// The moments at which the runs were kept, as the run that has most of them orders them.
std::vector<std::string> moments_of(std::vector<Member> members) {
  std::stable_sort(members.begin(), members.end(), [](const Member& a, const Member& b) {
    return a.run->record.snapshots.size() > b.run->record.snapshots.size();
  });
  std::vector<std::string> moments;
  for (const Member& member : members)
    for (const vv::Snapshot& snapshot : member.run->record.snapshots)
      if (std::find(moments.begin(), moments.end(), snapshot.moment) == moments.end())
        moments.push_back(snapshot.moment);
  return moments;
}

/// The moments of the snapshots that a request chooses, in its order.
std::vector<std::string> chosen_moments(const vv::Case& definition, const vv::FigureRequest& request) {
  std::vector<std::string> moments;
  for (const int index : request.snapshots)
    moments.push_back(vv::moment_of(definition.snapshots.at(static_cast<std::size_t>(index))));
  return moments;
}

/// Markup of a moment, with a true minus sign.
std::string moment_markup(const std::string& moment) {
  std::string markup = escaped(moment);
  const std::size_t minus = markup.find("= -");
  return minus == std::string::npos ? markup : markup.replace(minus + 2, 1, "−");
}

/// The run at the moment, or a note why it cannot be shown.
FieldPanel field_panel(const Member& member, const std::string& moment, const std::string& quantity) {
  FieldPanel panel;
  const vv::Record& record = member.run->record;
  const auto snapshot = std::find_if(record.snapshots.begin(), record.snapshots.end(),
                                     [&moment](const vv::Snapshot& s) { return s.moment == moment; });
  if (snapshot != record.snapshots.end()) {
    try {
      panel.map = vv::map_of(*snapshot, quantity);
    } catch (const std::invalid_argument& reason) {
      panel.note = escaped(reason.what());
    }
  } else if (!record.completed()) {
    panel.note = "did not complete: " + name_of_ending(record) + place_of_ending(record);
  } else {
    panel.note = "completed, but kept no snapshot" + (moment.empty() ? "" : " at " + moment_markup(moment));
  }
  return panel;
}

std::string name_in_row(const Member& member) {
  if (member.panel.empty()) return member.series == "simulation" ? "" : member.series;
  return member.panel + (member.series == "simulation" ? "" : ", " + member.series);
}

/// The frames in which a measurement would stand if there were one, as many as there are moments.
void add_unavailable_row(FieldPlot& plot, std::size_t moments, const std::string& why) {
  for (std::size_t column = 0; column < moments; ++column)
    plot.panels.push_back({column == 0 ? "measured: not available" : "", std::nullopt, escaped(why), true});
}

/// Runs in rows and moments in columns; with one of either alone, the panels flow as they fill the page best.
/// The last of the rows may be that of a missing measurement, which has its name.
void set_names(FieldPlot& plot, const std::vector<Member>& members, const std::vector<std::string>& moments) {
  const bool one_moment = moments.size() == 1;
  const bool one_run = plot.panels.size() == moments.size();
  for (std::size_t i = 0; i < plot.panels.size(); ++i) {
    const std::size_t row = i / moments.size(), column = i % moments.size();
    if (row >= members.size()) continue;
    if (one_run && !one_moment)
      plot.panels[i].title = moment_markup(moments[column]);
    else if (column == 0)
      plot.panels[i].title = name_in_row(members[row]);
    if (column == 0 && plot.panels[i].title.empty() && !one_run) plot.panels[i].title = "simulated";
  }
  if (one_run && !one_moment)
    plot.heads = {name_in_row(members.front())};
  else
    for (const std::string& moment : moments) plot.heads.push_back(moment_markup(moment));
  if (std::all_of(plot.heads.begin(), plot.heads.end(), [](const std::string& h) { return h.empty(); }))
    plot.heads.clear();
  plot.columns = one_run || one_moment ? best_columns(plot) : static_cast<int>(moments.size());
}

/// How many of the values drawn the colour scale cannot tell from its ends: "3 of 1800".
std::string beyond_scale(const FieldPlot& plot) {
  std::size_t beyond = 0, all = 0;
  for (const FieldPanel& panel : plot.panels) {
    if (!panel.map) continue;
    for (const double value : panel.map->value) {
      const double shown = value * plot.scale.factor;
      beyond += shown < plot.scale.range.lower || shown > plot.scale.range.upper;
      ++all;
    }
  }
  return fmt::format("{} of {}", beyond, all);
}

/// What a reader of the picture must know beside it.
void set_notes(FieldPlot& plot, const std::vector<Member>& members, std::size_t moments, std::size_t asked,
               std::size_t came_about) {
  if (plot.scale.above || plot.scale.below)
    plot.notes.push_back(fmt::format(
        "The colour scale covers at least percentiles {:g} to {:g} of the values of completed runs. "
        "Beyond it lie {} values drawn; the outermost stands beside the arrow.",
        100.0 * (1.0 - scale_percentile), 100.0 * scale_percentile, beyond_scale(plot)));
  for (std::size_t m = 0; m < members.size(); ++m) {
    const vv::Record& record = members[m].run->record;
    const auto first = plot.panels.begin() + static_cast<std::ptrdiff_t>(m * moments);
    const bool shown = std::any_of(first, first + static_cast<std::ptrdiff_t>(moments),
                                   [](const FieldPanel& panel) { return panel.map.has_value(); });
    if (!record.completed() && shown)
      plot.notes.push_back(fmt::format("{} did not complete: {}{}; shown is what was kept before.",
                                       members[m].series, name_of_ending(record), place_of_ending(record)));
  }
  if (came_about < asked)
    plot.notes.push_back(
        fmt::format("Of {} snapshots asked for, {} came about in no run.", asked, asked - came_about));
}

// ---- metrics
// ----------------------------------------------------------------------------------------------------

std::string unit_of(const std::string& metric) {
  const std::string unit = si_unit_of(metric, {});
  return unit.empty() || unit == "-" ? "" : " [" + escaped(unit) + "]";
}

/// Whether a metric is a value of its own and no error: it goes to a limit other than zero.
bool is_value(const std::string& metric) {
  return metric.starts_with(vv::reading_prefix) || metric.starts_with("load_curve.");
}

/// Without the reference, which the panel's title names.
std::string axis_name_of_metric(const std::string& metric) {
  if (metric == "oscillation.hp") return "HP";
  if (metric == "oscillation.ns") return "NS";
  const std::string error = error_name(metric);
  return (error.empty() ? name_of_metric(metric) : error) + unit_of(metric);
}

/// The reference that the material of a scene converges to.
std::string own_reference(const Scene* scene) {
  if (!scene || scene->bodies.empty()) return "";
  return std::holds_alternative<ZhangElastic>(scene->bodies.front().material) ? "zhang" : "hencky";
}

/// Whether the difference between the two laws bounds this metric from below: stress compared with the other
/// law's solution. A run compared with its own law's solution has no such floor.
bool floor_applies(const Member& member, const std::string& metric) {
  const std::string own = own_reference(member.scene);
  if (own.empty() || !metric.ends_with(".stress.l2")) return false;
  return metric.starts_with(own == "hencky" ? "zhang." : "hencky.");
}

/// The model-form floor over the cell sizes, if a run of the panel has it.
std::optional<PlotCurve> floor_curve(const std::vector<Member>& members, const std::string& metric) {
  std::vector<std::pair<double, double>> points;
  for (const Member& member : members) {
    const double value = metric_of(*member.run, "floor.stress.l2");
    if (floor_applies(member, metric) && std::isfinite(value) && std::isfinite(member.cell_size))
      points.emplace_back(member.cell_size * 1e3, value);
  }
  if (points.empty()) return std::nullopt;
  std::sort(points.begin(), points.end());
  Look look;
  look.color = floor_color;
  look.line_width = 1.0;
  look.dash = {2.0, 2.0};
  PlotCurve curve{"model-form floor (Zhang − Hencky)", look, {}, {}, 0};
  for (const auto& [x, y] : points) {
    if (!curve.x.empty() && curve.x.back() == x) continue;
    curve.x.push_back(x);
    curve.y.push_back(y);
  }
  return curve;
}

/// Whether a run is one of those that a series was made of.
bool is_part_of(const Member& member, const vv::SeriesVerdict& series) {
  return std::all_of(series.fixed.begin(), series.fixed.end(), [&member](const auto& entry) {
    const vv::Json* value = value_of(member.run->parameters, entry.first);
    return value && *value == entry.second;
  });
}

/// Observed orders of one series between neighbouring refinements, for a note; empty if the verdict has none.
std::string order_note(const vv::CaseVerdict& verdict, const vv::FigureRequest& request, const Member& member,
                       const std::string& metric) {
  for (const vv::SeriesVerdict& series : verdict.series) {
    if (series.across != request.over || !is_part_of(member, series)) continue;
    const auto orders = series.orders.find(metric);
    if (orders == series.orders.end() || orders->second.empty()) continue;
    return "Observed orders of " + member.series + ": " + orders_markup(orders->second);
  }
  return "";
}

/// What a panel about a metric is called: "against Hencky", "Overshoot of the exact limit load".
std::string subject_of(const std::string& metric) {
  if (error_name(metric).empty()) return capitalised(name_of_metric(metric));
  return "against " + short_name_of_reference(metric.substr(0, metric.find('.')));
}

/// The convergence of a metric over the refinement that a run is part of; null where none was found.
const vv::GridConvergence* convergence_of(const vv::CaseVerdict& verdict, const std::string& across,
                                          const Member& member, const std::string& metric) {
  for (const vv::SeriesVerdict& series : verdict.series) {
    if (series.across != across || !is_part_of(member, series)) continue;
    const auto found = series.convergence.find(metric);
    if (found != series.convergence.end()) return &found->second;
  }
  return nullptr;
}

/// "observed order 1.62, finest value ± 3.1 %".
std::string convergence_words(const vv::GridConvergence& convergence) {
  const std::string order = convergence.monotone ? "observed order " + orders_markup({convergence.order})
                                                 : std::string("not monotone");
  return order + ", finest value ± " + number_markup(100.0 * convergence.uncertainty, 2) + " %";
}

/// An upright bar with a cap at either end.
PlotCurve error_bar(double x, double lower, double upper, double half_cap, const Color& color) {
  Look look;
  look.color = color;
  look.line_width = 0.9;
  return {"",
          look,
          {x - half_cap, x + half_cap, x, x, x - half_cap, x + half_cap},
          {lower, lower, lower, upper, upper, upper},
          1};
}

/// A value over the cell size on axes that begin at a cell size of zero, where the extrapolated value stands
/// and how far off the finest may be.
Panel value_panel(const std::vector<Member>& members, const vv::CaseVerdict& verdict,
                  const vv::FigureRequest& request, const std::string& metric, const std::string& title) {
  Panel panel;
  panel.title = title;
  panel.x.label = "cell size <i>h</i> [mm]";
  Extent values, sizes;
  for (const Member& member : members) {
    values.include(metric_of(*member.run, metric));
    sizes.include(member.cell_size * 1e3);
  }
  if (sizes.empty()) sizes.include(1.0);
  const Quantity shown = shown_metric(metric, verdict.definition, values.empty() ? 0.0 : values.reach());
  panel.y.label = shown.label;
  panel.x.ticks = {{0.0, "0"}};
  panel.x.range = {-0.08 * sizes.upper, 1.08 * sizes.upper};
  const auto labels = distinct(members, [](const Member& m) { return m.series; });
  bool any_bar = false;
  for (std::size_t k = 0; k < labels.size(); ++k) {
    std::map<double, double> points;
    const Member* first = nullptr;
    for (const Member& member : members) {
      const double value = metric_of(*member.run, metric);
      if (member.series != labels[k] || !std::isfinite(member.cell_size)) continue;
      if (!first) first = &member;
      panel.x.ticks.emplace_back(member.cell_size * 1e3, millimetres(member.cell_size));
      if (std::isfinite(value)) points[member.cell_size * 1e3] = value * shown.factor;
    }
    if (!first || points.empty()) continue;
    Look look = look_of_series(first->look);
    look.marker_size = look.filled ? 4.0 : 4.8;
    PlotCurve curve{labels[k], look, {}, {}, 2};
    for (const auto& [x, y] : points) {
      curve.x.push_back(x);
      curve.y.push_back(y);
    }
    if (const vv::GridConvergence* found = convergence_of(verdict, request.over, *first, metric)) {
      // Series side by side, so that no bar hides another.
      const double beside = static_cast<double>(k) - (static_cast<double>(labels.size()) - 1.0) / 2;
      const double x = 0.025 * sizes.upper * beside, finest = points.begin()->second;
      const double reach = found->uncertainty * std::abs(finest);
      any_bar = true;
      panel.notes.push_back(labels[k] + ": " + convergence_words(*found));
      values.include((finest - reach) / shown.factor);
      values.include((finest + reach) / shown.factor);
      panel.curves.push_back(error_bar(x, finest - reach, finest + reach, 0.009 * sizes.upper, look.color));
      if (std::isfinite(found->extrapolated)) {
        const double limit = found->extrapolated * shown.factor;
        values.include(found->extrapolated);
        Look to_limit = look;
        to_limit.marker = MarkerShape::none;
        to_limit.line_width = 0.8;
        to_limit.dash = {1.0, 2.0};
        panel.curves.push_back({"", to_limit, {x, points.begin()->first}, {limit, finest}, 0});
        Look mark = mark_look(MarkerShape::diamond, 4.6, look.color);
        panel.curves.push_back({"", mark, {x}, {limit}, 3});
      }
    }
    panel.curves.push_back(std::move(curve));
  }
  std::sort(panel.x.ticks.begin(), panel.x.ticks.end());
  panel.x.ticks.erase(std::unique(panel.x.ticks.begin(), panel.x.ticks.end()), panel.x.ticks.end());
  const Range wide = values.widened(0.1);
  panel.y.range = {wide.lower * shown.factor, wide.upper * shown.factor};
  if (any_bar)
    panel.notes.push_back(
        "At <i>h</i> = 0: bar, the finest value ± its uncertainty of discretisation; diamond, the "
        "extrapolated value, if the order allows one.");
  for (std::string& note :
       notes_on_runs(members, [&](const Member& m) { return !std::isfinite(metric_of(*m.run, metric)); }))
    panel.notes.push_back(std::move(note));
  return panel;
}

Panel convergence_panel(const std::vector<Member>& members, const vv::CaseVerdict& verdict,
                        const vv::FigureRequest& request, const std::string& metric,
                        const std::string& title) {
  if (is_value(metric)) return value_panel(members, verdict, request, metric, title);
  Panel panel;
  panel.title = title;
  panel.x.label = "cell size <i>h</i> [mm]";
  panel.y.label = axis_name_of_metric(metric);
  // Where all panels are about the same, the axis says it and the title need not.
  const std::string subject = subject_of(metric);
  const bool alike = std::all_of(request.metrics.begin(), request.metrics.end(),
                                 [&](const std::string& other) { return subject_of(other) == subject; });
  if (title.empty() || !alike) panel.title += (title.empty() ? "" : ", ") + subject;
  panel.x.scale = panel.y.scale = Scale::logarithmic;
  std::vector<double> values;
  Extent sizes;
  std::set<double, std::greater<>> ticks;
  for (const std::string& label : distinct(members, [](const Member& m) { return m.series; })) {
    std::vector<std::pair<double, double>> points;
    const Member* first = nullptr;
    for (const Member& member : members) {
      if (member.series != label || !std::isfinite(member.cell_size)) continue;
      if (!first) first = &member;
      ticks.insert(member.cell_size);
      sizes.include(member.cell_size * 1e3);
      const double value = metric_of(*member.run, metric);
      if (std::isfinite(value)) points.emplace_back(member.cell_size * 1e3, value);
    }
    std::sort(points.begin(), points.end());
    if (!first || points.empty()) continue;
    Look look = look_of_series(first->look);
    look.marker_size = look.filled ? 4.0 : 4.8;
    PlotCurve curve{label, look, {}, {}, 0};
    for (const auto& [x, y] : points) {
      curve.x.push_back(x);
      curve.y.push_back(y);
      values.push_back(y);
    }
    panel.curves.push_back(std::move(curve));
    const std::string note = order_note(verdict, request, *first, metric);
    if (!note.empty()) panel.notes.push_back(note);
  }
  if (auto floor = floor_curve(members, metric)) {
    values.insert(values.end(), floor->y.begin(), floor->y.end());
    panel.curves.insert(panel.curves.begin(), std::move(*floor));
  }
  if (sizes.empty()) sizes.include(1.0);
  panel.x.range = {sizes.lower / 1.35, sizes.upper * 1.35};
  for (const double size : ticks) panel.x.ticks.emplace_back(size * 1e3, millimetres(size));
  panel.y.range = logarithmic_range(values);
  panel.reference_slopes = {1.0, 2.0};
  for (std::string& note :
       notes_on_runs(members, [&](const Member& m) { return !std::isfinite(metric_of(*m.run, metric)); }))
    panel.notes.push_back(std::move(note));
  return panel;
}

std::string threshold_label(const std::string& op, double threshold) {
  const bool percent = threshold >= 1e-4 && threshold < 1.0;
  return op + " " + (percent ? fmt::format("{:g} %", threshold * 100.0) : number_markup(threshold, 0));
}

/// The thresholds that gates set on a metric of the runs shown, each once, with the series they hold for.
std::vector<LevelLine> gate_levels(const vv::Case& definition, const std::vector<Member>& members,
                                   const std::string& metric) {
  const std::size_t all = distinct(members, [](const Member& m) { return m.series; }).size();
  std::map<std::string, std::pair<double, std::vector<Member>>> by_label;
  for (const vv::Gate& gate : definition.gates) {
    if (gate.metric != metric || gate.statistic != vv::Statistic::value || !(gate.threshold > 0.0)) continue;
    auto& [threshold, held] =
        by_label[threshold_label(gate.comparison == vv::Comparison::at_most ? "≤" : "≥", gate.threshold)];
    threshold = gate.threshold;
    std::copy_if(members.begin(), members.end(), std::back_inserter(held),
                 [&gate](const Member& member) { return selected(*member.run, gate.where); });
  }
  std::vector<LevelLine> levels;
  for (const auto& [label, entry] : by_label) {
    const auto series = distinct(entry.second, [](const Member& m) { return m.series; });
    if (series.empty()) continue;
    std::string subjects;
    for (const std::string& name : distinct(members, [](const Member& m) { return m.series; }))
      if (std::find(series.begin(), series.end(), name) != series.end())
        subjects += (subjects.empty() ? " for " : ", ") + name;
    levels.push_back({entry.first,
                      label,
                      "gate threshold" + (series.size() < all ? subjects : ""),
                      {gate_color, 1.0, {4.0, 2.0}}});
  }
  return levels;
}

Panel bar_panel(const std::vector<Member>& members, const vv::CaseVerdict& verdict,
                const std::string& metric) {
  Panel panel;
  panel.title = capitalised(name_of_metric(metric, verdict.definition));
  panel.y.scale = Scale::logarithmic;
  panel.y.label = reading_of(verdict.definition, metric) ? shown_metric(metric, verdict.definition, 0.0).label
                                                         : axis_name_of_metric(metric);
  const auto series = distinct(members, [](const Member& m) { return m.series; });
  const auto groups = distinct(members, [](const Member& m) { return m.panel; });
  std::vector<double> values;
  for (const std::string& label : series) {
    const auto member =
        std::find_if(members.begin(), members.end(), [&](const Member& m) { return m.series == label; });
    panel.bar_series.push_back({label, look_of_series(member->look)});
  }
  for (const std::string& name : groups) {
    BarGroup group{name, {}, {}};
    for (const std::string& label : series) {
      const auto member = std::find_if(members.begin(), members.end(),
                                       [&](const Member& m) { return m.series == label && m.panel == name; });
      const double value = member == members.end() ? nan_value : metric_of(*member->run, metric);
      group.values.push_back(value);
      group.absences.push_back(member == members.end()           ? "not asked for"
                               : member->run->record.completed() ? "not measured"
                                                                 : "did not complete");
      values.push_back(value);
    }
    panel.groups.push_back(std::move(group));
  }
  panel.levels = gate_levels(verdict.definition, members, metric);
  for (const LevelLine& level : panel.levels) values.push_back(level.value);
  panel.y.range = logarithmic_range(values);
  panel.y.range.lower /= 2.0;
  const bool cut =
      std::any_of(values.begin(), values.end(), [&panel](double v) { return v > panel.y.range.upper; });
  if (cut) panel.y.range.upper *= 4.0;
  return panel;
}

// ---- decomposition
// ------------------------------------------------------------------------------------------------

/// The run that a member's change is seen against: the first value of the axis, all else alike.
const Member* baseline_of(const Member& member, const std::vector<Member>& members, const vv::Json& first,
                          const std::string& over) {
  for (const Member& other : members) {
    const vv::Json* value = value_of(other.run->parameters, over);
    if (value && *value == first && other.panel == member.panel && other.series == member.series)
      return &other;
  }
  return nullptr;
}

/// "+14 %"; of a change beyond a factor of ten, how many times as much.
std::string change_text(double value, double baseline) {
  if (!std::isfinite(value) || !std::isfinite(baseline) || baseline == 0.0) return "";
  const double change = 100.0 * (value / baseline - 1.0), size = std::abs(change);
  if (size >= 900.0) return fmt::format("×{:.0f}", value / baseline);
  const std::string digits = fmt::format("{:.{}f}", size, size < 9.95 ? 1 : 0);
  const bool zero = digits == "0.0";
  return (zero ? "±" : change < 0.0 ? "−" : "+") + digits + " %";
}

/// Where the reference solutions of the baseline's run are when they are read like the metric.
std::vector<RowLine> reference_lines(const Member& baseline, const vv::Reading& reading,
                                     const std::vector<std::string>& references, double factor) {
  std::vector<RowLine> lines;
  for (std::size_t i = 0; i < references.size(); ++i) {
    const vv::Curve* curve = vv::find_curve(baseline.run->curves, reading.curve, references[i]);
    const double value = curve ? vv::value_at(*curve, reading.at, reading.within).value : nan_value;
    if (!std::isfinite(value)) continue;
    const Look look = dashed_reference_look(i);
    lines.push_back(
        {value * factor, name_of_reference(references[i]), {look.color, look.line_width, look.dash}, true});
  }
  return lines;
}

constexpr double decomposition_values = 0.34;  // of the axis's width: room for values and changes

RowPanel decomposition_panel(const std::vector<Member>& members, const vv::CaseVerdict& verdict,
                             const vv::FigureRequest& request, const std::string& metric) {
  RowPanel panel;
  Extent extent;
  extent.include(0.0);
  for (const Member& member : members) extent.include(metric_of(*member.run, metric));
  const Quantity shown = shown_metric(metric, verdict.definition, extent.reach());
  panel.x.label = shown.label;
  const vv::Json* first = value_of(members.front().run->parameters, request.over);
  std::set<const Member*> baselines;
  for (const Member& member : members) {
    const Member* baseline = first ? baseline_of(member, members, *first, request.over) : nullptr;
    if (baseline) baselines.insert(baseline);
    const double value = metric_of(*member.run, metric);
    const bool is_baseline = baseline == &member;
    const std::string change = is_baseline ? "baseline"
                               : baseline  ? change_text(value, metric_of(*baseline->run, metric))
                                           : "";
    RowBar bar{is_baseline ? 0U : 1U, value * shown.factor};
    bar.text = std::isfinite(value) ? number_markup(bar.value) + (change.empty() ? "" : " · " + change)
               : member.run->record.completed() ? "not measured"
                                                : "did not complete";
    std::string name = member.over;
    if (member.series != "simulation") name += (name.empty() ? "" : ", ") + member.series;
    panel.rows.push_back({name, {bar}});
  }
  if (baselines.size() == 1) {
    const Member& baseline = **baselines.begin();
    const double value = metric_of(*baseline.run, metric);
    if (std::isfinite(value)) panel.lines.push_back({value * shown.factor, "", {ink, 0.8, {}}, true});
    const vv::Reading* reading = reading_of(verdict.definition, metric);
    if (reading && reading->over.empty())
      for (RowLine& line : reference_lines(baseline, *reading, request.references, shown.factor)) {
        extent.include(line.value / shown.factor);
        panel.lines.push_back(std::move(line));
      }
  }
  const double span = std::max((extent.upper - extent.lower) * shown.factor, 1e-300);
  panel.x.range = {extent.lower * shown.factor - (extent.lower < 0.0 ? 0.04 * span : 0.0),
                   extent.upper * shown.factor + span * decomposition_values / (1.0 - decomposition_values)};
  return panel;
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

std::string name_of_parameter(const std::string& pointer, const vv::Json& value) {
  const std::string text = plain_text(value);
  // An axis that has a name in place of a pointer has values that are names themselves.
  if (!pointer.starts_with('/')) return escaped(text);
  if (pointer == "/scene/gravity/level") return escaped(text) + "G";
  if (pointer == "/scene/scheme") return scheme_name(text);
  if (pointer == "/scene/precision") return escaped(text);
  if (pointer == "/scene/grid/cell_size") {
    const auto metres = length_of(value);
    return "<i>h</i> = " + (metres ? millimetres(*metres) + " mm" : escaped(text));
  }
  if (pointer.ends_with("/youngs_modulus")) return "<i>E</i> = " + escaped(text);
  for (const auto& [ending, symbol] : {std::pair{"/friction_angle", "φ"}, {"/dilation_angle", "ψ"}})
    if (pointer.ends_with(ending) && text.ends_with(" deg"))
      return fmt::format("<i>{}</i> = {}°", symbol, escaped(text.substr(0, text.size() - 4)));
  if (pointer.ends_with("/cohesion")) return "<i>c</i> = " + escaped(text);
  if (pointer == "/scene/update_order" && value.is_string()) {
    std::string upper = text;
    for (char& c : upper)
      if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    return escaped(upper);
  }
  if (text == "linear_elastic") return "linear elastic (rate form)";
  if (text == "zhang_elastic") return "Zhang’s law";
  if (pointer == "/scene/gravity/loading" && value.is_object()) return loading_name(value);
  if (pointer.ends_with("/particles_per_cell") && value.is_array()) return particles_name(value);
  if (pointer.ends_with("/constrains") && value.is_array()) return value.size() > 1 ? "rough" : "smooth";
  if (pointer == "/element/path") return escaped(spaced(text));
  return escaped(last_word(pointer) + " " + text);
}

std::string name_of_run(const Parameters& parameters) {
  std::string name;
  for (const auto& [pointer, value] : parameters)
    name += (name.empty() ? "" : ", ") + name_of_parameter(pointer, value);
  return name.empty() ? "the run" : name;
}

std::string name_of_reference(const std::string& reference) {
  const Named* known = named_reference(reference);
  return known ? known->full : escaped(reference);
}

std::string name_of_metric(const std::string& metric) {
  for (const auto& [name, words] : metric_names)
    if (metric == name) return words;
  const std::string relation = "metamorphic.";
  if (metric.starts_with(relation))
    return "difference under " + escaped(spaced(metric.substr(relation.size())));
  const std::string error = error_name(metric);
  if (error.empty()) return escaped(spaced(metric));
  const std::string reference = metric.substr(0, metric.find('.'));
  if (reference == "floor") return "model-form floor, " + error;
  return error + " against " + short_name_of_reference(reference);
}

std::string name_of_metric(const std::string& metric, const vv::Case& definition) {
  const vv::Reading* reading = reading_of(definition, metric);
  return reading ? escaped(reading->title) : name_of_metric(metric);
}

std::string name_of_ending(const vv::Record& record) {
  if (!record.failure.empty()) return escaped(record.failure);
  switch (record.outcome.ending) {
    case Ending::reached_time:
      return "reached its end time";
    case Ending::at_rest:
      return "came to rest";
    case Ending::not_at_rest:
      return "not at rest by the deadline";
    case Ending::reached_displacement:
      return "moved as far as asked";
    case Ending::not_reached:
      return "not moved so far by the deadline";
    case Ending::not_finite:
      return "a value is not finite";
    case Ending::inverted:
      return "a particle inverted";
    case Ending::outside_grid:
      return "a particle left the grid";
    case Ending::gained_energy:
      return "gained energy from nowhere";
    case Ending::domain_too_large:
      return "a domain outgrew its cell";
  }
  return "unknown ending";
}

std::string number_markup(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  if (value == 0.0) return "0";
  const std::string sign = value < 0.0 ? "−" : "";
  const double size = std::abs(value);
  const bool shortest = digits <= 0;
  if (size >= (shortest ? 1e-4 : 1e-2) && size < 1e5) {
    if (shortest || size == std::floor(size)) return sign + fmt::format("{:.6g}", size);
    const int exponent = static_cast<int>(std::floor(std::log10(size)));
    return sign + fmt::format("{:.{}f}", size, std::clamp(digits - 1 - exponent, 0, 12));
  }
  const std::string text = fmt::format("{:.{}e}", size, shortest ? 5 : digits - 1);
  const std::size_t e = text.find('e');
  std::string mantissa = text.substr(0, e);
  if (shortest && mantissa.find('.') != std::string::npos) {
    mantissa.erase(mantissa.find_last_not_of('0') + 1);
    if (mantissa.back() == '.') mantissa.pop_back();
  }
  const int exponent = std::stoi(text.substr(e + 1));
  const std::string power = fmt::format("10<sup>{}{}</sup>", exponent < 0 ? "−" : "", std::abs(exponent));
  return sign + (mantissa == "1" ? power : mantissa + "×" + power);
}

std::string orders_markup(const std::vector<double>& orders) {
  std::string text;
  for (const double order : orders) {
    if (!text.empty()) text += ", ";
    // Rounded first, so that no zero has a sign.
    const double rounded = std::round(order * 100.0);
    text += std::isfinite(order)
                ? (rounded < 0.0 ? "−" : "") + fmt::format("{:.2f}", std::abs(rounded) / 100.0)
                : "–";
  }
  return text.empty() ? "–" : text;
}

Plot plot_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request) {
  if (request.kind == "comparison") return comparison_plot_of(verdict, request);
  if (request.kind == "pairs") return pairs_plot_of(verdict, request);
  if (request.kind == "trend") return trend_plot_of(verdict, request);
  if (request.kind == "trade") return trade_plot_of(verdict, request);
  if (request.kind == "stability") return stability_plot_of(verdict, request);
  const std::vector<Member> members = members_of(verdict, request);
  const auto panels = distinct(members, [](const Member& m) { return m.panel; });
  Plot plot;
  if (request.kind == "profiles") {
    plot.frame_aspect = 0.95;
    for (const std::string& name : panels)
      plot.panels.push_back(profile_panel(in_panel(members, name), request, name));
  } else if (request.kind == "history") {
    plot.frame_aspect = 0.68;
    for (const std::string& name : panels)
      plot.panels.push_back(history_panel(in_panel(members, name), verdict, request, name));
  } else if (request.kind == "curves") {
    plot.frame_aspect = 0.8;
    for (const std::string& name : panels)
      plot.panels.push_back(curve_panel(in_panel(members, name), request, name));
  } else if (request.kind == "convergence") {
    plot.frame_aspect = 0.9;
    for (const std::string& name : panels)
      for (const std::string& metric : request.metrics)
        plot.panels.push_back(convergence_panel(in_panel(members, name), verdict, request, metric, name));
  } else if (request.kind == "bars") {
    plot.frame_aspect = 0.75;
    if (!members.empty())
      for (const std::string& metric : request.metrics)
        plot.panels.push_back(bar_panel(members, verdict, metric));
  } else {
    throw std::invalid_argument("a plot cannot be of kind \"" + request.kind + "\"");
  }
  plot.columns = plot.panels.size() > 1 ? 2 : 1;
  const bool crowded = distinct(members, [](const Member& m) { return m.series; }).size() > many_series;
  if (plot.columns == 1 && !crowded) plot.width = 340.0;
  if (plot.columns == 1 && crowded) plot.frame_aspect = 0.62;
  if (plot.panels.empty()) {
    Panel nothing;
    nothing.notes = {"No run was selected for this figure."};
    plot.panels.push_back(nothing);
  }
  plot.stamp = stamp_of(verdict, members);
  return plot;
}

FieldPlot field_plot_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request) {
  const auto& catalogue = vv::field_catalogue();
  const auto quantity =
      std::find_if(catalogue.begin(), catalogue.end(),
                   [&request](const vv::FieldQuantity& q) { return q.name == request.quantity; });
  if (quantity == catalogue.end())
    throw std::invalid_argument("no field is called \"" + request.quantity + "\"");
  const std::vector<Member> members = members_of(verdict, request);
  std::vector<std::string> moments = moments_of(members);
  std::size_t asked = verdict.definition.snapshots.size(), came_about = moments.size();
  if (!request.snapshots.empty()) {
    const std::vector<std::string> chosen = chosen_moments(verdict.definition, request);
    asked = chosen.size();
    came_about = static_cast<std::size_t>(
        std::count_if(chosen.begin(), chosen.end(), [&moments](const std::string& moment) {
          return std::find(moments.begin(), moments.end(), moment) != moments.end();
        }));
    moments = chosen;
  }
  if (moments.empty()) moments = {""};
  FieldPlot plot;
  for (const Member& member : members)
    for (const std::string& moment : moments)
      plot.panels.push_back(field_panel(member, moment, request.quantity));
  // A run that went wild decides neither what is seen nor in which colours.
  std::vector<const vv::FieldMap*> tame, all;
  for (std::size_t i = 0; i < plot.panels.size(); ++i) {
    if (!plot.panels[i].map) continue;
    all.push_back(&*plot.panels[i].map);
    if (members[i / moments.size()].run->record.completed()) tame.push_back(all.back());
  }
  if (tame.empty()) tame = all;
  plot.x = view_range(tame, &vv::FieldMap::x, &vv::FieldMap::half_x);
  plot.y = view_range(tame, &vv::FieldMap::y, &vv::FieldMap::half_y);
  if (request.view) {
    plot.x = {request.view->lower[0], request.view->upper[0]};
    plot.y = {request.view->lower[1], request.view->upper[1]};
  }
  plot.scale = color_scale(tame, all, *quantity);
  std::vector<const vv::RunVerdict*> runs;
  for (const Member& member : members) runs.push_back(member.run);
  add_measured_lines(plot, verdict, request, runs, moments);
  if (members.empty()) {
    plot.panels.push_back({"", std::nullopt, "No run was selected for this figure."});
  } else {
    if (!request.unavailable.empty()) add_unavailable_row(plot, moments.size(), request.unavailable);
    set_names(plot, members, moments);
  }
  set_notes(plot, members, moments.size(), asked, came_about);
  plot.stamp = stamp_of(verdict, members);
  return plot;
}

ModelPlot model_plot_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request) {
  ModelPlot plot;
  const std::vector<Member> members = members_of(verdict, request);
  for (const Member& member : members) {
    if (!member.scene) continue;
    const bool named = !member.run->parameters.empty();
    plot.panels.push_back({named ? name_in_row(member) : "", *member.scene});
  }
  if (plot.panels.empty()) plot.notes = {"No run was selected for this figure."};
  plot.stamp = stamp_of(verdict, members);
  return plot;
}

RowChart decomposition_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request) {
  RowChart chart;
  const std::vector<Member> members = members_of(verdict, request);
  Look baseline = look_of_series(5), changed = look_of_series(1);
  baseline.pattern = changed.pattern = Look::Pattern::light;
  chart.series = {{"baseline", baseline}, {"one cause changed", changed}};
  for (const std::string& name : distinct(members, [](const Member& m) { return m.panel; }))
    for (const std::string& metric : request.metrics) {
      chart.panels.push_back(decomposition_panel(in_panel(members, name), verdict, request, metric));
      chart.panels.back().title =
          name.empty() ? capitalised(name_of_metric(metric, verdict.definition)) : name;
    }
  if (chart.panels.empty()) chart.panels.push_back({"No run was selected for this figure.", {}, {}, {}});
  chart.stamp = stamp_of(verdict, members);
  return chart;
}

Picture picture_of(const vv::CaseVerdict& verdict, const vv::FigureRequest& request) {
  if (request.kind == "decomposition") return draw(decomposition_of(verdict, request));
  if (request.kind == "fields") return draw(field_plot_of(verdict, request));
  if (request.kind == "model") return draw(model_plot_of(verdict, request));
  return draw(plot_of(verdict, request));
}

}  // namespace mpm::reports
