// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "e2lf/base/result.h"
#include "e2lf/streams/stream_options.h"

namespace e2lf::bench {

/// Simulation event by event, events per second: the best of two cycles. One thread is measured by its processor time,
/// which a busy machine changes little.
struct StreamBenchmark {
  uint64_t events = 0;      ///< of one cycle
  double events_per_s = 0;  ///< with all threads
  double one_thread_events_per_s = 0;
  double reference_events_per_s = 0;  ///< of the scalar reference on one thread
};

/// Measures eight patterns of noise, the first half bright, then black, then dim ones, as the paper's cycle has them.
/// Fails as streams::EventStream::create() does.
[[nodiscard]] Result<StreamBenchmark> benchmark_stream(const streams::StreamOptions& options, size_t height,
                                                       size_t width);

}  // namespace e2lf::bench
