// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "e2lf/base/result.h"

namespace e2lf::live {

enum class PictureSize {
  kFull,  ///< one pixel of the light field for each pixel of the sensor
  kHalf,  ///< one pixel for each block of 2x2; see sum_blocks()
};
/// Returns "full" or "half".
[[nodiscard]] const char* size_name(PictureSize size);
/// Parses a name; returns nothing for "auto". Fails with kInvalidValue.
[[nodiscard]] Result<std::optional<PictureSize>> size_from_name(const std::string& name);

/// Chooses the resolution so that reconstruction keeps pace: full resolution if a light field is complete before the
/// next cycle ends, and half resolution otherwise.
class SizeChoice {
 public:
  /// If `named` is given, this resolution is always used.
  explicit SizeChoice(std::optional<PictureSize> named = {}) : named_(named) {}

  [[nodiscard]] PictureSize size() const { return named_.value_or(size_); }
  [[nodiscard]] const char* name() const {
    return named_ ? size_name(*named_) : "auto";
  }  ///< as size_from_name() reads

  /// Adds the time that a light field of size() took and the duration of a cycle. Returns true if the size changes.
  bool add(double field_s, double cycle_s);

 private:
  std::optional<PictureSize> named_;
  PictureSize size_ = PictureSize::kFull;
  size_t measured_ = 0;  ///< number of light fields of this size
  double sum_s_ = 0;
  int falls_ = 0;  ///< number of changes from full to half
};

}  // namespace e2lf::live
