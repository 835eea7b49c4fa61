// SPDX-License-Identifier: MIT
#include "e2lf/report/chart.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/report/page.h"

namespace e2lf::report {

Ticks round_ticks(double low, double high, size_t most) {
  E2LF_REQUIRE(std::isfinite(low) && std::isfinite(high) && low < high && most >= 2, "an axis needs a range");
  // A step of a tenth of this gives more than `most` ticks in any case.
  int exponent = static_cast<int>(std::floor(std::log10((high - low) / static_cast<double>(most)))) - 1;
  for (;; ++exponent) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      Ticks ticks;
      ticks.step = factor * std::pow(10.0, exponent);
      // A multiple that is outside by a billionth of a step counts as inside, because decimal steps are not exact as
      // doubles.
      const double first = std::ceil(low / ticks.step - 1e-9), last = std::floor(high / ticks.step + 1e-9);
      if (last - first + 1 > static_cast<double>(most)) continue;
      ticks.decimals = std::max(-exponent, 0);
      for (double i = first; i <= last; ++i) ticks.values.push_back(i * ticks.step);
      return ticks;
    }
  }
}

std::string tick_text(double value, int decimals) {
  std::string text = formatted("%.*f", decimals, value);
  if (text.find_first_not_of("-0.") == std::string::npos && text.starts_with('-')) text.erase(0, 1);
  return text;
}

