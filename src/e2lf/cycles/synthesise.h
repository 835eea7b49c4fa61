// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "e2lf/capture/measurement/event_images.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::cycles {

struct SynthesisOptions {
  Schedule schedule = paper_schedule();
  int64_t begin_us = 100000;  ///< start of the first cycle
  int64_t latency_us = 150;   ///< from a change of pattern to its first events
  double decay_us = 2000;     ///< of the event rate after a change
  int64_t burst_us = 9500;    ///< no event of a burst comes later than this after the change
  int64_t jitter_us = 0;      ///< of the time at which a pattern begins, up and down, uniform
  double noise_hz = 0;        ///< background events of each pixel
  double unused_share = 1.0;  ///< events of a transition that is not used, as a share of those of the used ones
  std::optional<uint16_t> trigger_channel = 0;  ///< a rising edge at the start of each pattern; nothing = no triggers
  int64_t trigger_width_us = 500;               ///< to the falling edge; 0 = none
  uint64_t seed = 1;
};

/// When the patterns of a synthesised cycle began: the truth that cutting is measured against.
struct SynthesisedCycle {
  recordings::EventBatch batch;
  std::vector<int64_t> starts_us;  ///< of each pattern that the batch holds
};

/// The events and triggers that a camera would give for one cycle of event images: in the time of the pattern that an
/// image belongs to, |count| events of a pixel, of the count's sign, at latency + exponentially distributed times after
/// the pattern begins, one after the other in a sorted stream; for patterns without an image, events of the sign the
/// schedule states (or mixed) at the pixels of the first image. The display's repetition `number` begins at
/// begin_us + number * schedule.cycle_us(), and the cycle within it at schedule.first_of_cycle(); before cycle 0 stand
/// the patterns that the display shows before it. The result depends on nothing but the arguments.
/// Contract: images has schedule.num_images() transitions; bursts end before the shortest pattern does.
[[nodiscard]] SynthesisedCycle synthesise_cycle(const capture::EventImages& images, uint64_t number,
                                                const SynthesisOptions& options);

/// Writes `cycles` cycles to a recording, one in memory at a time; images_of gives the images of each, all of one size.
/// The writer is not finished. Fails like the writer and images_of.
[[nodiscard]] Result<void> synthesise_recording(
    recordings::RecordingWriter& writer, uint64_t cycles, const SynthesisOptions& options,
    const std::function<Result<capture::EventImages>(uint64_t number)>& images_of);

}  // namespace e2lf::cycles
