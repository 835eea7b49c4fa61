// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "e2lf/cycles/pattern_tracker.h"
#include "e2lf/recordings/event.h"

namespace e2lf::cycles {

/// Detects the starts of bursts in the event rate, separately for ON and OFF so that a burst is visible in the tail of
/// one of the other sign. A burst starts where the count of the next window exceeds that of the previous one most. It
/// works on events as they arrive, with a delay.
class BurstDetector {
 public:
  static constexpr int64_t kBinUs = 100;  ///< resolution of the starts

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
  [[nodiscard]] int64_t time_of(size_t bin) const { return (first_bin_ + static_cast<int64_t>(bin)) * kBinUs; }

  std::deque<Bin> bins_;    ///< complete bins, from first_bin_ on
  std::deque<Rise> rises_;  ///< of the bins with a whole window on both sides; the first one belongs to the bin after
                            ///< the first window
  int64_t first_bin_ = 0;
  bool has_begun_ = false;
  Bin open_;
  int64_t open_bin_ = 0;
  double typical_rise_ = 0;
  std::optional<int64_t> last_mark_us_;
};

}  // namespace e2lf::cycles
