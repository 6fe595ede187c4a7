#include "reports/performance_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <tuple>

#include "reports/figures.hpp"
#include "reports/typography.hpp"

namespace mpm::reports {
namespace {

constexpr std::size_t most_bars = 36;  // of a chart that fits a printed page
constexpr double million = 1e6, giga = 1e9;

using Steps = std::vector<const StepRate*>;

std::string words(std::string text) {
  std::replace(text.begin(), text.end(), '_', ' ');
  return escaped(text);
}

std::string law_name(const std::string& law) {
  if (law == "mohr_coulomb") return "Mohr–Coulomb";
  if (law == "neo_hookean") return "neo-Hookean";
  return words(law);
}

std::string precision_name(const std::string& precision) {
  if (precision == "float64") return "double";
  if (precision == "float32") return "float";
  return words(precision);
}

std::string threads_name(int threads) { return fmt::format("{} thread{}", threads, threads == 1 ? "" : "s"); }

/// The look of a scheme; the first three looks are theirs.
std::size_t scheme_look(const std::string& scheme) {
  if (scheme == "mpm") return 0;
  if (scheme == "ugimp") return 1;
  return scheme == "cpgimp" ? 2 : 5;
}

std::string scheme_name(const std::string& scheme) { return name_of_parameter("/scene/scheme", scheme); }

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts)
    if (!part.empty()) text += (text.empty() ? "" : ", ") + part;
  return text;
}

/// Fit for a file's name and for a link.
std::string file_name(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '-'; }, '-');
  return text;
}

/// The configurations of steps, and which of their words are not the same in all.
struct DifferingWords {
  std::vector<std::vector<std::string>> all;
  std::vector<bool> differs;  ///< empty without steps
};

DifferingWords differing_words(const Steps& steps) {
  DifferingWords words;
  for (const StepRate* step : steps) words.all.push_back(configuration(*step));
  for (std::size_t word = 0; !words.all.empty() && word < words.all.front().size(); ++word)
    words.differs.push_back(std::any_of(words.all.begin(), words.all.end(), [&](const auto& each) {
      return each[word] != words.all.front()[word];
    }));
  return words;
}

/// A row a step. Where steps differ in update order, law or precision as well as in other words, those of the
/// same three stand together, below a heading that names them.
template <class MakeBars>
std::vector<Row> rows_under_headings(const Steps& steps, MakeBars bars) {
  const auto [all, differs] = differing_words(steps);
  const auto said = [&, &all = all, &differs = differs](std::size_t i,
                                                        std::initializer_list<std::size_t> words) {
    std::string text;
    for (const std::size_t word : words)
      if (differs[word]) text = joined({text, all[i][word]});
    return text;
  };
  const bool headed = !steps.empty() && (differs[0] || differs[4] || differs[5]);
  std::vector<std::string> headings;
  std::map<std::string, std::vector<Row>> by_heading;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const std::string heading = headed ? said(i, {1, 2, 3}) : "";
    if (by_heading[heading].empty()) headings.push_back(heading);
    by_heading[heading].push_back({headed ? said(i, {0, 4, 5}) : said(i, {1, 2, 3}), bars(i)});
  }
  std::vector<Row> rows;
  for (const std::string& heading : headings) {
    if (!heading.empty()) rows.push_back({fmt::format("<b>{}</b>", heading), {}});
    rows.insert(rows.end(), by_heading[heading].begin(), by_heading[heading].end());
  }
  return rows;
}

std::string stamp_of(const Performance& performance) {
  return escaped(fmt::format("mpmvv · performance · measured at revision {} on {}",
                             performance.full_revision(), performance.date));
}

/// The scenes in the order in which they first appear.
template <class Items, class SceneOf>
std::vector<std::string> scenes_of(const Items& items, SceneOf scene_of) {
  std::vector<std::string> scenes;
  for (const auto& item : items)
    if (std::find(scenes.begin(), scenes.end(), scene_of(item)) == scenes.end())
      scenes.push_back(scene_of(item));
  return scenes;
}

/// For bars that reach up to `largest`, with room for the column of values.
Range bar_range(double largest) { return {0.0, largest > 0.0 ? 1.2 * largest : 1.0}; }

int decimals_for(double largest) { return largest < 10.0 ? 2 : largest < 1000.0 ? 1 : 0; }

