// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "e2lf/base/threads.h"
#include "e2lf/sensor/event_model.h"

namespace e2lf::sensor {

/// The number of pixels that are processed together. The intensities and counts of a block stay in the nearest caches.
inline constexpr size_t kBlockPixels = 2048;

/// Calls body(first_block, end_block) in parallel on ranges that cover the blocks of an image.
template <typename Body>
void for_block_ranges(size_t num_pixels, Body&& body) {
  parallel_for((num_pixels + kBlockPixels - 1) / kBlockPixels, 1, body);
}

/// Computes sum[i] += weight * values[i] for i < count.
void add_scaled(const float* values, float weight, float* sum, size_t count);

/// Computes the coded intensities of the pixels [first, first + count) of `light_field`, which the codes must fit, into
/// sums[n * stride + i], i < count.
void code_block(const capture::Codes& codes, const LightFieldView& light_field, size_t first, size_t count, float* sums,
                size_t stride);

/// Consecutive pixels of an image, numbered from first_pixel. intensities: [num_patterns][kBlockPixels], counts:
/// [num_patterns - 1][kBlockPixels]. All entries up to kBlockPixels must be readable and writable.
struct EventBlock {
  size_t num_patterns = 0;
  uint32_t first_pixel = 0;
  const float* intensities = nullptr;
  int16_t* counts = nullptr;
};

/// Computes the event counts of the first num_pixels of a block as defined by simulate_events(). Entries up to the next
/// multiple of the vector length are overwritten, too. Returns true if a count was saturated.
bool simulate_block(const EventBlock& block, size_t num_pixels, const EventModelOptions& options);

}  // namespace e2lf::sensor
