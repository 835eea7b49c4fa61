// SPDX-License-Identifier: MIT
#include "e2lf/diagnose/event_images.h"

#include <algorithm>
#include <cstdlib>

#include "e2lf/base/text.h"

namespace e2lf::diagnose {
namespace {

/// Statistics of the counts of one event image.
struct Counts {
  uint64_t on = 0, off = 0;  ///< sums of the counts above and below 0
  size_t beyond = 0;         ///< number of pixels with a count that no change of a pattern causes

  [[nodiscard]] uint64_t all() const { return on + off; }
};

Counts counts_of(std::span<const int16_t> image, size_t cycles) {
  // The largest change is that from light to the dark level, about 40 thresholds of the most sensitive pixels.
  const int most_events = static_cast<int>(100 * cycles);
  Counts counts;
  for (const int count : image) {
    counts.on += static_cast<uint64_t>(std::max(count, 0));
    counts.off += static_cast<uint64_t>(std::max(-count, 0));
    counts.beyond += std::abs(count) >= most_events ? 1 : 0;
  }
  return counts;
}

/// Returns 1 if the change from one pattern to the next only opens cells, -1 if it only closes cells, and 0 otherwise.
int sign_of_change(const capture::Codes& codes, size_t transition) {
  bool opens = false, closes = false;
  for (size_t cell = 0; cell < codes.pattern_size(); ++cell) {
    const float change = codes.pattern(transition + 1)[cell] - codes.pattern(transition)[cell];
    opens |= change > 0;
    closes |= change < 0;
  }
  return opens == closes ? 0 : opens ? 1 : -1;
}

/// Returns the share of the events with the wrong sign in transitions that only open or only close cells; 0 if there
/// are too few.
double wrong_share(const capture::EventImages& images, const capture::Codes& codes) {
  constexpr uint64_t kEnoughEvents = 1000;
  if (codes.num_patterns != images.count + 1) return 0;
  uint64_t wrong = 0, all = 0;
  for (size_t transition = 0; transition < images.count; ++transition) {
    const int sign = sign_of_change(codes, transition);
    if (sign == 0) continue;
    const Counts counts = counts_of(images.image(transition), 1);
    wrong += sign > 0 ? counts.off : counts.on;
    all += counts.all();
  }
  return all < kEnoughEvents ? 0 : static_cast<double>(wrong) / static_cast<double>(all);
}

}  // namespace

Findings check_event_images(const capture::EventImages& images, const capture::Codes* codes, size_t cycles) {
  constexpr double kFewPerPixel = 0.02, kClearlyWrong = 0.8;
  constexpr uint64_t kEnough = 1000;
  Findings findings;
  std::vector<std::string> empty, beyond;
  Counts sum;
  for (size_t transition = 0; transition < images.count; ++transition) {
    const Counts counts = counts_of(images.image(transition), cycles);
    if (counts.all() == 0) empty.push_back(std::to_string(transition));
    if (2 * counts.beyond > images.image_size()) beyond.push_back(std::to_string(transition));
    sum.on += counts.on;
    sum.off += counts.off;
  }
  const auto add = [&](const char* code, Severity severity, std::string message, std::string remedy) {
    findings.push_back({code, severity, std::move(message), std::move(remedy), {{"events", sum.all()}}});
  };
  if (sum.all() == 0) {
    add("events-absent", Severity::kError, "there are no events, so that the result shows nothing of the scene",
        "check the camera and how the events were accumulated");
    return findings;
  }
  if (!empty.empty()) {
    add("event-image-empty", Severity::kWarning,
        cat(empty.size() == 1 ? "event image " : "event images ", join(empty), empty.size() == 1 ? " has" : " have",
            " no events"),
        "check that the display showed the pattern");
  }
  if (static_cast<double>(sum.all()) < kFewPerPixel * static_cast<double>(images.image_size())) {
    add("events-few", Severity::kWarning,
        cat("there are only ", sum.all(), " events on ", images.width, "x", images.height,
            " px, so that the result shows hardly anything of the scene"),
        "use more light, or check the biases of the camera");
  }
  if (!beyond.empty()) {
    add("counts-too-large", Severity::kWarning,
        cat("most pixels of event image", beyond.size() == 1 ? " " : "s ", join(beyond),
            " count 100 events or more per cycle, which no change of a pattern causes"),
        "check that these are counts of events, and that they are not saturated");
  }
  if (codes != nullptr && wrong_share(images, *codes) >= kClearlyWrong) {
    add("polarity-inverted", Severity::kError,
        "the polarity is inverted: patterns that open cells, such as the first one after black, cause OFF events",
        "give `invert-polarity`, or omit it if it was given");
  }
  // The change from black to the first pattern alone only causes ON events.
  if (images.count > 1 && sum.all() >= kEnough && (sum.on == 0 || sum.off == 0)) {
    add("sign-lost", Severity::kError,
        cat("there are ", sum.all(), sum.on == 0 ? " OFF events and no ON" : " ON events and no OFF", " events"),
        "check that the counts are signed");
  }
  return findings;
}

}  // namespace e2lf::diagnose