RowBar rate_bar(const StepRate& step, std::size_t series) {
  return {series, step.rate.median / million, step.rate.low / million, step.rate.high / million,
          step.target ? *step.target / million : RowBar::none};
}

double largest_in(const std::vector<Row>& rows) {
  double largest = 0.0;
  for (const Row& row : rows)
    for (const RowBar& bar : row.bars)
      for (const double value : {bar.value, bar.high, bar.mark})
        if (std::isfinite(value)) largest = std::max(largest, value);
  return largest;
}

/// A panel of rates whose axis holds every bar, error bar and mark.
RowPanel rate_panel(std::string title, std::vector<Row> rows) {
  RowPanel panel;
  panel.title = std::move(title);
  const double largest = largest_in(rows);
  panel.x = {"million particle-updates per second", Scale::linear, bar_range(largest), {}, false};
  panel.decimals = decimals_for(largest);
  panel.rows = std::move(rows);
  return panel;
}

std::vector<BarSeries> scheme_series() {
  return {{"MPM", look_of_series(0)},
          {"uGIMP", look_of_series(1)},
          {"cpGIMP", look_of_series(2)},
          {"other schemes", look_of_series(5)}};
}

std::size_t scheme_series_of(const StepRate& step) {
  return std::min<std::size_t>(scheme_look(step.scheme), 3);
}

/// Rows in parts of at most `most_bars` bars; a part that begins amid a group repeats its heading.
std::vector<std::vector<Row>> page_by_page(const std::vector<Row>& rows) {
  std::vector<std::vector<Row>> parts;
  std::size_t used = most_bars;
  const Row* heading = nullptr;
  for (const Row& row : rows) {
    if (row.bars.empty()) {
      heading = &row;
      continue;  // set with the first row below it
    }
    const bool opens = heading && &row == heading + 1;
    if (used + row.bars.size() + (opens ? 1 : 0) > most_bars) {
      parts.emplace_back();
      used = 0;
    }
    if (heading && (opens || parts.back().empty())) {
      parts.back().push_back(*heading);
      ++used;
    }
    parts.back().push_back(row);
    used += row.bars.size();
  }
  return parts;
}

/// Rows in as many charts as it takes, all with the same axis. `fill` sets what is said of each.
template <class Fill>
std::vector<PerformanceFigure> in_charts(const std::string& id, const std::string& title,
                                         const std::vector<Row>& rows, const Fill& fill) {
  std::vector<PerformanceFigure> figures;
  const Range range = bar_range(largest_in(rows));
  for (const std::vector<Row>& part : page_by_page(rows)) {
    RowChart chart;
    chart.panels = {rate_panel(title, part)};
    chart.panels.front().x.range = range;
    chart.spread_legend = "smallest to largest repetition";
    PerformanceFigure figure;
    figure.id = file_name(id) + (figures.empty() ? "" : fmt::format("-{}", figures.size() + 1));
    fill(chart, figure.caption);
    if (!figures.empty()) figure.caption += " Continued.";
    figure.content = std::move(chart);
    figures.push_back(std::move(figure));
  }
  return figures;
}

std::string title_of(const std::string& scene, const std::string& common) {
  return joined({words(scene), common});
}

// ---- sizes ----

/// What a panel of the figure of sizes has in common.
using SizePanelKey = std::tuple<std::string, std::string, std::string, std::string>;

SizePanelKey size_panel_key(const StepRate& step) {
  return {step.scene, step.order, step.law, step.precision};
}

std::array<std::string, 4> words_of(const SizePanelKey& key) {
  const auto& [scene, order, law, precision] = key;
  return {words(scene), name_of_parameter("/scene/update_order", order), law_name(law),
          precision_name(precision)};
}

PlotCurve size_curve(Steps steps) {
  std::sort(steps.begin(), steps.end(),
            [](const StepRate* a, const StepRate* b) { return a->particles < b->particles; });
  const StepRate& first = *steps.front();
  PlotCurve curve;
  curve.label = joined({scheme_name(first.scheme), threads_name(first.threads)});
  curve.look = look_of_series(static_cast<int>(scheme_look(first.scheme)));
  curve.look.marker_size = 4.4;
  curve.look.filled = first.threads == 1;
  curve.look.dash = first.threads == 1 ? std::vector<double>{} : std::vector<double>{4.0, 2.5};
  for (const StepRate* step : steps) {
    curve.x.push_back(static_cast<double>(step->particles));
    curve.y.push_back(step->rate.median / million);
  }
  return curve;
}

