// SPDX-License-Identifier: MIT
#include "e2lf/cli/rate_plot.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/text.h"

namespace e2lf::cli {
namespace {

constexpr double kWidth = 1000, kHeight = 420, kLeft = 80, kRight = 20, kTop = 40, kBottom = 50;

/// A round number at or above x: 1, 2 or 5 times a power of ten.
double round_up(double x) {
  const double power = std::pow(10.0, std::floor(std::log10(std::max(x, 1e-9))));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= x) return factor * power;
  }
  return 10.0 * power;
}

/// A filled curve of one polarity; `sign` is -1 for what grows upwards on the page.
std::string area(const std::vector<uint64_t>& counts, double per_count, double sign, const char* colour) {
  const double base = kTop + (kHeight - kTop - kBottom) / 2;
  const double step = (kWidth - kLeft - kRight) / static_cast<double>(counts.size());
  std::string path = cat("<path fill=\"", colour, "\" d=\"M", kLeft, " ", base);
  for (size_t i = 0; i < counts.size(); ++i) {
    const double y = base + sign * per_count * static_cast<double>(counts[i]);
    path += cat(" L", kLeft + step * static_cast<double>(i), " ", y, " L", kLeft + step * static_cast<double>(i + 1),
                " ", y);
  }
  return path + cat(" L", kWidth - kRight, " ", base, " Z\"/>\n");
}

std::string label(double x, double y, const char* anchor, const std::string& text) {
  return cat("<text x=\"", x, "\" y=\"", y, "\" text-anchor=\"", anchor, "\">", text, "</text>\n");
}

std::string line(double x0, double y0, double x1, double y1) {
  return cat("<line x1=\"", x0, "\" y1=\"", y0, "\" x2=\"", x1, "\" y2=\"", y1,
             "\" stroke=\"#888\" stroke-width=\"0.7\"/>\n");
}

/// Where a time is on the page; nothing when it is outside the plot.
class TimeAxis {
 public:
  explicit TimeAxis(const recordings::EventRate& rate)
      : begin_us_(rate.begin_us), length_us_(static_cast<double>(rate.bin_us) * static_cast<double>(rate.size())) {}

  [[nodiscard]] double x_of(int64_t t_us) const {
    const double share = static_cast<double>(t_us - begin_us_) / length_us_;
    return kLeft + (kWidth - kLeft - kRight) * std::clamp(share, 0.0, 1.0);
  }

 private:
  int64_t begin_us_;
  double length_us_;
};

/// Shades the slices of each cycle; the surer, the darker.
std::string shade_cycles(const std::vector<FoundCycle>& cycles, const TimeAxis& axis) {
  std::string svg;
  double labelled_until = 0;
  for (size_t i = 0; i < std::min(cycles.size(), kMaxDrawn); ++i) {
    const FoundCycle& cycle = cycles[i];
    for (const cycles::TimeSlice& slice : cycle.slices) {
      const double begin = axis.x_of(slice.begin_us), end = axis.x_of(slice.end_us);
      svg +=
          cat("<rect x=\"", begin, "\" y=\"", kTop, "\" width=\"", std::max(end - begin, 0.5), "\" height=\"",
              kHeight - kTop - kBottom, "\" fill=\"#2ca02c\" fill-opacity=\"", 0.1 + 0.15 * cycle.confidence, "\"/>\n");
    }
    const double x = cycle.slices.empty() ? 0 : axis.x_of(cycle.slices.front().begin_us);
    if (x < labelled_until + 70) continue;
    svg += label(x, kTop - 4, "start", cat(cycle.number, ": ", std::round(cycle.confidence * 100) / 100));
    labelled_until = x;
  }
  return svg;
}

/// A tick for each trigger or burst, in the colour of its sign.
std::string draw_marks(const std::vector<cycles::Mark>& marks, const TimeAxis& axis) {
  std::string svg;
  for (size_t i = 0; i < std::min(marks.size(), kMaxDrawn); ++i) {
    const cycles::Mark& mark = marks[i];
    const char* colour = !mark.on_share ? "#888" : *mark.on_share > 0.5F ? "#d62728" : "#1f77b4";
    const double x = axis.x_of(mark.t_us);
    svg += cat("<line x1=\"", x, "\" y1=\"", kHeight - kBottom, "\" x2=\"", x, "\" y2=\"", kHeight - kBottom + 10,
               "\" stroke=\"", colour, "\" stroke-width=\"1.5\" stroke-opacity=\"",
               0.3 + 0.7 * static_cast<double>(mark.confidence), "\"/>\n");
  }
  return svg;
}

}  // namespace

std::string rate_plot_svg(const recordings::EventRate& rate, const FoundCycles& found) {
  std::string svg =
      cat("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 ", kWidth, " ", kHeight,
          "\" font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n");
  svg += label(kLeft, 22, "start",
               cat("event rate, ", static_cast<double>(rate.bin_us) / 1000.0, " ms per bin: ON above, OFF below"));
  if (rate.on.empty()) return svg + label(kWidth / 2, kHeight / 2, "middle", "no events") + "</svg>\n";

  const uint64_t peak =
      std::max(*std::max_element(rate.on.begin(), rate.on.end()), *std::max_element(rate.off.begin(), rate.off.end()));
  const double bin_us = static_cast<double>(rate.bin_us);
  const double top_rate = round_up(static_cast<double>(peak) / bin_us);  // events per us = M events/s
  const double half = (kHeight - kTop - kBottom) / 2;
  const double per_count = half / (top_rate * bin_us);
  const TimeAxis axis(rate);
  svg += shade_cycles(found.cycles, axis);
  svg += area(rate.on, per_count, -1, "#d62728");
  svg += area(rate.off, per_count, 1, "#1f77b4");

  for (const double share : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    const double y = kTop + half - share * half;
    svg += line(kLeft, y, kWidth - kRight, y);
    svg += label(kLeft - 8, y + 4, "end", cat(std::abs(share) * top_rate));
  }
  svg += draw_marks(found.marks, axis);
  svg += label(16, 22, "start", "M/s");
  const double duration_ms = bin_us * static_cast<double>(rate.on.size()) / 1000.0;
  for (int tick = 0; tick <= 5; ++tick) {
    const double x = kLeft + (kWidth - kLeft - kRight) * tick / 5;
    svg += label(x, kHeight - 24, "middle", cat(std::round(duration_ms * tick / 5 * 100) / 100));
  }
  svg += label(kWidth / 2, kHeight - 6, "middle", cat("ms after ", rate.begin_us, " us"));
  return svg + "</svg>\n";
}

}  // namespace e2lf::cli
