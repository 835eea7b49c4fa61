// SPDX-License-Identifier: MIT
#include "e2lf/report/chart.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "e2lf/base/contract.h"
#include "e2lf/base/text.h"
#include "e2lf/report/axis.h"
#include "e2lf/report/markup.h"

namespace e2lf::report {
namespace {

constexpr double kWidth = 900, kPlotHeight = 260, kRight = 30, kFont = 13, kLegendRow = 20;
constexpr size_t kMostTicks = 8;
constexpr const char* kColours[] = {"#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#888888"};

const char* colour_of(size_t series) {
  return kColours[series % std::size(kColours)];
}

/// No sans-serif letter of the usual fonts is wider on average.
double text_width(const std::string& text) {
  return 0.62 * kFont * static_cast<double>(num_characters(text));
}

double widest(const std::vector<std::string>& texts) {
  double width = 0;
  for (const std::string& text : texts) width = std::max(width, text_width(text));
  return width;
}

std::string label(double x, double y, const char* anchor, const std::string& text, const std::string& more = "") {
  return cat("<text x=\"", x, "\" y=\"", y, "\" text-anchor=\"", anchor, "\"", more, ">", escaped(text), "</text>\n");
}

std::string svg_begin(double width, double height) {
  return cat("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"", width, "\" height=\"", height, "\" viewBox=\"0 0 ",
             width, " ", height, "\" font-family=\"sans-serif\" font-size=\"", kFont, "\" fill=\"currentColor\">\n");
}

/// Names with their colours in as many rows as they need.
struct Legend {
  std::string svg;
  double height = 0;

  explicit Legend(const std::vector<std::string>& names) {
    constexpr double kMark = 12, kSpace = 18;
    double x = 0;
    if (!names.empty()) height = kLegendRow;
    for (size_t i = 0; i < names.size(); ++i) {
      const double width = kMark + 5 + text_width(names[i]) + kSpace;
      if (x > 0 && x + width > kWidth) {
        x = 0;
        height += kLegendRow;
      }
      svg += cat("<rect x=\"", x, "\" y=\"", height - kMark - 3, "\" width=\"", kMark, "\" height=\"", kMark,
                 "\" fill=\"", colour_of(i), "\"/>\n");
      svg += label(x + kMark + 5, height - 4, "start", names[i]);
      x += width;
    }
  }
};

struct Range {
  double low = INFINITY, high = -INFINITY;
  void add(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// A range for an axis also where there is no value or a single one.
  [[nodiscard]] Range open() const {
    if (low > high) return {0, 1};
    if (low < high) return *this;
    const double room = std::max(std::abs(low), 1.0) / 2;
    return {low - room, high + room};
  }
};

/// The y axis: its range ends at ticks.
struct VerticalAxis {
  Ticks ticks;
  Axis axis;
  std::vector<std::string> texts;

  VerticalAxis(const Range& range, double top) {
    const Ticks inner = round_ticks(range.low, range.high, kMostTicks - 2);
    axis.low = std::floor(range.low / inner.step + 1e-9) * inner.step;
    axis.high = std::ceil(range.high / inner.step - 1e-9) * inner.step;
    ticks = round_ticks(axis.low, axis.high, kMostTicks);
    axis.page_low = top + kPlotHeight;
    axis.page_high = top;
    for (const double value : ticks.values) texts.push_back(tick_text(value, ticks.decimals));
  }

  [[nodiscard]] std::string svg(double left, const std::string& name) const {
    std::string text = label(0, axis.page_high - 10, "start", name);
    for (size_t i = 0; i < ticks.values.size(); ++i) {
      const double y = axis.at(ticks.values[i]);
      text += cat("<line x1=\"", left, "\" x2=\"", kWidth - kRight, "\" y1=\"", y, "\" y2=\"", y,
                  "\" stroke=\"currentColor\" stroke-opacity=\"0.2\"/>\n");
      text += label(left - 6, y + 4, "end", texts[i]);
    }
    return text;
  }
};

/// Where the names of groups stand: level where they fit side by side, else tilted.
struct GroupNames {
  bool is_tilted = false;
  double height = 24, left = 0;
  static constexpr double kTilt = 0.6;  ///< radians

  GroupNames(const std::vector<std::string>& names, double tick_margin) : left(tick_margin) {
    const double longest = widest(names), count = static_cast<double>(std::max<size_t>(names.size(), 1));
    is_tilted = longest + 8 > (kWidth - kRight - tick_margin) / count;
    if (!is_tilted) return;
    height = longest * std::sin(kTilt) + 2 * kFont;
    // A tilted name ends below the middle of its group and begins to the left of that.
    left = std::max(tick_margin, longest * std::cos(kTilt) + 4);
  }

