// SPDX-License-Identifier: MIT
#include "e2lf/recon/inversion.h"

#include <limits>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/recon/input.h"

namespace e2lf::recon {
namespace {

constexpr size_t kMinChunk = 4096;

int sign(int value) {
  return (value > 0) - (value < 0);
}

Result<void> check(const capture::EventImages& images, const InversionOptions& options) {
  E2LF_RETURN_IF_ERROR(IntensityTable::check(options.constants));
  if (options.black <= images.count) return {};
  return Error{ErrorCode::kInvalidValue,
               cat("the black pattern is number ", options.black, " but there are ", images.count + 1,
                   " patterns; count from 0"),
               ""};
}

}  // namespace

Result<capture::CodedIntensities> invert_events(const capture::EventImages& images, const InversionOptions& options) {
  E2LF_RETURN_IF_ERROR(check(images, options));
  const IntensityTable table(options.constants);
  const size_t num_patterns = images.count + 1;
  capture::CodedIntensities intensities(num_patterns, images.height, images.width);
  parallel_for(images.image_size(), kMinChunk, [&](size_t begin, size_t end) {
    std::vector<int> levels(num_patterns);  // in half thresholds, relative to the first pattern
    for (size_t pixel = begin; pixel < end; ++pixel) {
      int total = 0, last_change = 0;
      for (size_t k = 0; k < images.count; ++k) {
        const int count = images.image(k)[pixel];
        total += count;
        if (count != 0) last_change = sign(count);
        levels[k + 1] = 2 * total + (options.centred ? last_change : 0);
      }
      for (size_t n = 0; n < num_patterns; ++n) {
        intensities.image(n)[pixel] = table.at_half_steps(levels[n] - levels[options.black]);
      }
    }
  });
  return intensities;
}

}  // namespace e2lf::recon
