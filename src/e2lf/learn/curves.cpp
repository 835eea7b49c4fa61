// SPDX-License-Identifier: MIT
#include "e2lf/learn/curves.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "e2lf/base/text.h"

namespace e2lf::learn {
namespace {

constexpr double kWidth = 900, kHeight = 300, kLeft = 70, kRight = 20, kTop = 14, kBottom = 40;
constexpr const char* kColours[] = {"#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#17becf"};

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  return result;
}

struct Range {
  double low = 0, high = 1;
  [[nodiscard]] double share(double value) const { return (value - low) / std::max(high - low, 1e-12); }
};

Range range_of(const std::vector<Curve>& curves, double Curve::Point::*coordinate) {
  Range range{1e300, -1e300};
  for (const Curve& curve : curves) {
    for (const auto& point : curve.points) {
      range.low = std::min(range.low, point.*coordinate);
      range.high = std::max(range.high, point.*coordinate);
    }
  }
  return range.low <= range.high ? range : Range{};
}

std::string text_at(double x, double y, const char* anchor, const std::string& text) {
  return cat("<text x=\"", x, "\" y=\"", y, "\" text-anchor=\"", anchor, "\">", escaped(text), "</text>\n");
}

double rounded(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(std::max(std::abs(value), 1e-12))) - 2);
  return std::round(value / unit) * unit;
}

/// Lines with axes. `logarithmic`: the points hold log10 of the values. Losses fall and PSNR rises, so names are where
/// the curves are not: above the first, below the second.
std::string chart(const std::vector<Curve>& curves, bool logarithmic) {
  const Range x = range_of(curves, &Curve::Point::samples), y = range_of(curves, &Curve::Point::y);
  const double width = kWidth - kLeft - kRight, height = kHeight - kTop - kBottom;
  const auto page_x = [&](double samples) { return kLeft + width * x.share(samples); };
  const auto page_y = [&](double value) { return kTop + height * (1 - y.share(value)); };
  std::string svg =
      cat("<svg viewBox=\"0 0 ", kWidth, " ", kHeight, "\" font-family=\"sans-serif\" font-size=\"12\">\n");
  constexpr int kTicks = 4;
  for (int tick = 0; tick <= kTicks; ++tick) {
    const double part = static_cast<double>(tick) / kTicks;
    const double value = y.low + part * (y.high - y.low), samples = x.low + part * (x.high - x.low);
    svg += cat("<line x1=\"", kLeft, "\" x2=\"", kWidth - kRight, "\" y1=\"", page_y(value), "\" y2=\"", page_y(value),
               "\" stroke=\"#ddd\"/>\n");
    svg += text_at(kLeft - 6, page_y(value) + 4, "end", cat(rounded(logarithmic ? std::pow(10.0, value) : value)));
    svg += text_at(page_x(samples), kHeight - 22, "middle", cat(std::round(samples)));
  }
  svg += text_at(kLeft + width / 2, kHeight - 4, "middle", "samples");
  const double names = logarithmic ? kTop + 14 : kTop + height + 8 - 16 * static_cast<double>(curves.size());
  for (size_t i = 0; i < curves.size(); ++i) {
    const char* colour = kColours[i % std::size(kColours)];
    svg += cat("<polyline fill=\"none\" stroke=\"", colour, "\" stroke-width=\"1.5\" points=\"");
    for (const auto& point : curves[i].points) svg += cat(page_x(point.samples), ',', page_y(point.y), ' ');
    svg += "\"/>\n";
    svg += cat("<g fill=\"", colour, "\">",
               text_at(kWidth - kRight - 4, names + 16 * static_cast<double>(i), "end", curves[i].name), "</g>\n");
  }
  return svg + "</svg>\n";
}

/// log10 of the values, and of their mean over about a twentieth of the curve.
std::vector<Curve> loss_curves(const Curve& loss) {
  Curve each{loss.name, {}}, mean{"running mean", {}};
  const auto window = std::max<size_t>(1, loss.points.size() / 20);
  double sum = 0;
  for (size_t i = 0; i < loss.points.size(); ++i) {
    const auto& point = loss.points[i];
    sum += point.y - (i >= window ? loss.points[i - window].y : 0.0);
    const auto log10 = [](double value) { return std::log10(std::max(value, 1e-12)); };
    each.points.push_back({point.samples, log10(point.y)});
    mean.points.push_back({point.samples, log10(sum / static_cast<double>(std::min(i + 1, window)))});
  }
  return {std::move(each), std::move(mean)};
}

/// The patterns of one time side by side: open cells white.
std::string pattern_row(const PatternState& state) {
  constexpr size_t kSide = 8, kCells = kSide * kSide;
  constexpr double kCell = 7, kGap = 10;
  const size_t count = state.cells.size() / kCells;
  const double width = static_cast<double>(count) * (kSide * kCell + kGap);
  std::string svg = cat("<svg width=\"", width, "\" height=\"", kSide * kCell, "\">\n");
  for (size_t i = 0; i < count * kCells; ++i) {
    const double x = static_cast<double>(i / kCells) * (kSide * kCell + kGap) + static_cast<double>(i % kSide) * kCell;
    const double y = static_cast<double>(i % kCells / kSide) * kCell;
    const int level = static_cast<int>(std::lround(255 * std::clamp(state.cells[i], 0.0, 1.0)));
    svg += cat("<rect x=\"", x, "\" y=\"", y, "\" width=\"", kCell, "\" height=\"", kCell, "\" fill=\"rgb(", level, ',',
               level, ',', level, ")\" stroke=\"#888\" stroke-width=\"0.3\"/>");
  }
  return svg + "</svg>\n";
}

}  // namespace

std::string curves_page(const std::string& title, const Curve& loss, const std::vector<Curve>& psnr_db,
                        const std::vector<PatternState>& patterns) {
  std::string page = cat("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>", escaped(title),
                         "</title><style>body{font-family:sans-serif;max-width:60em;margin:2em auto;padding:0 1em}"
                         "svg{max-width:100%}td{padding:0.3em 1em 0.3em 0}</style></head><body>\n<h1>",
                         escaped(title), "</h1>\n<h2>Loss of the training samples</h2>\n");
  page += chart(loss_curves(loss), /*logarithmic=*/true);
  if (!psnr_db.empty()) {
    page += cat("<h2>PSNR of the validation scenes, dB</h2>\n", chart(psnr_db, /*logarithmic=*/false));
  }
  if (!patterns.empty()) page += "<h2>Patterns</h2>\n<table>\n";
  constexpr size_t kTimes = 8;
  const size_t shown = std::min(kTimes, patterns.size());
  for (size_t i = 0; i < shown; ++i) {
    const auto& state = patterns[shown == 1 ? 0 : i * (patterns.size() - 1) / (shown - 1)];
    page += cat("<tr><td>", std::round(state.samples), " samples</td><td>", pattern_row(state), "</td></tr>\n");
  }
  if (!patterns.empty()) page += "</table>\n";
  return page + "</body></html>\n";
}

}  // namespace e2lf::learn
