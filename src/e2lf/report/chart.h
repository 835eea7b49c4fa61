// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace e2lf::report {

/// Charts as SVG elements for a page, 900 wide, with ticks at round numbers and a legend above. Their text has the
/// colour of the text around; margins are as wide as the labels need. What is not finite is left out.

struct Line {
  std::string name;
  struct Point {
    double x = 0, y = 0;
  };
  std::vector<Point> points;
  bool is_filled = false;  ///< between the line and zero
};

/// Stretches of the x axis that are shaded over the whole height, each with a text above it where there is room.
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
  std::optional<size_t> as_line;  ///< in the colour of this line; else grey
};

struct LineChart {
  std::string x_label, y_label;
  std::vector<Line> lines;
  bool is_logarithmic = false;  ///< the y axis; values of 0 and less are left out, nothing is filled
  bool has_signs = true;        ///< else -2 reads 2 along the y axis
  Bands bands = {};
  std::vector<Marks> marks = {};
};

/// Bands and marks do not widen the x axis, which goes over the points; what lies outside is cut off. An x axis without
/// points is that of the bands and marks.
[[nodiscard]] std::string chart_svg(const LineChart& chart);

/// A bar of each series for every group.
struct BarChart {
  std::string y_label;
  bool from_zero = true;  ///< else the axis begins a little below the least value, as suits decibels
  int decimals = 2;       ///< of the values that a pointer over a bar shows
  std::vector<std::string> groups;
  struct Series {
    std::string name;
    std::vector<std::optional<double>> values;  ///< one for each group; nothing: no bar
  };
  std::vector<Series> series;
};

/// Series whose values are not as many as the groups break the contract.
[[nodiscard]] std::string chart_svg(const BarChart& chart);

/// A grid of cells, such as the views of a light field: dark at `low`, bright at `high`.
struct CellGrid {
  size_t columns = 8;
  std::vector<double> values;  ///< row by row
  double low = 0, high = 1;
  int decimals = -1;  ///< of the number in each cell; negative: none is written
  double cell_px = 12;
};

[[nodiscard]] std::string grid_svg(const CellGrid& grid);

/// A chart, as the functions above make it, as a file of its own: black on white, with a margin around.
[[nodiscard]] std::string file_svg(const std::string& svg);

}  // namespace e2lf::report
