// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "e2lf/base/result.h"
#include "e2lf/streams/event_stream.h"

namespace e2lf::bench {

/// The speed of simulating individual events, in events per second, as the best of two cycles. A single thread is
/// measured by its processor time, which depends little on the load of the machine.
struct StreamBenchmark {
  uint64_t events = 0;      ///< in one cycle
  double events_per_s = 0;  ///< with all threads
  double one_thread_events_per_s = 0;
  double reference_events_per_s = 0;  ///< of the scalar reference on one thread
};

/// Measures eight patterns of noise: the first half bright, then black, then dim ones, as in the paper's cycle. Fails
/// as streams::EventStream::create() does.
[[nodiscard]] Result<StreamBenchmark> benchmark_stream(const streams::StreamOptions& options, size_t height,
                                                       size_t width);

}  // namespace e2lf::bench
