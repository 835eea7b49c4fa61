// SPDX-License-Identifier: MIT
#include "e2lf/diagnose/event_images.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>

#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/recon/inversion.h"

namespace e2lf::diagnose {
namespace {

constexpr size_t kNoiseRadius = 1, kDetailRadius = 8;              // px
constexpr float kLargestDisparity = 2.5F, kDisparityStep = 0.25F;  // px per view step

constexpr size_t kMostSideOfParallax = 512;  // px
/// Of more patterns, two are hardly ever exchanged by mistake, and the time grows with the cube of their number.
constexpr size_t kMostExchanged = 8;
// docs/experiments/findings.md states how often these thresholds are wrong.
constexpr double kMismatchRatio = 0.97;  // below it, other places are right
constexpr double kConfirmed = 1.003;     // above it, the stated ones are

struct PatternPlace {
  double y = 0, x = 0;  ///< the centre of light of a pattern, in view steps from the middle
};
using Images = std::vector<std::vector<float>>;

/// Returns the centres of light of the patterns after black; nothing if one of them is black as well.
std::vector<PatternPlace> places_of(const capture::Codes& codes) {
  const recon::PlacedImages placed = recon::place_images(capture::CodedIntensities(codes.num_patterns, 1, 1), codes);
  std::vector<PatternPlace> places;
  for (size_t n = 0; n < placed.images.size(); ++n) {
    if (placed.patterns[n] != n + 1) return {};
    places.push_back({placed.images[n].view_y, placed.images[n].view_x});
  }
  return places.size() + 1 == codes.num_patterns ? places : std::vector<PatternPlace>();
}

std::vector<float> box_means(const std::vector<float>& image, size_t height, size_t width, size_t radius) {
  std::vector<float> means = recon::box_sums(image, height, width, radius);
  const auto area = static_cast<float>((2 * radius + 1) * (2 * radius + 1));
  for (float& value : means) value /= area;
  return means;
}

/// Returns the details of the log intensities after each transition: less noise, and without the mean around.
Images details_of(const capture::EventImages& events, float on_per_off) {
  Images details;
  std::vector<float> level(events.image_size());
  for (size_t k = 0; k < events.count; ++k) {
    for (size_t i = 0; i < level.size(); ++i) {
      const float count = events.image(k)[i];
      level[i] += count > 0 ? count : on_per_off * count;
    }
    details.push_back(box_means(level, events.height, events.width, kNoiseRadius));
    const std::vector<float> mean = box_means(details.back(), events.height, events.width, kDetailRadius);
    for (size_t i = 0; i < mean.size(); ++i) details.back()[i] -= mean[i];
  }
  return details;
}

/// Displaces the images so far that they show different things.
Images unrelated(const Images& images, size_t height, size_t width) {
  Images displaced = images;
  for (size_t n = 0; n < images.size(); ++n) {
    const size_t dy = n * height / (images.size() + 1), dx = n * width / images.size();
    for (size_t i = 0; i < images[n].size(); ++i) {
      displaced[n][i] = images[n][(i / width + dy) % height * width + (i % width + dx) % width];
    }
  }
  return displaced;
}

/// Returns the radius of the windows that are compared, in px. A large window averages noise, but a small image has too
/// few of them.
size_t window_radius(size_t height, size_t width) {
  return std::clamp<size_t>(std::min(height, width) / 24, 5, 16);
}

/// Adds the values and the squares of an image that is displaced by (by_y, by_x) px, and whose border is repeated.
void add_displaced(const std::vector<float>& image, size_t height, size_t width, float by_y, float by_x,
                   std::vector<float>& sum, std::vector<float>& squares) {
  const auto whole = static_cast<ptrdiff_t>(std::floor(by_x)), border = std::abs(whole) + 1;
  const float share = by_x - static_cast<float>(whole);
  // A row with its repeated border: all pixels have their neighbours at the same distance.
  std::vector<float> row(width + 2 * static_cast<size_t>(border));
  float* const inner = row.data() + border;
  for (size_t y = 0; y < height; ++y) {
    const float at = std::clamp(static_cast<float>(y) + by_y, 0.0F, static_cast<float>(height - 1));
    const auto first = static_cast<size_t>(at);
    const float below = at - static_cast<float>(first);
    const float* const upper = image.data() + first * width;
    const float* const lower = image.data() + std::min(first + 1, height - 1) * width;
    for (size_t x = 0; x < width; ++x) inner[x] = upper[x] * (1 - below) + lower[x] * below;
    std::fill_n(row.data(), border, inner[0]);
    std::fill_n(inner + width, border, inner[width - 1]);
    float *const sums = sum.data() + y * width, *const of_squares = squares.data() + y * width;
    for (size_t x = 0; x < width; ++x) {
      const float* const left = inner + static_cast<ptrdiff_t>(x) + whole;
      const float value = left[0] * (1 - share) + left[1] * share;
      sums[x] += value;
      of_squares[x] += value * value;
    }
  }
}

/// Returns the mean over the pixels of the variance between the images at the disparity that fits best.
double mismatch(const Images& images, const std::vector<PatternPlace>& places, size_t height, size_t width) {
  const size_t size = height * width, radius = window_radius(height, width);
  std::vector<float> least(size, std::numeric_limits<float>::infinity()), sum(size), squares(size);
  for (float disparity = -kLargestDisparity; disparity <= kLargestDisparity; disparity += kDisparityStep) {
    std::ranges::fill(sum, 0.0F);
    std::ranges::fill(squares, 0.0F);
    for (size_t n = 0; n < images.size(); ++n) {
      add_displaced(images[n], height, width, disparity * static_cast<float>(places[n].y),
                    disparity * static_cast<float>(places[n].x), sum, squares);
    }
    const auto count = static_cast<float>(images.size());
    for (size_t i = 0; i < size; ++i) squares[i] = squares[i] / count - sum[i] * sum[i] / (count * count);
    const std::vector<float> around = recon::box_sums(squares, height, width, radius);
    for (size_t i = 0; i < size; ++i) least[i] = std::min(least[i], around[i]);
  }
  return std::accumulate(least.begin(), least.end(), 0.0) / static_cast<double>(size);
}

/// Candidates for the true places, of which the first are the stated ones.
struct Candidate {
  OtherPlaces other;
  std::vector<PatternPlace> places;
};

std::vector<Candidate> candidates_for(const std::vector<PatternPlace>& stated) {
  std::vector<Candidate> candidates = {{{}, stated}};
  for (size_t n = 0; n < stated.size() && stated.size() <= kMostExchanged; ++n) {
    for (size_t other = n + 1; other < stated.size(); ++other) {
      std::vector<PatternPlace> places = stated;
      std::swap(places[n], places[other]);
      candidates.push_back({{cat("with the patterns a", n + 2, " and a", other + 2, " exchanged"), true,
                             "check the order of the patterns, as stated and on the display", 1},
                            places});
    }
  }
  for (const OtherOrientation& other : kOtherOrientations) {
    Candidate& candidate = candidates.emplace_back(Candidate{{other.name, false, other.remedy, 1}, stated});
    for (PatternPlace& place : candidate.places) {
      place = {other.y_of_y * place.y + other.y_of_x * place.x, other.x_of_y * place.y + other.x_of_x * place.x};
    }
  }
  return candidates;
}

}  // namespace

capture::EventImages middle_of(const capture::EventImages& events, size_t most_height, size_t most_width) {
  const size_t height = std::min(events.height, most_height), width = std::min(events.width, most_width);
  const size_t top = (events.height - height) / 2, left = (events.width - width) / 2;
  capture::EventImages middle(events.count, height, width);
  for (size_t row = 0; row < events.count * height; ++row) {
    const size_t y = row / height * events.height + top + row % height;
    std::copy_n(events.values.begin() + static_cast<ptrdiff_t>(y * events.width + left), width,
                middle.values.begin() + static_cast<ptrdiff_t>(row * width));
  }
  return middle;
}

std::vector<OtherPlaces> compare_places(const capture::EventImages& events, const capture::Codes& codes,
                                        float on_per_off) {
  constexpr size_t kLeastPatterns = 3;  // two centres of light define only a direction
  if (codes.num_patterns != events.count + 1) return {};
  const std::vector<PatternPlace> stated = places_of(codes);
  if (stated.size() < kLeastPatterns) return {};
  const Images images = details_of(events, on_per_off);
  const Images others = unrelated(images, events.height, events.width);
  std::vector<Candidate> candidates = candidates_for(stated);
  parallel_for(candidates.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end && !stop_requested(); ++i) {
      const std::vector<PatternPlace>& places = candidates[i].places;
      const double by_chance = mismatch(others, places, events.height, events.width);
      candidates[i].other.mismatch =
          by_chance > 0 ? mismatch(images, places, events.height, events.width) / by_chance : 1;
    }
  });
  if (stop_requested()) return {};
  std::vector<OtherPlaces> result;
  for (size_t i = 1; i < candidates.size(); ++i) {
    result.push_back(candidates[i].other);
    result.back().mismatch /= std::max(candidates[0].other.mismatch, 1e-9);
  }
  return result;
}

