// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace e2lf::report {

/// Charts as SVG elements for a page, 900 px wide, with ticks at round numbers and a legend above. Their text has the
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
  bool is_logarithmic = false;  ///< the y axis; values of 0 and less are omitted, nothing is filled
  bool has_signs = true;        ///< if false, -2 is labelled 2 along the y axis
  Bands bands = {};
  std::vector<Marks> marks = {};
};

/// Draws a line chart. The x axis covers the points; bands and marks do not extend it and are clipped to it. If there
/// are no points, it covers the bands and marks.
[[nodiscard]] std::string chart_svg(const LineChart& chart);

/// A chart with one bar per series for every group.
struct BarChart {
  std::string y_label;
  bool from_zero = true;  ///< if false, the axis begins slightly below the smallest value, as suits decibels
  int decimals = 2;       ///< decimals of the values shown when the pointer is over a bar
  std::vector<std::string> groups;
  struct Series {
    std::string name;
    std::vector<std::optional<double>> values;  ///< one per group; no bar is drawn for an absent value
  };
  std::vector<Series> series;
};

/// Draws a bar chart. If the number of values of a series differs from the number of groups, the contract is broken.
[[nodiscard]] std::string chart_svg(const BarChart& chart);

/// A grid of cells, such as the views of a light field, from dark at `low` to bright at `high`.
struct CellGrid {
  size_t columns = 8;
  std::vector<double> values;  ///< row by row; the rows must be complete
  double low = 0, high = 1;
  int decimals = -1;  ///< decimals of the number in each cell; negative: no number is written
  double cell_px = 12;
};

[[nodiscard]] std::string grid_svg(const CellGrid& grid);

/// Turns a chart made by the functions above into an SVG file of its own, black on white with a margin.
[[nodiscard]] std::string file_svg(const std::string& svg);

}  // namespace e2lf::report
