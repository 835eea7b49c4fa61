// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <vector>

#include "e2lf/base/choice.h"

namespace e2lf::live {
using Clock = std::chrono::steady_clock;

enum class PictureSize {
  kFull,     ///< a pixel of the light field for each pixel of the sensor
  kHalf,     ///< one for each block of 2x2: see sum_blocks()
  kQuarter,  ///< one for each block of 4x4
};
/// The words for the sizes; auto leaves the size to the pace.
inline constexpr Choice<std::optional<PictureSize>> kPictureSizes[] = {
    {"auto", {}}, {"full", PictureSize::kFull}, {"half", PictureSize::kHalf}, {"quarter", PictureSize::kQuarter}};
[[nodiscard]] constexpr const char* size_name(PictureSize size) {
  return word_of(std::optional(size), kPictureSizes);
}
/// Returns the number of pixels along the side of a block: 1, 2 or 4.
[[nodiscard]] constexpr size_t block_side(PictureSize size) {
  return size_t{1} << static_cast<size_t>(size);
}

/// The network and the resolution with which light fields are reconstructed.
struct QualityLevel {
  size_t network = 0;  ///< number of the FieldMaker
  PictureSize size = PictureSize::kFull;
  bool operator==(const QualityLevel&) const = default;
};

/// Decides which cycles are dropped because they are late. A live source shows the newest cycle: while the reading lags
/// behind, as after the start, cycles that have waited are dropped, which leaves the processors to the reading, until
/// the latency is below two cycles. Of a source that is always late, one of ten cycles is shown.
class LateCycles {
 public:
  /// Returns the latency from which on a cycle is late: two cycles, but at least 50 ms, in which bytes are transferred.
  [[nodiscard]] static double most_s(double cycle_s);

  /// Returns whether a cycle is dropped that was read `latency_s` after its last event. `cycle_s` is the time that a
  /// cycle takes; 0 = unknown. The first cycle is shown.
  [[nodiscard]] bool drops(double latency_s, double cycle_s);

 private:
  static constexpr size_t kMostDropped = 9;
  size_t dropped_ = kMostDropped;  ///< since the last one that was shown
};

/// Chooses network and resolution by the pace: the best ones with which a light field is finished before the next cycle
/// ends.
class Pace {
 public:
  /// `macs_per_pixel` are the multiply-adds of the networks, from the best one to the fastest. It begins with the
  /// fastest one in the smallest size, from which it grows after every other light field while it keeps pace, and keeps
  /// a size that is named.
  explicit Pace(const std::vector<double>& macs_per_pixel = {1}, std::optional<PictureSize> named = {});

  [[nodiscard]] QualityLevel level() const { return steps_[step_].level; }

  /// Adds how long a light field took that was made so, and how long a cycle takes. Returns true if that changes. A
  /// cycle that was late is a reason for a smaller size.
  bool add(double field_s, double cycle_s, bool is_late = false);

 private:
  struct Step {
    QualityLevel level;
    double cost = 1;  ///< multiply-adds per pixel of the sensor
    int falls = 0;    ///< number of times that this step was too slow
  };
  std::vector<Step> steps_;  ///< ordered from the best one to the fastest
  size_t step_ = 0;
  bool is_growing_ = true;  ///< no step was too slow so far
  size_t measured_ = 0;     ///< light fields of this step
  double sum_s_ = 0;
};

}  // namespace e2lf::live
