// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace e2lf::report {

/// Round numbers along an axis: multiples of `step`, which is 1, 2 or 5 times a power of ten.
struct Ticks {
  double step = 1;
  int decimals = 0;  ///< number of decimals that the values need
  std::vector<double> values;
};

/// Returns the finest ticks of which at most `most` (>= 2) lie in [low, high], ends included. The contract is broken
/// unless both are finite and `low` is less than `high`.
[[nodiscard]] Ticks round_ticks(double low, double high, size_t most);

/// Formats a value as "28.50". Zero never gets a minus sign.
[[nodiscard]] std::string tick_text(double value, int decimals);

/// Maps [low, high] linearly to [page_low, page_high], either of which may be descending.
struct Axis {
  double low = 0, high = 1, page_low = 0, page_high = 1;
  [[nodiscard]] double at(double value) const {
    return page_low + (page_high - page_low) * (value - low) / (high - low);
  }
};

/// Charts as SVG elements for a page, 1200 px wide, with ticks at round numbers and a legend above. Their text has the
/// colour of the surrounding text, and the margins are as wide as the labels need. Values that are not finite are
/// omitted.

struct Line {
  std::string name;
  struct Point {
    double x = 0, y = 0;
  };
  std::vector<Point> points;
  bool is_filled = false;  ///< fills the area between the line and zero
};

/// Intervals of the x axis that are shaded over the whole height. Each has a text above it if there is room.
struct Bands {
  std::string name;
  struct Band {
    double begin = 0, end = 0, opacity = 0.3;
    std::string text;
  };
  std::vector<Band> bands;
};

/// Ticks below the x axis.
struct Marks {
  std::string name;
  struct Mark {
    double x = 0, opacity = 1;
  };
  std::vector<Mark> marks;
  std::optional<size_t> as_line;  ///< the line whose colour the marks take; grey if absent
};

struct LineChart {
  std::string x_label, y_label;
  std::vector<Line> lines;
  bool has_signs = true;  ///< if false, -2 is labelled 2 along the y axis
  Bands bands = {};
  std::vector<Marks> marks = {};
};

/// Draws a line chart. The x axis covers the points; bands and marks do not extend it and are clipped to it. If there
/// are no points, it covers the bands and marks.
[[nodiscard]] std::string chart_svg(const LineChart& chart);

/// Draws a grid of cells, such as the views of an aperture, from 0 (black) to 1 (white). `values` are given row by row;
/// rows that are not complete break the contract.
[[nodiscard]] std::string grid_svg(const std::vector<double>& values, size_t columns);

/// Returns true for the SVG of chart_svg().
[[nodiscard]] bool is_chart(std::string_view svg);

/// Turns a chart made by the functions above into an SVG file of its own with a margin, which fills the width of a
/// browser in the colours of the viewer: dark on white, or light on dark according to the system of the reader.
[[nodiscard]] std::string file_svg(const std::string& svg);

}  // namespace e2lf::report
