// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::cycles {

struct SynthesisOptions {
  Schedule schedule = paper_schedule();
  int64_t begin_us = 100000;  ///< start of the first cycle
  int64_t jitter_us = 0;      ///< largest error of the start of a pattern, uniform in both directions
  double noise_hz = 0;        ///< background events per pixel
  std::optional<uint16_t> trigger_channel =
      0;                           ///< channel of the rising edge at the start of each pattern; absent = no triggers
  int64_t trigger_width_us = 500;  ///< time until the falling edge; 0 = no such edge
  uint64_t seed = 1;
};

/// Adds the rising edge of a trigger at t_us, and the falling one after `width_us`, if that is not 0. An absent channel
/// has no triggers.
void add_pulse(int64_t t_us, std::optional<uint16_t> channel, int64_t width_us,
               std::vector<recordings::Trigger>& triggers);

/// A synthesised cycle with the times at which its patterns began, as ground truth.
struct SynthesisedCycle {
  recordings::EventBatch batch;
  std::vector<int64_t> starts_us;  ///< one for each pattern in the batch
};

/// Synthesises the events and triggers of a camera for one cycle of event images. During the pattern of an image, each
/// pixel has |count| events with the sign of the count, at 150 us + exponentially distributed times after the
/// beginning of the pattern, in one sorted stream. Patterns without an image have events of the sign stated by the
/// schedule (or mixed) at the pixels of the first image. The repetition `number` of the display begins at begin_us +
/// number * schedule.cycle_us(), and the cycle within it at schedule.first_of_cycle(); cycle 0 is preceded by the
/// patterns that the display shows before it. The result depends only on the arguments. Contract: images has
/// schedule.num_images() transitions, and bursts end before the shortest pattern does.
[[nodiscard]] SynthesisedCycle synthesise_cycle(const capture::EventImages& images, uint64_t number,
                                                const SynthesisOptions& options);

/// Writes `cycles` cycles to a recording, with one in memory at a time. images_of returns the images of each, all of
/// one size. The writer is not finished. Fails as the writer and images_of do.
[[nodiscard]] Result<void> synthesise_recording(
    recordings::RecordingWriter& writer, uint64_t cycles, const SynthesisOptions& options,
    const std::function<Result<capture::EventImages>(uint64_t number)>& images_of);

}  // namespace e2lf::cycles