/// The curves of one panel: those of two sizes at least.
std::vector<PlotCurve> size_curves(const Steps& steps) {
  std::map<std::pair<int, std::size_t>, Steps> by_curve;
  std::vector<std::pair<int, std::size_t>> order;
  for (const StepRate* step : steps) {
    const std::pair key{step->threads, scheme_look(step->scheme)};
    if (by_curve[key].empty()) order.push_back(key);
    by_curve[key].push_back(step);
  }
  std::vector<PlotCurve> curves;
  for (const auto& key : order)
    if (by_curve[key].size() > 1) curves.push_back(size_curve(by_curve[key]));
  return curves;
}

Panel size_panel(std::vector<PlotCurve> curves) {
  double smallest = INFINITY, largest = 0.0, fastest = 0.0;
  for (const PlotCurve& curve : curves) {
    smallest = std::min(smallest, curve.x.front());
    largest = std::max(largest, curve.x.back());
    fastest = std::max(fastest, *std::max_element(curve.y.begin(), curve.y.end()));
  }
  Panel panel;
  panel.x = {"particles", Scale::logarithmic, {smallest / 1.5, largest * 1.5}, {}, false};
  panel.y = {"10<sup>6</sup> particle-updates/s", Scale::linear, {0.0, 1.12 * fastest}, {}, false};
  panel.curves = std::move(curves);
  return panel;
}

/// Sets the titles to what tells the panels apart and gives what they share.
std::string set_titles(std::vector<Panel>& panels, const std::vector<SizePanelKey>& keys) {
  std::vector<std::string> common;
  for (std::size_t part = 0; part < 4; ++part) {
    const std::string first = words_of(keys.front())[part];
    const bool shared = std::all_of(keys.begin(), keys.end(),
                                    [&](const SizePanelKey& key) { return words_of(key)[part] == first; });
    if (shared) common.push_back(first);
    for (std::size_t i = 0; i < keys.size() && !shared; ++i)
      panels[i].title = joined({panels[i].title, words_of(keys[i])[part]});
  }
  return joined(common);
}

// ---- the roofline ----

std::vector<const Limit*> limits_in(const Performance& performance, const std::string& unit) {
  std::vector<const Limit*> limits;
  for (const Limit& limit : performance.limits)
    if (limit.unit == unit) limits.push_back(&limit);
  return limits;
}

double intensity(const StepRate& step) { return *step.flops / *step.bytes; }  // [flop/B]

double arithmetic_rate(const StepRate& step) { return *step.flops * step.rate.median / giga; }  // [Gflop/s]

std::vector<PlotCurve> roofline_points(const Steps& steps) {
  std::vector<PlotCurve> curves;
  for (const StepRate* step : steps) {
    const std::string label = joined({scheme_name(step->scheme), precision_name(step->precision)});
    auto curve =
        std::find_if(curves.begin(), curves.end(), [&](const PlotCurve& c) { return c.label == label; });
    if (curve == curves.end()) {
      Look look = look_of_series(static_cast<int>(scheme_look(step->scheme)));
      look.line_width = 0.0;
      look.marker_size = 5.0;
      look.filled = step->precision != "float32";
      curve = curves.insert(curves.end(), {label, look, {}, {}, 1});
    }
    curve->x.push_back(intensity(*step));
    curve->y.push_back(arithmetic_rate(*step));
  }
  return curves;
}

Look roof_look(std::size_t n) {
  static const std::vector<std::vector<double>> dashes{{}, {6.0, 2.5}, {2.0, 2.0}, {8.0, 2.0, 2.0, 2.0}};
  Look look;
  look.color = muted;
  look.line_width = 1.1;
  look.dash = dashes[n % dashes.size()];
  return look;
}

