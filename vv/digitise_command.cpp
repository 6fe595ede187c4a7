#include "vv/digitise_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>

#include "vv/curve_file.hpp"
#include "vv/digitised_curve.hpp"
#include "vv/digitiser.hpp"
#include "vv/json_reader.hpp"
#include "vv/record.hpp"
#include "vv/revision.hpp"

namespace mpm::vv {
namespace {

namespace fs = std::filesystem;

constexpr const char* about =
    "Read curves off a picture of a figure (PNG) into curve files.\n"
    "Pixels are counted as image viewers do: right and down from 0,0, the upper left one. Example:\n"
    "  mpmvv digitise fig3.png --x 'settlement mm' --x-point 112,640=0 --x-point 530,640=25\n"
    "    --y 'pressure kPa' --y-point 112,640=0 --y-point 112,80=15\n"
    "    --series 'test=#d62728:markers' --citation Kiriyama15 --place 'Figure 3' --preview seen.png";

DigitiseError wrong(const std::string& option, const std::string& expected, const std::string& found) {
  return DigitiseError(fmt::format("{}: expected {}, found \"{}\"", option, expected, found));
}

// ---- what the options say ----

/// The groups of a pattern that the whole text must match.
std::smatch parts_of(const std::string& text, const char* pattern, const std::string& option,
                     const std::string& expected) {
  std::smatch parts;
  if (!std::regex_match(text, parts, std::regex(pattern))) throw wrong(option, expected, text);
  return parts;
}

double number_of(const std::string& text, const std::string& option) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    throw wrong(option, "a number", text);
  return value;
}

AxisPoint point_of(const std::string& text, const std::string& option) {
  const auto parts =
      parts_of(text, "([^,=]+),([^,=]+)=([^,=]+)", option, "a pixel and its value such as 112,640=0");
  return {{number_of(parts[1], option), number_of(parts[2], option)}, number_of(parts[3], option)};
}

/// An axis of the figure and the unit it is measured in.
struct NamedAxis {
  PictureAxis axis;
  std::string unit;
};

NamedAxis axis_of(const std::string& text, const std::vector<std::string>& points,
                  const std::string& option) {
  const auto parts = parts_of(text, "([A-Za-z]\\w*) +(\\S+)(?: +(linear|log))?", option,
                              "name, unit and perhaps linear or log, such as \"settlement mm linear\"");
  if (dimension_of_unit(parts[2]).empty())
    throw wrong(option, "a unit such as mm, kPa, kN/m^3, deg, or 1 for a ratio", parts[2]);
  if (points.size() != 2)
    throw DigitiseError(
        fmt::format("{0}-point: expected two points of the axis, such as {0}-point 112,640=0, found {1}",
                    option, points.size()));
  const AxisScale scale = parts[3] == "log" ? AxisScale::logarithmic : AxisScale::linear;
  return {{parts[1], scale, {point_of(points[0], option + "-point"), point_of(points[1], option + "-point")}},
          parts[2]};
}

SeriesRequest series_of(const std::string& text) {
  const auto parts =
      parts_of(text, "([A-Za-z]\\w*)=#([0-9a-fA-F]{6})(?::(line|markers|joined-markers))?", "--series",
               "a name, a colour and perhaps line, markers or joined-markers, such as test=#d62728:markers");
  const unsigned long colour = std::stoul(parts[2], nullptr, 16);
  const auto channel = [colour](int shift) { return static_cast<std::uint8_t>(colour >> shift & 0xff); };
  const Drawing drawing = parts[3] == "markers"          ? Drawing::markers
                          : parts[3] == "joined-markers" ? Drawing::joined_markers
                                                         : Drawing::line;
  return {parts[1], {channel(16), channel(8), channel(0)}, drawing};
}

PixelBox box_of(const std::string& text, const std::string& option) {
  const auto parts = parts_of(text, "(\\d{1,6}),(\\d{1,6}),(\\d{1,6}),(\\d{1,6})", option,
                              "left,top,right,bottom in pixels");
  const PixelBox box{std::stoi(parts[1]), std::stoi(parts[2]), std::stoi(parts[3]), std::stoi(parts[4])};
  if (box.left >= box.right || box.top >= box.bottom)
    throw wrong(option, "left < right and top < bottom", text);
  return box;
}

// ---- files ----

std::string text_in(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The curve file that is there already, nothing when there is none. Throws when it is no curve file, or has
/// numbers and may not be replaced.
std::optional<Json> slot_at(const fs::path& file, bool may_replace) {
  if (!fs::exists(file)) return std::nullopt;
  const CurveFile curve = read_curve_file(file);
  if (!curve.missing && !may_replace)
    throw DigitiseError(
        fmt::format("{}: has numbers already, and is replaced only with --force", file.string()));
  return Json::parse(text_in(file));
}

/// A series on its way into a file.
struct Target {
  fs::path file;
  std::optional<Json> slot;
};

}  // namespace

struct DigitiseCommand::Options {
  std::string picture, x, y, area, out = ".", abscissa, citation, place, doi, preview;
  std::vector<std::string> x_points, y_points, series, holes;
  double click_uncertainty = 0.5, tolerance = 0.15, gap = 0.0;
  int points = 100;
  bool force = false;

