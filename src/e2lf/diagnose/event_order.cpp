// SPDX-License-Identifier: MIT
#include "e2lf/diagnose/event_order.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "e2lf/base/median.h"
#include "e2lf/base/text.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/sensor/event_model.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::diagnose {
namespace {

// docs/experiments/findings.md states how often these thresholds are wrong.
constexpr double kClearlyBetter = 0.4;  // ratio of the remaining counts to those without the change
constexpr double kExplained = 0.25;     // and to all counts
constexpr size_t kLeastBlocks = 12;

/// The mean counts of each transition, one entry per block or brightness.
using Means = std::vector<std::vector<float>>;

/// Returns the counts of grey surfaces, from dark to bright. Fails if the patterns or the camera do not permit it.
Result<Means> counts_of_grey(const capture::Codes& codes, capture::SensorProfile camera) {
  constexpr size_t kLevels = 64, kPixels = 512;
  constexpr float kDarkest = 3e-5F, kGain = 4;
  lightfield::LightField surfaces(lightfield::Shape{codes.views_y, codes.views_x, kLevels, kPixels, 1});
  for (size_t row = 0; row * kPixels < surfaces.data().size(); ++row) {
    const float exponent = 1 - static_cast<float>(row % kLevels) / static_cast<float>(kLevels - 1);
    std::ranges::fill(surfaces.data().subspan(row * kPixels, kPixels), std::pow(kDarkest, exponent));
  }
  capture::EventImages events;
  if (camera.is_pixel()) {
    camera.transmission_slope_x.clear();
    camera.transmission_slope_y.clear();
    E2LF_ASSIGN_OR_RETURN(events, sensor::simulate_pixel_events(codes, surfaces, camera, {.gain = kGain}));
  } else {
    E2LF_ASSIGN_OR_RETURN(const auto model, sensor::event_model_from_name(camera.event_model));
    E2LF_ASSIGN_OR_RETURN(events, sensor::simulate_events(
                                      codes, surfaces, {.model = model, .constants = camera.constants, .gain = kGain}));
  }
  Means means(events.count, std::vector<float>(kLevels));
  for (size_t k = 0; k < events.count; ++k) {
    for (size_t level = 0; level < kLevels; ++level) {
      const auto row = events.image(k).subspan(level * kPixels, kPixels);
      means[k][level] = static_cast<float>(std::reduce(row.begin(), row.end(), 0)) / static_cast<float>(kPixels);
    }
  }
  return means;
}

/// Returns the means of the counts per cycle over square blocks.
Means counts_of_blocks(const capture::EventImages& events, size_t cycles) {
  const size_t side = std::clamp<size_t>(std::min(events.height, events.width) / 16, 16, 32);
  const size_t rows = events.height / side, columns = events.width / side;
  Means means(events.count, std::vector<float>(rows * columns));
  for (size_t k = 0; k < events.count; ++k) {
    const auto image = events.image(k);
    for (size_t y = 0; y < rows * side; ++y) {
      for (size_t x = 0; x < columns * side; ++x) {
        means[k][y / side * columns + x / side] += static_cast<float>(image[y * events.width + x]);
      }
    }
    for (float& mean : means[k]) mean /= static_cast<float>(side * side * cycles);
  }
  return means;
}

/// Returns the median over the blocks, which edges with much parallax hardly change, of the distance between their
/// counts and those of the grey surface that fits best.
double distance(const Means& blocks, const Means& grey) {
  constexpr size_t kBetween = 8;  // brightnesses between two simulated ones
  std::vector<float> distances;
  for (size_t block = 0; block < blocks[0].size(); ++block) {
    float least = std::numeric_limits<float>::infinity();
    for (size_t step = 0; step + kBetween < grey[0].size() * kBetween; ++step) {
      const size_t level = step / kBetween;
      const float share = static_cast<float>(step % kBetween) / kBetween;
      float squares = 0;
      for (size_t k = 0; k < blocks.size(); ++k) {
        const float expected = grey[k][level] * (1 - share) + grey[k][level + 1] * share;
        squares += (blocks[k][block] - expected) * (blocks[k][block] - expected);
      }
      least = std::min(least, squares);
    }
    distances.push_back(std::sqrt(least));
  }
  return median(std::move(distances));
}

Means with_change(const Means& means, const EventChange& change) {
  Means result = means;
  for (size_t k = 0; k < change.order.size(); ++k) result[k] = means[change.order[k]];
  if (change.order.empty()) {
    for (std::vector<float>& image : result) {
      for (float& mean : image) mean = -mean;
    }
  }
  return result;
}

}  // namespace

