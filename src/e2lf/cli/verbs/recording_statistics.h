// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "e2lf/files/options.h"
#include "e2lf/recordings/event.h"

namespace e2lf::cli {

/// Collects statistics of the triggers of a recording and the extent of its events, in constant memory.
class RecordingStatistics {
 public:
  void add(const recordings::EventBatch& batch);

  /// Returns the size in px of the smallest sensor that contains all events, or 0 if there are none.
  [[nodiscard]] size_t width() const { return width_; }
  [[nodiscard]] size_t height() const { return height_; }

  /// Returns the number of rising and falling edges of each trigger input and the mean time between them.
  [[nodiscard]] Json triggers_json() const;
  [[nodiscard]] std::string triggers_text() const;

 private:
  struct Edges {
    uint64_t count = 0;
    int64_t first_us = 0, last_us = 0;
    void add(int64_t t_us);
    [[nodiscard]] double period_us() const;
  };
  struct Channel {
    Edges rising, falling;
  };
  std::map<uint16_t, Channel> channels_;
  size_t width_ = 0, height_ = 0;
};

}  // namespace e2lf::cli
