// SPDX-License-Identifier: MIT
#include "e2lf/live/size_choice.h"

#include <utility>

#include "e2lf/base/text.h"

namespace e2lf::live {

const char* size_name(PictureSize size) {
  return size == PictureSize::kFull ? "full" : "half";
}

Result<std::optional<PictureSize>> size_from_name(const std::string& name) {
  if (name == "auto") return std::optional<PictureSize>();
  for (const PictureSize size : {PictureSize::kFull, PictureSize::kHalf}) {
    if (name == size_name(size)) return std::optional(size);
  }
  return Error{ErrorCode::kInvalidValue, cat("\"", name, "\" is not a size; give auto, full or half"), "size"};
}

bool SizeChoice::add(double field_s, double cycle_s) {
  // The first light field of a size also allocates its memory.
  constexpr size_t kFewest = 2, kBeforeGrowth = 20;
  // Full resolution has four times the pixels; a margin keeps the size from alternating.
  constexpr double kGrowth = 4 / 0.8;
  constexpr int kMostFalls = 3;
  if (named_ || cycle_s <= 0) return false;
  if (measured_++ == 0) return false;
  sum_s_ += field_s;
  const double mean_s = sum_s_ / static_cast<double>(measured_ - 1);
  if (size_ == PictureSize::kFull) {
    if (measured_ <= kFewest || mean_s <= cycle_s) return false;
    size_ = PictureSize::kHalf;
    ++falls_;
  } else {
    if (measured_ <= kBeforeGrowth || falls_ >= kMostFalls || kGrowth * mean_s > cycle_s) return false;
    size_ = PictureSize::kFull;
  }
  measured_ = 0;
  sum_s_ = 0;
  return true;
}

}  // namespace e2lf::live
