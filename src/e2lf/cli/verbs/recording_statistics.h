// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "e2lf/files/options.h"
#include "e2lf/recordings/event.h"

namespace e2lf::cli {

/// What the triggers of a recording look like, and how far its events reach. Constant memory.
class RecordingStatistics {
 public:
  void add(const recordings::EventBatch& batch);

  /// The size of the smallest sensor that holds the events; 0 without any.
  [[nodiscard]] size_t width() const { return width_; }
  [[nodiscard]] size_t height() const { return height_; }

  /// For each trigger input: edges of both kinds and the mean time between the rising ones.
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
