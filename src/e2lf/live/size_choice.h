// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "e2lf/base/result.h"

namespace e2lf::live {

enum class PictureSize {
  kFull,  ///< a pixel of the light field for each pixel of the sensor
  kHalf,  ///< one for each block of 2x2: see sum_blocks()
};
[[nodiscard]] const char* size_name(PictureSize size);  ///< "full", "half"
/// Nothing for "auto". Fails with kInvalidValue.
[[nodiscard]] Result<std::optional<PictureSize>> size_from_name(const std::string& name);

/// Chooses the resolution by the pace: the full one as long as a light field is finished before the next cycle ends,
/// otherwise half of it.
class SizeChoice {
 public:
  /// A size that is named is kept.
  explicit SizeChoice(std::optional<PictureSize> named = {}) : named_(named) {}

  [[nodiscard]] PictureSize size() const { return named_.value_or(size_); }
  [[nodiscard]] const char* name() const {
    return named_ ? size_name(*named_) : "auto";
  }  ///< as size_from_name() reads

  /// Adds how long a light field of size() took, and how long a cycle takes. Returns true if the size changes.
  bool add(double field_s, double cycle_s);

 private:
  std::optional<PictureSize> named_;
  PictureSize size_ = PictureSize::kFull;
  size_t measured_ = 0;  ///< fields of this size
  double sum_s_ = 0;
  int falls_ = 0;  ///< from full to half
};

}  // namespace e2lf::live