/// Straight lines up to the peak, and the peak from where the fastest of them meets it; all inside the axes.
std::vector<PlotCurve> roofs(const std::vector<const Limit*>& bandwidths, const Limit& highest,
                             const Panel& panel) {
  std::vector<PlotCurve> curves;
  const double peak = highest.value.median / giga;
  double fastest = 0.0;
  for (const Limit* limit : bandwidths) {
    const double bandwidth = limit->value.median / giga;
    const double left = std::max(panel.x.range.lower, panel.y.range.lower / bandwidth);
    fastest = std::max(fastest, bandwidth);
    curves.push_back({fmt::format("{}, {:.3g} GB/s", escaped(limit->title), bandwidth),
                      roof_look(curves.size() + 1),
                      {left, peak / bandwidth},
                      {left * bandwidth, peak},
                      0});
  }
  curves.push_back({fmt::format("{}, {:.3g} Gflop/s", escaped(highest.title), peak),
                    roof_look(0),
                    {peak / fastest, panel.x.range.upper},
                    {peak, peak},
                    0});
  return curves;
}

// ---- pairs ----

/// Whether two steps agree in all but one word of their configuration.
bool differ_only_in(const StepRate& a, const StepRate& b, std::size_t word) {
  const auto first = configuration(a), second = configuration(b);
  if (a.scene != b.scene || first[word] == second[word]) return false;
  for (std::size_t i = 0; i < first.size(); ++i)
    if (i != word && first[i] != second[i]) return false;
  return true;
}

template <class IsOther, class IsOne>
std::vector<StepPair> pairs(const Performance& performance, std::size_t word, IsOther is_other,
                            IsOne is_one) {
  std::vector<StepPair> found;
  for (const StepRate& other : performance.steps)
    for (const StepRate& one : performance.steps)
      if (is_other(other) && is_one(one) && differ_only_in(one, other, word)) found.push_back({&one, &other});
  return found;
}

std::string scene_and(const std::string& scene, const std::string& rest, bool several_scenes) {
  return joined({several_scenes || rest.empty() ? words(scene) : "", rest});
}

/// Rows of ratios, named by what tells them apart.
std::vector<Row> ratio_rows(const std::vector<StepPair>& pairs, std::optional<std::size_t> compared_word,
                            std::string& common) {
  Steps others;
  for (const StepPair& pair : pairs) others.push_back(pair.other);
  const ConfigurationNames names = configuration_names(others, compared_word);
  const bool several = scenes_of(others, [](const StepRate* s) { return s->scene; }).size() > 1;
  common = several ? names.common : title_of(others.front()->scene, names.common);
  std::vector<Row> rows;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Measured r = ratio(pairs[i].other->rate, pairs[i].one->rate);
    rows.push_back({scene_and(others[i]->scene, names.own[i], several),
                    {{scheme_series_of(*others[i]), r.median, r.low, r.high, RowBar::none}}});
  }
  return rows;
}

/// A panel of ratios with lines at 1 and, if `ideal` is given, there.
RowPanel ratio_panel(const std::string& title, const std::vector<StepPair>& pairs,
                     std::optional<std::size_t> compared_word, std::optional<double> ideal) {
  RowPanel panel;
  std::string common;
  panel.rows = ratio_rows(pairs, compared_word, common);
  panel.title = joined({title, common});
  panel.x = {"ratio of rates",
             Scale::linear,
             bar_range(std::max(largest_in(panel.rows), ideal.value_or(1.0))),
             {},
             false};
  panel.decimals = 2;
  panel.lines = {{1.0, "1: no gain", {muted, 0.9, {2.0, 2.0}}}};
  if (ideal) panel.lines.push_back({*ideal, fmt::format("{:g}: ideal", *ideal), {muted, 1.1, {6.0, 2.5}}});
  return panel;
}

/// How many more threads the pairs have, if all have the same.
std::optional<double> ideal_of(const std::vector<StepPair>& pairs) {
  const int threads = pairs.front().other->threads;
  const bool same = std::all_of(pairs.begin(), pairs.end(),
                                [threads](const StepPair& pair) { return pair.other->threads == threads; });
  return same ? std::optional<double>(threads) : std::nullopt;
}

}  // namespace

std::string grouped_digits(std::int64_t count) {
  std::string digits = std::to_string(count);
  for (auto at = static_cast<int>(digits.size()) - 3; at > (count < 0 ? 1 : 0); at -= 3)
    digits.insert(static_cast<std::size_t>(at), "\u00a0");
  return digits;
}

std::vector<std::string> configuration(const StepRate& step) {
  return {scheme_name(step.scheme),
          name_of_parameter("/scene/update_order", step.order),
          law_name(step.law),
          precision_name(step.precision),
          grouped_digits(step.particles) + (step.particles == 1 ? " particle" : " particles"),
          threads_name(step.threads)};
}

