#pragma once

#include <string>
#include <vector>

#include "reports/plot.hpp"

namespace mpm::reports {

/// A sample and what it stands for.
struct LegendEntry {
  enum class Kind {
    curve,
    bar,
    band,  ///< a patch in the look's colour
    level,
    tick,    ///< an upright mark across a bar
    whisker  ///< a level error bar
  } kind = Kind::curve;
  std::string label;  ///< markup
  Look look;          ///< of a curve, a bar or a band
  Stroke stroke;      ///< of everything else
  bool bars = false;  ///< whether a curve's sample has an upright error bar
};

using LegendRows = std::vector<std::vector<LegendEntry>>;

/// Adds an entry that has a label, unless one of that label is there already.
void add_entry(std::vector<LegendEntry>& entries, LegendEntry entry);

/// The entries in rows of at most `width` [pt], as many in a row as fit.
LegendRows legend_rows(const std::vector<LegendEntry>& entries, double width);

double legend_height(const LegendRows& rows);  ///< [pt]

/// Draws the rows centred from `top` down; gives the rectangle they cover.
Rectangle draw_legend(Canvas& canvas, const LegendRows& rows, double top);

MarkerStyle marker_of(const Look& look);

/// Fills a bar; hatching and outline are cut at `clip`, which stays the canvas's clip.
void fill_bar(Canvas& canvas, const Rectangle& box, const Look& look, const Rectangle& clip);

/// A level line with a cap at either end.
void draw_whisker(Canvas& canvas, double from, double to, double y, double cap, const Stroke& stroke);

}  // namespace mpm::reports