capture::EventImages EventChange::apply(const capture::EventImages& events) const {
  capture::EventImages result = events;
  for (size_t k = 0; k < order.size(); ++k) std::ranges::copy(events.image(order[k]), result.image(k).begin());
  if (order.empty()) {
    for (int16_t& count : result.values) count = capture::saturated(-count);
  }
  return result;
}

std::vector<EventChange> event_changes(size_t transitions) {
  std::vector<size_t> order(transitions);
  std::iota(order.begin(), order.end(), size_t{0});
  std::vector<EventChange> changes = {{"polarity-inverted", "with inverted polarity",
                                       "exchange ON and OFF events, or do not if this was asked for",
                                       "invert_polarity"}};
  const auto add = [&](const std::vector<size_t>& changed) {
    std::vector<std::string> numbers;
    for (const size_t number : changed) numbers.push_back(std::to_string(number));
    changes.push_back({"order-better-changed", cat("with the event images in the order ", join(numbers)),
                       "check the order of the patterns, as stated and on the display, and the first pattern", "codes",
                       changed});
  };
  for (size_t shift = 1; shift < transitions; ++shift) {
    std::vector<size_t> rotated = order;
    std::rotate(rotated.begin(), rotated.begin() + static_cast<std::ptrdiff_t>(shift), rotated.end());
    add(rotated);
  }
  for (size_t i = 0; i + 1 < transitions && transitions > 2; ++i) {
    std::vector<size_t> swapped = order;
    std::swap(swapped[i], swapped[i + 1]);
    add(swapped);
  }
  if (transitions > 3) add({order.rbegin(), order.rend()});
  return changes;
}

std::optional<Finding> check_order(const capture::EventImages& events, size_t cycles,
                                   const capture::RecordedSetup& setup) {
  if (!setup.codes || !setup.camera || setup.codes->num_patterns != events.count + 1) return std::nullopt;
  const Means blocks = counts_of_blocks(events, cycles);
  const auto grey = counts_of_grey(*setup.codes, *setup.camera);
  if (!grey || blocks[0].size() < kLeastBlocks) return std::nullopt;
  std::vector<float> lengths;
  for (size_t block = 0; block < blocks[0].size(); ++block) {
    float squares = 0;
    for (const std::vector<float>& image : blocks) squares += image[block] * image[block];
    lengths.push_back(std::sqrt(squares));
  }
  const double all = median(std::move(lengths));
  const double unchanged = distance(blocks, *grey);
  const std::vector<EventChange> changes = event_changes(events.count);
  const EventChange* best = nullptr;
  double least = std::min(kClearlyBetter * unchanged, kExplained * all);
  for (const EventChange& change : changes) {
    const double changed = distance(with_change(blocks, change), *grey);
    if (changed >= least) continue;
    best = &change;
    least = changed;
  }
  if (best == nullptr) return std::nullopt;
  const auto percent = [&](double remaining) { return std::round(100 * remaining / all); };
  return Finding{best->code,
                 Severity::kError,
                 cat("the counts differ from those of any grey surface by ", percent(unchanged), " %, and ", best->name,
                     " by ", percent(least), " %"),
                 best->remedy,
                 {{"mismatch", unchanged / all}, {"mismatch_changed", least / all}, {"change", best->name}},
                 best->option};
}

}  // namespace e2lf::diagnose
