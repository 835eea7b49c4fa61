// SPDX-License-Identifier: MIT
#include "e2lf/capture/measurement/plausible_events.h"

#include <algorithm>
#include <cstdlib>

#include "e2lf/base/text.h"

namespace e2lf::capture {
namespace {

/// Statistics of the counts of one event image.
struct Counts {
  uint64_t on = 0, off = 0;  ///< sums of the counts above and below 0
  size_t beyond = 0;         ///< number of pixels with a count that no change of a pattern causes

  [[nodiscard]] uint64_t all() const { return on + off; }
};

Counts counts_of(std::span<const int16_t> image) {
  // The largest change is that from light to the dark level, about 40 thresholds of the most sensitive pixels.
  constexpr int kMostEvents = 100;
  Counts counts;
  for (const int count : image) {
    counts.on += static_cast<uint64_t>(std::max(count, 0));
    counts.off += static_cast<uint64_t>(std::max(-count, 0));
    counts.beyond += std::abs(count) >= kMostEvents ? 1 : 0;
  }
  return counts;
}

/// Returns 1 if the change from one pattern to the next only opens cells, -1 if it only closes cells, and 0 otherwise.
int sign_of_change(const Codes& codes, size_t transition) {
  bool opens = false, closes = false;
  for (size_t cell = 0; cell < codes.pattern_size(); ++cell) {
    const float change = codes.pattern(transition + 1)[cell] - codes.pattern(transition)[cell];
    opens |= change > 0;
    closes |= change < 0;
  }
  return opens == closes ? 0 : opens ? 1 : -1;
}

}  // namespace

bool is_without_events(const EventImages& images) {
  return std::all_of(images.values.begin(), images.values.end(), [](int16_t count) { return count == 0; });
}

bool is_polarity_inverted(const EventImages& images, const Codes& codes) {
  constexpr uint64_t kEnoughEvents = 1000;
  if (codes.num_patterns != images.count + 1) return false;
  uint64_t right = 0, wrong = 0;
  for (size_t transition = 0; transition < images.count; ++transition) {
    const int sign = sign_of_change(codes, transition);
    if (sign == 0) continue;
    const Counts counts = counts_of(images.image(transition));
    right += sign > 0 ? counts.on : counts.off;
    wrong += sign > 0 ? counts.off : counts.on;
  }
  const uint64_t all = right + wrong;
  return all >= kEnoughEvents && static_cast<double>(wrong) >= kClearlyWrong * static_cast<double>(all);
}

std::vector<std::string> event_doubts(const EventImages& images, const Codes* codes) {
  constexpr double kFewPerPixel = 0.02;
  constexpr uint64_t kEnough = 1000;
  std::vector<std::string> doubts, empty, beyond;
  Counts sum;
  for (size_t transition = 0; transition < images.count; ++transition) {
    const Counts counts = counts_of(images.image(transition));
    if (counts.all() == 0) empty.push_back(std::to_string(transition));
    if (2 * counts.beyond > images.image_size()) beyond.push_back(std::to_string(transition));
    sum.on += counts.on;
    sum.off += counts.off;
  }
  if (sum.all() == 0) return {"there are no events: the result contains no information about the scene"};
  if (!empty.empty()) {
    doubts.push_back(cat(empty.size() == 1 ? "event image " : "event images ", join(empty),
                         empty.size() == 1 ? " holds" : " hold", " no events: was the pattern shown?"));
  }
  if (static_cast<double>(sum.all()) < kFewPerPixel * static_cast<double>(images.image_size())) {
    doubts.push_back(cat("there are only ", sum.all(), " events on ", images.width, "x", images.height,
                         " px: the result contains hardly any information about the scene"));
  }
  if (!beyond.empty()) {
    doubts.push_back(cat("most pixels of event image", beyond.size() == 1 ? " " : "s ", join(beyond),
                         " count 100 events or more, which no change of a pattern causes: are these counts of events, "
                         "or are they saturated?"));
  }
  if (codes != nullptr && is_polarity_inverted(images, *codes)) {
    doubts.emplace_back(
        "the polarity is inverted: patterns that open cells, such as the first one after black, cause OFF events; give "
        "--invert-polarity, or leave it out if it was given");
  }
  // The change from black to the first pattern alone only causes ON events.
  if (images.count > 1 && sum.all() >= kEnough && (sum.on == 0 || sum.off == 0)) {
    doubts.push_back(cat("there are ", sum.all(), sum.on == 0 ? " OFF events and no ON" : " ON events and no OFF",
                         " events: was the sign lost, as in unsigned numbers?"));
  }
  return doubts;
}

}  // namespace e2lf::capture
