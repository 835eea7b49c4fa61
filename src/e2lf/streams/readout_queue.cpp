// SPDX-License-Identifier: MIT
#include "e2lf/streams/readout_queue.h"

#include <algorithm>

namespace e2lf::streams {

void ReadoutQueue::pass(recordings::EventColumns& events, size_t begin) {
  if (interval_us_ == 0) return;
  size_t kept = begin;
  for (size_t i = begin; i < events.size(); ++i) {
    const auto t_us = static_cast<double>(events.t[i]);
    const double leaves_us = std::max(t_us, free_us_);
    if (leaves_us - t_us > longest_us_) {
      ++lost_;
      continue;
    }
    free_us_ = leaves_us + interval_us_;
    events.x[kept] = events.x[i];
    events.y[kept] = events.y[i];
    events.p[kept] = events.p[i];
    events.t[kept++] = static_cast<int64_t>(leaves_us);
  }
  events.resize(kept);
}

}  // namespace e2lf::streams