  [[nodiscard]] std::string svg(double x, double y, const std::string& name) const {
    if (!is_tilted) return label(x, y + 18, "middle", name);
    return label(x, y + 14, "end", name, cat(" transform=\"rotate(-", kTilt * 180 / M_PI, " ", x, " ", y + 14, ")\""));
  }
};

Range bar_range(const BarChart& chart) {
  Range range;
  for (const auto& series : chart.series) {
    for (const auto& value : series.values) range.add(value.value_or(NAN));
  }
  if (range.low > range.high) return range.open();
  if (chart.from_zero) {
    range.add(0);
  } else {
    range.low -= std::max(range.high - range.low, 0.1 * std::abs(range.high)) / 4;
  }
  return range.open();
}

std::string bar(double x, double width, double base, double y, size_t series, const std::string& about) {
  return cat("<rect x=\"", x, "\" y=\"", std::min(y, base), "\" width=\"", width, "\" height=\"", std::abs(base - y),
             "\" fill=\"", colour_of(series), "\"><title>", escaped(about), "</title></rect>\n");
}

template <typename Named>
std::vector<std::string> names_of(const std::vector<Named>& list) {
  std::vector<std::string> names;
  for (const Named& named : list) names.push_back(named.name);
  return names;
}

}  // namespace

std::string chart_svg(const LineChart& chart) {
  Range x_range, y_range;
  for (const Line& line : chart.lines) {
    for (const auto& point : line.points) {
      if (!std::isfinite(point.x) || !std::isfinite(point.y)) continue;
      x_range.add(point.x);
      y_range.add(point.y);
    }
  }
  const Legend legend(names_of(chart.lines));
  const VerticalAxis y(y_range.open(), legend.height + 30);
  const double left = widest(y.texts) + 12, bottom = y.axis.page_low;
  const Range open = x_range.open();
  const Axis x{open.low, open.high, left, kWidth - kRight};
  std::string svg = svg_begin(kWidth, bottom + 48) + legend.svg + y.svg(left, chart.y_label);
  const Ticks ticks = round_ticks(open.low, open.high, kMostTicks);
  for (const double value : ticks.values) {
    svg += label(x.at(value), bottom + 18, "middle", tick_text(value, ticks.decimals));
  }
  svg += label((left + kWidth - kRight) / 2, bottom + 38, "middle", chart.x_label);
  for (size_t i = 0; i < chart.lines.size(); ++i) {
    svg += cat("<polyline fill=\"none\" stroke=\"", colour_of(i), "\" stroke-width=\"1.8\" points=\"");
    for (const auto& point : chart.lines[i].points) {
      if (std::isfinite(point.x) && std::isfinite(point.y)) svg += cat(x.at(point.x), ',', y.axis.at(point.y), ' ');
    }
    svg += "\"/>\n";
  }
  return svg + "</svg>\n";
}

std::string chart_svg(const BarChart& chart) {
  for (const auto& series : chart.series) {
    E2LF_REQUIRE(series.values.size() == chart.groups.size(), "a series of bars needs a value for each group");
  }
  const Legend legend(names_of(chart.series));
  const VerticalAxis y(bar_range(chart), legend.height + 30);
  const GroupNames names(chart.groups, widest(y.texts) + 12);
  const double bottom = y.axis.page_low;
  const double base = y.axis.at(std::clamp(0.0, y.axis.low, y.axis.high));
  const double group_width =
      (kWidth - kRight - names.left) / static_cast<double>(std::max<size_t>(chart.groups.size(), 1));
  const double bar_width = 0.8 * group_width / static_cast<double>(std::max<size_t>(chart.series.size(), 1));
  std::string svg = svg_begin(kWidth, bottom + names.height) + legend.svg + y.svg(names.left, chart.y_label);
  for (size_t group = 0; group < chart.groups.size(); ++group) {
    const double begin = names.left + group_width * static_cast<double>(group);
    for (size_t i = 0; i < chart.series.size(); ++i) {
      const auto& value = chart.series[i].values[group];
      if (!value || !std::isfinite(*value)) continue;
      const std::string about =
          cat(chart.groups[group], ", ", chart.series[i].name, ": ", tick_text(*value, chart.decimals));
      svg += bar(begin + 0.1 * group_width + bar_width * static_cast<double>(i), bar_width, base, y.axis.at(*value), i,
                 about);
    }
    svg += names.svg(begin + group_width / 2, bottom, chart.groups[group]);
  }
  return svg + "</svg>\n";
}

std::string grid_svg(const CellGrid& grid) {
  E2LF_REQUIRE(grid.columns > 0 && grid.values.size() % grid.columns == 0, "a grid needs whole rows");
  const double rows = static_cast<double>(grid.values.size() / grid.columns);
  std::string svg = svg_begin(static_cast<double>(grid.columns) * grid.cell_px, rows * grid.cell_px);
  for (size_t i = 0; i < grid.values.size(); ++i) {
    const double x = static_cast<double>(i % grid.columns) * grid.cell_px;
    const double y = static_cast<double>(i / grid.columns) * grid.cell_px;
    const double share = (grid.values[i] - grid.low) / std::max(grid.high - grid.low, 1e-12);
    const auto level = std::isfinite(share) ? std::lround(255 * std::clamp(share, 0.0, 1.0)) : 255L;
    svg += cat("<rect x=\"", x, "\" y=\"", y, "\" width=\"", grid.cell_px, "\" height=\"", grid.cell_px,
               "\" fill=\"rgb(", level, ',', level, ',', level, ")\" stroke=\"#888\" stroke-width=\"0.4\"/>\n");
    if (grid.decimals < 0 || !std::isfinite(grid.values[i])) continue;
    svg += label(x + grid.cell_px / 2, y + grid.cell_px / 2 + 4, "middle", tick_text(grid.values[i], grid.decimals),
                 level < 128 ? " fill=\"#fff\"" : " fill=\"#000\"");
  }
  return svg + "</svg>\n";
}

}  // namespace e2lf::report
