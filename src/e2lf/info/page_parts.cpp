// SPDX-License-Identifier: MIT
#include "e2lf/info/page_parts.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "e2lf/base/text.h"
#include "e2lf/lightfield/views.h"

namespace e2lf::info {

Result<void> add_pictures(const std::vector<NamedImage>& images, size_t most_width, report::Page& page) {
  std::vector<report::Picture> pictures;
  for (const auto& [image, caption] : images) {
    const size_t width = std::min(image.width, most_width);
    const size_t height = std::max<size_t>(1, image.height * width / std::max<size_t>(1, image.width));
    const bool is_wide = width < image.width;
    E2LF_ASSIGN_OR_RETURN(
        auto png,
        lightfield::encode_png(lightfield::to_bytes(is_wide ? lightfield::shrink(image, width, height) : image)));
    pictures.push_back({std::move(png), caption});
  }
  page.pictures(pictures);
  return {};
}

namespace {

float bright_count(const capture::EventImages& images) {
  std::vector<int16_t> counts = images.values;
  for (int16_t& count : counts) count = static_cast<int16_t>(std::min(std::abs(int{count}), 32767));
  const auto quantile = counts.begin() + static_cast<ptrdiff_t>((counts.size() - 1) * 99 / 100);
  std::nth_element(counts.begin(), quantile, counts.end());
  return static_cast<float>(std::max<int>(*quantile, 1));
}

std::array<float, 3> colour_of(float value) {
  constexpr float kGrey = 0.92F;
  const float strength = std::min(std::abs(value), 1.0F);
  const float faded = kGrey * (1.0F - strength);
  return value >= 0 ? std::array{kGrey, faded, faded} : std::array{faded, faded, kGrey};
}

}  // namespace

lightfield::Image event_picture(const capture::EventImages& images) {
  const float scale = 1.0F / bright_count(images);
  std::vector<lightfield::Image> pictures;
  for (size_t k = 0; k < images.count; ++k) {
    float* to = pictures.emplace_back(images.width, images.height, 3).pixels.data();
    for (const int16_t count : images.image(k)) {
      to = std::ranges::copy(colour_of(scale * static_cast<float>(count)), to).out;
    }
  }
  return lightfield::side_by_side(pictures);
}

namespace {

enum LineNumber : size_t { kOff, kOn };

/// Returns a line with a step for each bin; `sign` is -1 below the axis.
report::Line steps(const char* name, const recordings::EventRate& rate, const std::vector<uint64_t>& counts,
                   double sign) {
  report::Line line{name, {}, /*is_filled=*/true};
  const double bin_us = static_cast<double>(rate.bin_us);
  for (size_t i = 0; i < counts.size(); ++i) {
    const double per_us = sign * static_cast<double>(counts[i]) / bin_us;  // events per us = M events/s
    line.points.push_back({static_cast<double>(i) * bin_us / 1000.0, per_us});
    line.points.push_back({static_cast<double>(i + 1) * bin_us / 1000.0, per_us});
  }
  return line;
}

double after_ms(const recordings::EventRate& rate, int64_t t_us) {
  return static_cast<double>(t_us - rate.begin_us) / 1000.0;
}

/// The higher the confidence of a cycle, the darker it is shaded.
report::Bands shaded(const std::vector<cycles::Cycle>& found, const recordings::EventRate& rate) {
  report::Bands bands{"cycles: number, confidence", {}};
  for (size_t i = 0; i < std::min(found.size(), kMaxDrawn); ++i) {
    const cycles::Cycle& cycle = found[i];
    const double confidence = static_cast<double>(cycle.confidence);
    std::string text = cat(cycle.number, ": ", report::tick_text(confidence, 2));
    for (const cycles::TimeSlice& slice : cycle.slices) {
      bands.bands.push_back({after_ms(rate, slice.begin_us), after_ms(rate, slice.end_us), 0.1 + 0.15 * confidence,
                             std::exchange(text, {})});
    }
  }
  return bands;
}

/// Returns triggers and bursts, separated by sign.
std::vector<report::Marks> signed_marks(const std::vector<cycles::Mark>& marks, const recordings::EventRate& rate) {
  std::vector<report::Marks> kinds = {{"marks, OFF", {}, kOff}, {"marks, ON", {}, kOn}, {"marks", {}, {}}};
  for (size_t i = 0; i < std::min(marks.size(), kMaxDrawn); ++i) {
    const cycles::Mark& mark = marks[i];
    report::Marks& kind = kinds[!mark.on_share ? 2 : *mark.on_share > 0.5F ? 1 : 0];
    kind.marks.push_back({after_ms(rate, mark.t_us), 0.3 + 0.7 * static_cast<double>(mark.confidence)});
  }
  return kinds;
}

}  // namespace

report::LineChart rate_chart(const recordings::EventRate& rate, const FoundCycles& found) {
  report::LineChart chart;
  const bool is_empty = rate.on.empty();
  chart.x_label = cat("ms after ", rate.begin_us, " us");
  chart.y_label =
      is_empty ? "no events"
               : cat("M events/s in bins of ", static_cast<double>(rate.bin_us) / 1000.0, " ms: ON above, OFF below");
  chart.lines = {steps("OFF", rate, rate.off, -1), steps("ON", rate, rate.on, 1)};
  // The axis begins with the first trigger, which may precede the first event.
  if (!is_empty && !found.marks.empty() && found.marks.front().t_us < rate.begin_us) {
    for (report::Line& line : chart.lines) {
      line.points.insert(line.points.begin(), {after_ms(rate, found.marks.front().t_us), 0.0});
    }
  }
  chart.has_signs = false;
  chart.bands = shaded(found.cycles, rate);
  chart.marks = signed_marks(found.marks, rate);
  return chart;
}

}  // namespace e2lf::info
