// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "e2lf/cycles/pattern_tracker.h"
#include "e2lf/recordings/event.h"

namespace e2lf::cycles {

struct BurstOptions {
  int64_t bin_us = 100;           ///< resolution of the starts
  int64_t window_us = 1000;       ///< in which the rates before and after are compared
  int64_t min_spacing_us = 4000;  ///< between two bursts
  double min_significance = 10;   ///< of the rise of the count, in standard deviations at a constant rate
  double min_rise = 0.1;          ///< of the count, relative to the typical burst
};

/// Detects the starts of bursts in the event rate, separately for ON and OFF so that a burst is visible in the tail of
/// one of the other sign. A burst starts where the count of the next window exceeds that of the previous one most. It
/// works on events as they arrive, with a delay.
class BurstDetector {
 public:
  explicit BurstDetector(const BurstOptions& options);

  /// Processes the next events and appends the bursts that are now certain.
  void add(const recordings::EventColumns& events, std::vector<Mark>& marks);

  /// Appends the bursts at the end of the recording.
  void finish(std::vector<Mark>& marks);

  /// Returns the time before which all bursts have been found.
  [[nodiscard]] int64_t known_until_us() const;

 private:
  struct Bin {
    uint32_t on = 0, off = 0;
  };
  struct Rise {
    double count = 0;         ///< additional events compared with before
    double significance = 0;  ///< in standard deviations
    double on_share = 0.5;
  };

  void begin_in_silence();
  void close_bins(int64_t until_bin, std::vector<Mark>& marks);
  void judge(std::vector<Mark>& marks);
  [[nodiscard]] Rise rise_at(size_t bin) const;
  [[nodiscard]] size_t foot_of(size_t bin) const;
  [[nodiscard]] int64_t time_of(size_t bin) const { return (first_bin_ + static_cast<int64_t>(bin)) * options_.bin_us; }

  BurstOptions options_;
  size_t window_, spacing_;  ///< in bins
  std::deque<Bin> bins_;     ///< complete bins, from first_bin_ on
  std::deque<Rise> rises_;   ///< of the bins with a whole window on both sides; the first one belongs to bins_[window_]
  int64_t first_bin_ = 0;
  bool has_begun_ = false;
  Bin open_;
  int64_t open_bin_ = 0;
  double typical_rise_ = 0;
  std::optional<int64_t> last_mark_us_;
};

}  // namespace e2lf::cycles