namespace {

/// Returns the patterns as they lie in upright views. A half turn only changes the sign of all disparities.
capture::Codes in_upright_views(capture::Codes codes, const capture::Orientation& views) {
  if (views.flip_x == views.flip_y) return codes;
  for (size_t n = 0; n < codes.num_patterns; ++n) {
    for (size_t row = 0; row < codes.views_y; ++row) {
      std::ranges::reverse(codes.pattern(n).subspan(row * codes.views_x, codes.views_x));
    }
  }
  return codes;
}

}  // namespace

std::optional<Finding> check_places(const capture::EventImages& events, const capture::Codes& codes,
                                    const std::optional<capture::SensorProfile>& camera,
                                    const std::optional<capture::Orientation>& views) {
  using enum capture::PixelConstant;
  const bool is_pixel = camera && camera->is_pixel();
  const float on_per_off = is_pixel ? camera->pixel[kThresholdOff] / camera->pixel[kThresholdOn] : 1.0F;
  const std::vector<OtherPlaces> places =
      compare_places(middle_of(events, kMostSideOfParallax, kMostSideOfParallax),
                     in_upright_views(codes, views.value_or(capture::Orientation{})), on_per_off);
  const auto best = std::ranges::min_element(places, {}, &OtherPlaces::mismatch);
  if (best == places.end() || best->mismatch > kConfirmed) return std::nullopt;
  if (best->mismatch >= kMismatchRatio) {
    return Finding{"patterns-undecided",
                   Severity::kNote,
                   "the parallax between the event images does not tell in which order and orientation the patterns "
                   "were shown",
                   "use more light or a scene with depth, or sum more cycles of a still scene",
                   {{"mismatch", best->mismatch}, {"change", best->name}}};
  }
  const double percent = std::round(1000 * (1 - best->mismatch)) / 10;
  return Finding{best->is_order ? "order-better-changed" : "orientation-better-changed",
                 Severity::kError,
                 cat("the parallax between the event images agrees ", percent, " % better ", best->name),
                 best->remedy,
                 {{"mismatch", best->mismatch}, {"change", best->name}},
                 best->is_order ? "codes" : ""};
}

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

}  // namespace

Findings check_event_images(const capture::EventImages& images, size_t cycles) {
  constexpr double kFewPerPixel = 0.02;
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
  if (static_cast<double>(sum.all()) < kFewPerPixel * static_cast<double>(cycles * images.image_size())) {
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
  // The change from black to the first pattern alone only causes ON events.
  if (images.count > 1 && sum.all() >= kEnough && (sum.on == 0 || sum.off == 0)) {
    add("sign-lost", Severity::kError,
        cat("there are ", sum.all(), sum.on == 0 ? " OFF events and no ON" : " ON events and no OFF", " events"),
        "check that the counts are signed");
  }
  return findings;
}

}  // namespace e2lf::diagnose