  std::vector<Target> targets(const std::vector<SeriesRequest>& wanted) const;
  std::string abscissa_name(const std::vector<Target>& targets, const std::string& otherwise) const;
  void write(const std::vector<std::string>& texts, const std::vector<Target>& targets) const;
};

std::vector<Target> DigitiseCommand::Options::targets(const std::vector<SeriesRequest>& wanted) const {
  const bool one_file = fs::path(out).extension() == ".json";
  if (one_file && wanted.size() > 1) throw wrong("--out", "a directory for more than one series", out);
  std::vector<Target> targets;
  for (const SeriesRequest& each : wanted) {
    const fs::path file = one_file ? fs::path(out) : fs::path(out) / (each.name + ".json");
    for (const Target& other : targets)
      if (other.file == file) throw wrong("--series", "each name once", each.name);
    targets.push_back({file, slot_at(file, force)});
    if (!targets.back().slot && (citation.empty() || place.empty()))
      throw DigitiseError(file.string() +
                          ": is not there yet; say whose curve it is with --citation and --place");
  }
  return targets;
}

std::string DigitiseCommand::Options::abscissa_name(const std::vector<Target>& targets,
                                                    const std::string& otherwise) const {
  std::string name = abscissa;
  for (const Target& target : targets) {
    if (!target.slot || !target.slot->contains("abscissa")) continue;
    const std::string asked = target.slot->at("abscissa");
    if (!name.empty() && name != asked)
      throw DigitiseError(fmt::format("{}: its abscissa is {}, not {}", target.file.string(), asked, name));
    name = asked;
  }
  return name.empty() ? otherwise : name;
}

void DigitiseCommand::Options::write(const std::vector<std::string>& texts,
                                     const std::vector<Target>& targets) const {
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (targets[i].file.has_parent_path()) fs::create_directories(targets[i].file.parent_path());
    write_atomically(targets[i].file, texts[i]);
  }
}