namespace {

constexpr double kWidth = 1200, kPlotHeight = 320, kRight = 30, kFont = 13, kLegendRow = 20;
constexpr size_t kMostTicks = 8;
constexpr const char* kColours[] = {"#3f77d0", "#d8523a", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#997700"};
constexpr const char* kBandColour = "#228833";

const char* colour_of(size_t series) {
  return kColours[series % std::size(kColours)];
}

/// Estimates the width of a text. The average letter of the usual sans-serif fonts is no wider than this.
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

/// On a narrow page, such as that of a phone, a chart shrinks to this width and then scrolls sideways.
constexpr double kLeastWidth = 820;

std::string svg_begin(double width, double height) {
  return cat("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"", width, "\" height=\"", height, "\" viewBox=\"0 0 ",
             width, " ", height, "\" style=\"min-width:", std::min(width, kLeastWidth),
             "px\" font-family=\"sans-serif\" font-size=\"", kFont, "\" fill=\"currentColor\">\n");
}

struct LegendEntry {
  std::string name;
  const char* colour;
};

/// Lists names with their colours in as many rows as they need. Entries without a name are skipped.
struct Legend {
  std::string svg;
  double height = 0;

  explicit Legend(const std::vector<LegendEntry>& entries) {
    constexpr double kMark = 12, kSpace = 18;
    double x = 0;
    for (const LegendEntry& entry : entries) {
      if (entry.name.empty()) continue;
      height = std::max(height, kLegendRow);
      const double width = kMark + 5 + text_width(entry.name) + kSpace;
      if (x > 0 && x + width > kWidth) {
        x = 0;
        height += kLegendRow;
      }
      svg += cat("<rect x=\"", x, "\" y=\"", height - kMark - 3, "\" width=\"", kMark, "\" height=\"", kMark,
                 "\" fill=\"", entry.colour, "\"/>\n");
      svg += label(x + kMark + 5, height - 4, "start", entry.name);
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
  /// Returns a range that suits an axis even if there is no value or a single one.
  [[nodiscard]] Range open() const {
    if (low > high) return {0, 1};
    if (low < high) return *this;
    const double room = std::max(std::abs(low), 1.0) / 2;
    return {low - room, high + room};
  }
};

/// The y axis, whose range ends at ticks.
struct VerticalAxis {
  std::vector<double> places;
  Axis axis;
  std::vector<std::string> texts;

  VerticalAxis(const Range& range, double top, bool has_signs) {
    const Ticks inner = round_ticks(range.low, range.high, kMostTicks - 2);
    axis.low = std::floor(range.low / inner.step + 1e-9) * inner.step;
    axis.high = std::ceil(range.high / inner.step - 1e-9) * inner.step;
    const Ticks ticks = round_ticks(axis.low, axis.high, kMostTicks);
    places = ticks.values;
    axis.page_low = top + kPlotHeight;
    axis.page_high = top;
    for (const double value : places) {
      texts.push_back(tick_text(has_signs ? value : std::abs(value), ticks.decimals));
    }
  }

  [[nodiscard]] std::string svg(double left, double right, const std::string& name) const {
    std::string text = label(0, axis.page_high - 10, "start", name);
    for (size_t i = 0; i < places.size(); ++i) {
      const double y = axis.at(places[i]);
      text += cat("<line x1=\"", left, "\" x2=\"", right, "\" y1=\"", y, "\" y2=\"", y,
                  "\" stroke=\"currentColor\" stroke-opacity=\"0.2\"/>\n");
      text += label(left - 6, y + 4, "end", texts[i]);
    }
    return text;
  }
};

/// The x axis of a line chart, with room for half of its last number.
struct HorizontalAxis {
  Ticks ticks;
  Axis axis;

  HorizontalAxis(const Range& range, double left) : ticks(round_ticks(range.low, range.high, kMostTicks)) {
    const double last = text_width(tick_text(ticks.values.back(), ticks.decimals));
    axis = {range.low, range.high, left, kWidth - std::max(kRight, last / 2 + 2)};
  }

  [[nodiscard]] double clamped_at(double value) const { return axis.at(std::clamp(value, axis.low, axis.high)); }

  [[nodiscard]] std::string svg(double bottom, const std::string& name) const {
    std::string text;
    for (const double value : ticks.values) {
      text += label(axis.at(value), bottom + 18, "middle", tick_text(value, ticks.decimals));
    }
    return text + label((axis.page_low + axis.page_high) / 2, bottom + 38, "middle", name);
  }
};

const char* colour_of(const Marks& marks) {
  return marks.as_line ? colour_of(*marks.as_line) : "#888888";
}

std::vector<LegendEntry> entries_of(const LineChart& chart) {
  std::vector<LegendEntry> entries;
  for (const Line& line : chart.lines) entries.push_back({line.name, colour_of(entries.size())});
  if (!chart.bands.bands.empty()) entries.push_back({chart.bands.name, kBandColour});
  for (const Marks& marks : chart.marks) {
    if (!marks.marks.empty()) entries.push_back({marks.name, colour_of(marks)});
  }
  return entries;
}

std::pair<Range, Range> ranges_of(const LineChart& chart) {
  Range x, y;
  for (const Line& line : chart.lines) {
    for (const auto& point : line.points) {
      if (!std::isfinite(point.x) || !std::isfinite(point.y)) continue;
      x.add(point.x);
      y.add(point.y);
    }
    if (line.is_filled) y.add(0);
  }
  if (x.low > x.high) {
    for (const auto& band : chart.bands.bands) {
      x.add(band.begin);
      x.add(band.end);
    }
    for (const Marks& marks : chart.marks) {
      for (const auto& mark : marks.marks) x.add(mark.x);
    }
  }
  return {x, y};
}

std::string bands_svg(const Bands& bands, const HorizontalAxis& x, double top, double bottom) {
  std::string svg;
  constexpr double kGap = 1;  // separates a band from the next one
  double text_end = x.axis.page_low;
  for (const auto& band : bands.bands) {
    const double begin = x.clamped_at(band.begin), end = x.clamped_at(band.end);
    svg += cat("<rect x=\"", begin, "\" y=\"", top, "\" width=\"", std::max(end - begin - kGap, 0.5), "\" height=\"",
               bottom - top, "\" fill=\"", kBandColour, "\" fill-opacity=\"", band.opacity, "\"/>\n");
    const double width = text_width(band.text);
    if (band.text.empty() || begin < text_end || begin + width > kWidth) continue;
    svg += label(begin, top + 12, "start", band.text);
    text_end = begin + width + 8;
  }
  return svg;
}

std::string marks_svg(const Marks& marks, const HorizontalAxis& x, double bottom) {
  std::string svg;
  for (const auto& mark : marks.marks) {
    if (mark.x < x.axis.low || mark.x > x.axis.high) continue;
    const double at = x.axis.at(mark.x);
    svg += cat("<line x1=\"", at, "\" y1=\"", bottom - 7, "\" x2=\"", at, "\" y2=\"", bottom, "\" stroke=\"",
               colour_of(marks), "\" stroke-width=\"1.5\" stroke-opacity=\"", mark.opacity, "\"/>\n");
  }
  return svg;
}

std::string line_svg(const Line& line, const char* colour, bool is_filled, const std::vector<Line::Point>& on_page,
                     double base) {
  std::string points;
  if (is_filled && !on_page.empty()) points += cat(on_page.front().x, ',', base, ' ');
  for (const auto& point : on_page) points += cat(point.x, ',', point.y, ' ');
  if (is_filled && !on_page.empty()) points += cat(on_page.back().x, ',', base);
  const std::string look = is_filled ? cat("fill=\"", colour, "\" stroke=\"none\"")
                                     : cat("fill=\"none\" stroke=\"", colour, "\" stroke-width=\"1.8\"");
  return cat("<polyline ", look, " points=\"", points, "\"><title>", escaped(line.name), "</title></polyline>\n");
}

}  // namespace

std::string chart_svg(const LineChart& chart) {
  const auto [x_range, y_range] = ranges_of(chart);
  const Legend legend(entries_of(chart));
  const double top = legend.height + 30;
  const VerticalAxis y(y_range.open(), top, chart.has_signs);
  const HorizontalAxis x(x_range.open(), widest(y.texts) + 12);
  const bool has_marks = std::ranges::any_of(chart.marks, [](const Marks& marks) { return !marks.marks.empty(); });
  const double bottom = y.axis.page_low + (has_marks ? 9 : 0);
  std::string svg = svg_begin(kWidth, bottom + 48) + legend.svg;
  svg += bands_svg(chart.bands, x, top, y.axis.page_low);
  svg += y.svg(x.axis.page_low, x.axis.page_high, chart.y_label) + x.svg(bottom, chart.x_label);
  for (size_t i = 0; i < chart.lines.size(); ++i) {
    const Line& line = chart.lines[i];
    std::vector<Line::Point> on_page;
    for (const auto& point : line.points) {
      if (std::isfinite(point.x) && std::isfinite(point.y)) on_page.push_back({x.axis.at(point.x), y.axis.at(point.y)});
    }
    svg += line_svg(line, colour_of(i), line.is_filled, on_page, y.axis.at(0));
  }
  for (const Marks& marks : chart.marks) svg += marks_svg(marks, x, bottom);
  return svg + "</svg>\n";
}

std::string grid_svg(const std::vector<double>& values, size_t columns) {
  constexpr size_t kCellPx = 8;
  E2LF_REQUIRE(columns > 0 && values.size() % columns == 0, "a grid needs whole rows");
  std::string svg =
      svg_begin(static_cast<double>(columns * kCellPx), static_cast<double>(values.size() / columns * kCellPx));
  for (size_t i = 0; i < values.size(); ++i) {
    const auto level = std::lround(255 * std::clamp(values[i], 0.0, 1.0));
    svg += cat("<rect x=\"", i % columns * kCellPx, "\" y=\"", i / columns * kCellPx, "\" width=\"", kCellPx,
               "\" height=\"", kCellPx, "\" fill=\"rgb(", level, ',', level, ',', level,
               ")\" stroke=\"#888\" stroke-width=\"0.4\"/>\n");
  }
  return svg + "</svg>\n";
}

bool is_chart(std::string_view svg) {
  const std::string begin = svg_begin(kWidth, 0);
  return svg.starts_with(std::string_view(begin).substr(0, begin.find(" height=")));
}

std::string file_svg(const std::string& svg) {
  constexpr double kMargin = 14;  // in a page, the page provides the margin
  double width = 0, height = 0;
  const size_t size = svg.find(" width=");
  const bool has_size =
      size < svg.find('>') && std::sscanf(svg.c_str() + size, " width=\"%lf\" height=\"%lf\"", &width, &height) == 2;
  E2LF_REQUIRE(has_size, "a file is made of a chart of this header");
  width += 2 * kMargin;
  height += 2 * kMargin;
  // Programs without style sheets read the attributes.
  return cat("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100%\" viewBox=\"", -kMargin, ' ', -kMargin, ' ', width,
             ' ', height,
             "\" color=\"#16191d\">\n<style>@media(prefers-color-scheme:dark){svg{color:#e8eaed;background:#171a1f}",
             "#ground{fill:#171a1f}}</style>\n<rect id=\"ground\" x=\"", -kMargin, "\" y=\"", -kMargin, "\" width=\"",
             width, "\" height=\"", height, "\" fill=\"white\"/>\n", svg, "</svg>\n");
}

}  // namespace e2lf::report