ConfigurationNames configuration_names(const Steps& steps, std::optional<std::size_t> left_out) {
  const auto [all, differs] = differing_words(steps);
  ConfigurationNames names{std::vector<std::string>(steps.size()), ""};
  for (std::size_t word = 0; word < differs.size(); ++word) {
    if (word == left_out) continue;
    if (!differs[word]) names.common = joined({names.common, all.front()[word]});
    for (std::size_t i = 0; i < all.size() && differs[word]; ++i)
      names.own[i] = joined({names.own[i], all[i][word]});
  }
  return names;
}

Measured ratio(const Measured& above, const Measured& below) {
  return {above.median / below.median, above.low / below.high, above.high / below.low};
}

std::vector<StepPair> thread_pairs(const Performance& performance) {
  return pairs(
      performance, threads_word, [](const StepRate& s) { return s.threads > 1; },
      [](const StepRate& s) { return s.threads == 1; });
}

std::vector<StepPair> precision_pairs(const Performance& performance) {
  return pairs(
      performance, precision_word, [](const StepRate& s) { return s.precision == "float32"; },
      [](const StepRate& s) { return s.precision == "float64"; });
}

std::vector<StepPair> common_steps(const Performance& before, const Performance& after) {
  std::vector<StepPair> found;
  for (const StepRate& step : after.steps)
    for (const StepRate& earlier : before.steps)
      if (earlier.name == step.name) found.push_back({&earlier, &step});
  return found;
}

std::vector<PerformanceFigure> rate_figures(const Performance& performance) {
  std::vector<PerformanceFigure> figures;
  for (const std::string& scene : scenes_of(performance.steps, [](const StepRate& s) { return s.scene; })) {
    Steps steps;
    for (const StepRate& step : performance.steps)
      if (step.scene == scene) steps.push_back(&step);
    const ConfigurationNames names = configuration_names(steps);
    const auto bars = [&steps](std::size_t i) {
      return std::vector<RowBar>{rate_bar(*steps[i], scheme_series_of(*steps[i]))};
    };
    const auto charts =
        in_charts("rates-" + scene, title_of(scene, names.common), rows_under_headings(steps, bars),
                  [&](RowChart& chart, std::string& caption) {
                    chart.series = scheme_series();
                    chart.mark_legend = "target";
                    chart.stamp = stamp_of(performance);
                    caption = "Rate of whole steps of the scene " + words(scene) +
                              ", by configuration: median of the repetitions.";
                  });
    figures.insert(figures.end(), charts.begin(), charts.end());
  }
  return figures;
}

std::optional<PerformanceFigure> size_figure(const Performance& performance) {
  std::map<SizePanelKey, Steps> by_panel;
  std::vector<SizePanelKey> keys, drawn;
  for (const StepRate& step : performance.steps) {
    if (by_panel[size_panel_key(step)].empty()) keys.push_back(size_panel_key(step));
    by_panel[size_panel_key(step)].push_back(&step);
  }
  Plot plot;
  for (const SizePanelKey& key : keys) {
    std::vector<PlotCurve> curves = size_curves(by_panel[key]);
    if (curves.empty()) continue;
    plot.panels.push_back(size_panel(std::move(curves)));
    drawn.push_back(key);
  }
  if (drawn.empty()) return std::nullopt;
  const std::string common = set_titles(plot.panels, drawn);
  plot.columns = plot.panels.size() > 1 ? 2 : 1;
  if (plot.columns == 1) plot.width = 340.0;
  plot.stamp = stamp_of(performance);
  return PerformanceFigure{"sizes",
                           "Rate over the number of particles" + (common.empty() ? "" : ": " + common) +
                               ". A rate that falls with size tells of memory that no cache holds; one that "
                               "rises, of costs that do "
                               "not depend on the number of particles.",
                           std::move(plot)};
}