DigitiseCommand::DigitiseCommand(CLI::App& program)
    : options_(std::make_unique<Options>()), command_(program.add_subcommand("digitise", about)) {
  Options& o = *options_;
  const auto each = [&](const char* name, std::vector<std::string>& values, const char* text) {
    return command_->add_option(name, values, text)->allow_extra_args(false);
  };
  command_->add_option("picture", o.picture, "The figure, a PNG")->required();
  command_->add_option("--x", o.x, "Name, unit and scale (linear or log) of the horizontal axis")->required();
  command_->add_option("--y", o.y, "The same of the upright axis")->required();
  each("--x-point", o.x_points, "A pixel on the horizontal axis and its value: X,Y=VALUE; twice, far apart")
      ->required();
  each("--y-point", o.y_points, "The same of the upright axis")->required();
  each("--series", o.series,
       "NAME=#rrggbb, then :line (default), :markers, or :joined-markers for a line through them")
      ->required();
  command_->add_option("--area", o.area, "Look only here: LEFT,TOP,RIGHT,BOTTOM in pixels");
  each("--except", o.holes, "Do not look here: a legend, a label; the same form, as often as needed");
  command_->add_option("--abscissa", o.abscissa,
                       "Name of the axis that the curve is a function of (default: that of --x)");
  command_->add_option("--out", o.out,
                       "Directory for NAME.json of each series, or the file of the only one (default: here)");
  command_->add_option("--citation", o.citation, "Key of the source in reference/bibliography.md");
  command_->add_option("--place", o.place, "Where in the source, such as \"Figure 3\"");
  command_->add_option("--doi", o.doi, "DOI of the source");
  command_->add_option("--preview", o.preview, "Write a picture (PNG) that shows what was read");
  command_->add_option("--points", o.points, "Points of a line, at most (default: 100)")
      ->check(CLI::Range(2, 100000));
  command_
      ->add_option("--click-uncertainty", o.click_uncertainty,
                   "Of the axes' points, standard, in pixels (default: 0.5)")
      ->check(CLI::Range(0.01, 100.0));
  command_
      ->add_option("--tolerance", o.tolerance,
                   "Of a colour, a share of its difference from the paper (default: 0.15)")
      ->check(CLI::Range(0.01, 1.0));
  command_->add_option("--gap", o.gap, "Longest interruption of a line, in pixels")
      ->check(CLI::Range(1.0, 1e6));
  command_->add_flag("--force", o.force, "Replace numbers that are there already");
}

DigitiseCommand::~DigitiseCommand() = default;

bool DigitiseCommand::parsed() const { return command_->parsed(); }

void DigitiseCommand::run() const {
  const Options& o = *options_;
  const NamedAxis x = axis_of(o.x, o.x_points, "--x"), y = axis_of(o.y, o.y_points, "--y");
  DigitiseRequest request{x.axis, y.axis, {}, {}, {}, o.click_uncertainty, o.tolerance, {}, o.points};
  for (const std::string& text : o.series) request.series.push_back(series_of(text));
  if (!o.area.empty()) request.area = box_of(o.area, "--area");
  for (const std::string& text : o.holes) request.holes.push_back(box_of(text, "--except"));
  if (o.gap > 0.0) request.longest_gap = o.gap;

  const std::vector<Target> targets = o.targets(request.series);
  const std::string abscissa = o.abscissa_name(targets, x.axis.name);
  if (x.axis.name == y.axis.name) throw wrong("--y", "another name than that of --x", y.axis.name);
  if (abscissa != x.axis.name && abscissa != y.axis.name)
    throw wrong("--abscissa", x.axis.name + " or " + y.axis.name, abscissa);
  const bool upright = abscissa == y.axis.name;
  if (upright) std::swap(request.abscissa, request.ordinate);

  const RasterImage image = read_png(o.picture);
  const std::vector<DigitisedSeries> series = digitise(image, request);

  CurveLabels labels{
      "", upright ? y.unit : x.unit, upright ? x.unit : y.unit, x.axis.name, o.citation, o.doi, o.place, "",
      ""};
  labels.picture = fmt::format("{} ({} x {} px, hash {})", fs::path(o.picture).filename().string(),
                               image.width, image.height, hash_of(text_in(o.picture)));
  labels.program = fmt::format("mpmvv {} ({})", build_facts().version, build_facts().revision);
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < series.size(); ++i) {
    labels.id = targets[i].file.stem().string();
    texts.push_back(curve_text(series[i], request, labels, targets[i].slot));
    parse_curve_file(texts.back(), targets[i].file);  // what is written can be read
  }
  if (!o.preview.empty()) write_atomically(o.preview, png_of(preview_of(image, request, series)));
  o.write(texts, targets);
  for (std::size_t i = 0; i < series.size(); ++i) {
    const AxisPair& u = series[i].uncertainty;
    fmt::print(
        "{}: {} points, {} ± {}, {} ± {}: {}\n", series[i].name, series[i].points.size(),
        request.abscissa.name, uncertainty_text(u.abscissa, request.abscissa.scale, labels.abscissa_unit),
        request.ordinate.name, uncertainty_text(u.ordinate, request.ordinate.scale, labels.ordinate_unit),
        targets[i].file.string());
  }
  if (!o.preview.empty()) fmt::print("{}: every cross should lie on its curve\n", o.preview);
  std::fflush(stdout);
}

}  // namespace mpm::vv
