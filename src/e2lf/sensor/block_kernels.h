// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "e2lf/base/threads.h"
#include "e2lf/sensor/event_model.h"

namespace e2lf::sensor {

/// Pixels that are worked on together: a block's intensities and counts stay in the nearest caches.
inline constexpr size_t kBlockPixels = 2048;

/// Calls body(first_block, end_block) in parallel on ranges that cover the blocks of an image.
template <typename Body>
void for_block_ranges(size_t num_pixels, Body&& body) {
  parallel_for((num_pixels + kBlockPixels - 1) / kBlockPixels, 1, body);
}

/// sum[i] += weight * values[i] for i < count.
void add_scaled(const float* values, float weight, float* sum, size_t count);

/// Coded intensities of the pixels [first, first + count) of `light_field`, which the codes must fit:
/// sums[n * stride + i], i < count.
void code_block(const capture::Codes& codes, const lightfield::LightField& light_field, size_t first, size_t count,
                float* sums, size_t stride);

/// Consecutive pixels of an image, numbered from first_pixel. intensities: [num_patterns][kBlockPixels],
/// counts: [num_patterns - 1][kBlockPixels]; every entry up to kBlockPixels is readable and writable.
struct EventBlock {
  size_t num_patterns = 0;
  uint32_t first_pixel = 0;
  const float* intensities = nullptr;
  int16_t* counts = nullptr;
};

/// Event counts of the first num_pixels of a block as simulate_events() defines them; entries up to the next vector
/// length are overwritten too. Returns whether a count was saturated.
bool simulate_block(const EventBlock& block, size_t num_pixels, const EventModelOptions& options);

}  // namespace e2lf::sensor