std::optional<PerformanceFigure> roofline_figure(const Performance& performance) {
  const auto bandwidths = limits_in(performance, "B/s"), peaks = limits_in(performance, "flop/s");
  Steps steps;
  for (const StepRate& step : performance.steps)
    if (step.threads == 1 && step.bytes && step.flops) steps.push_back(&step);
  if (steps.empty() || bandwidths.empty() || peaks.empty()) return std::nullopt;
  const Limit& highest = **std::max_element(peaks.begin(), peaks.end(), [](const Limit* a, const Limit* b) {
    return a->value.median < b->value.median;
  });
  const double peak = highest.value.median / giga;
  double slowest = INFINITY, fastest = peak, least = INFINITY, most = 0.0;
  for (const Limit* limit : bandwidths) most = std::max(most, peak / (limit->value.median / giga));
  for (const StepRate* step : steps) {
    slowest = std::min(slowest, arithmetic_rate(*step));
    fastest = std::max(fastest, arithmetic_rate(*step));
    least = std::min(least, intensity(*step));
    most = std::max(most, intensity(*step));
  }
  Panel panel;
  panel.x = {"arithmetic intensity [flop/B]", Scale::logarithmic, {least / 3.0, most * 2.0}, {}, false};
  panel.y = {"arithmetic done [Gflop/s]", Scale::logarithmic, {slowest / 3.0, fastest * 2.0}, {}, false};
  panel.curves = roofs(bandwidths, highest, panel);
  for (PlotCurve& curve : roofline_points(steps)) panel.curves.push_back(std::move(curve));
  Plot plot;
  plot.width = 400.0;
  plot.frame_aspect = 0.72;
  plot.stamp = stamp_of(performance);
  plot.panels = {std::move(panel)};
  return PerformanceFigure{"roofline",
                           "Whole steps on one thread and the measured limits of the machine. Bytes and "
                           "operations a particle-step "
                           "are counted, not measured. A point at a roof is bound by it; one far below all "
                           "of them waits for something "
                           "else. What fits a cache may lie above the line of the memory, and floats above the "
                           "roof of the multiply-adds, which is that of doubles.",
                           std::move(plot)};
}

std::optional<PerformanceFigure> ratio_figure(const Performance& performance) {
  const auto threads = thread_pairs(performance), precisions = precision_pairs(performance);
  if (threads.empty() && precisions.empty()) return std::nullopt;
  RowChart chart;
  if (!threads.empty()) {
    const auto ideal = ideal_of(threads);
    const std::string title = ideal ? threads_name(static_cast<int>(*ideal)) : "several threads";
    chart.panels.push_back(ratio_panel("<b>" + title + " over one</b>", threads,
                                       ideal ? std::optional(threads_word) : std::nullopt, ideal));
  }
  if (!precisions.empty())
    chart.panels.push_back(ratio_panel("<b>float over double</b>", precisions, precision_word, std::nullopt));
  chart.series = scheme_series();
  chart.spread_legend = "from the extremes of both";
  chart.stamp = stamp_of(performance);
  return PerformanceFigure{"ratios", "What more threads and a shorter number format gain.", std::move(chart)};
}

std::vector<PerformanceFigure> history_figures(const Performance& before, const Performance& after) {
  std::vector<PerformanceFigure> figures;
  const std::vector<StepPair> all = common_steps(before, after);
  for (const std::string& scene : scenes_of(all, [](const StepPair& pair) { return pair.other->scene; })) {
    Steps steps, earlier;
    for (const StepPair& pair : all) {
      if (pair.other->scene != scene) continue;
      steps.push_back(pair.other);
      earlier.push_back(pair.one);
    }
    const ConfigurationNames names = configuration_names(steps);
    const auto bars = [&](std::size_t i) {
      std::vector<RowBar> both{rate_bar(*earlier[i], 0), rate_bar(*steps[i], 1)};
      both.front().mark = RowBar::none;  // a target is an aim for what stands today
      return both;
    };
    const auto charts = in_charts(
        "history-" + before.file.stem().string() + "-" + scene, title_of(scene, names.common),
        rows_under_headings(steps, bars), [&](RowChart& chart, std::string& caption) {
          Look look = look_of_series(1);
          chart.series.push_back({"before: revision " + escaped(before.full_revision()), look});
          look.pattern = Look::Pattern::solid;
          chart.series.push_back({"after: revision " + escaped(after.full_revision()), look});
          chart.mark_legend = "target";
          chart.stamp = stamp_of(after);
          caption = fmt::format("Rates of the scene {} at revision {} and at revision {}.", words(scene),
                                escaped(before.full_revision()), escaped(after.full_revision()));
        });
    figures.insert(figures.end(), charts.begin(), charts.end());
  }
  return figures;
}

Picture draw(const PerformanceFigure& figure) {
  return std::visit([](const auto& content) { return draw(content); }, figure.content);
}

}  // namespace mpm::reports
