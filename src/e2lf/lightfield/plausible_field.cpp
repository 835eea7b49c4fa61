// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/plausible_field.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"

namespace e2lf::lightfield {
namespace {

/// The largest numbers of 8, 10, 12, 14 and 16 bits.
constexpr float kWhites[] = {255, 1023, 4095, 16383, 65535};

/// Returns the likely white of samples whose largest value is `high`.
float likely_white(float high) {
  const auto* found =
      std::find_if(std::begin(kWhites), std::end(kWhites), [high](float white) { return high <= white; });
  return found == std::end(kWhites) ? high : *found;
}

/// Warns if many values lie outside of [0, 1], which suggests another range. A few such values are normal in some
/// views.
void warn_of_range(float low, float high, double share_below, double share_above, const std::string& location) {
  constexpr double kMany = 1.0 / 16;
  const std::string found = cat(location, ": the values are in ", low, "..", high);
  if (low < -0.5F || share_below > kMany) {
    log_warning(
        cat(found, ", and ", std::round(100 * share_below),
            " % of them are below 0, which is black; if another value is black, scale them to 0..1 first",
            low >= -1.0F - kRangeTolerance && high <= 1.0F + kRangeTolerance ? ", from -1..1 as (x + 1) / 2" : ""));
  } else if (share_above > kMany) {
    log_warning(cat(found, ", and ", std::round(100 * share_above),
                    " % of them are above 1, which is white; if another value is white, give it"));
  }
}

}  // namespace

void BadSamples::add(float stored) {
  if (!std::isfinite(stored)) {
    ++not_finite;
    return;
  }
  low = std::min(low, stored);
  high = std::max(high, stored);
}

Error BadSamples::error(const std::string& location) const {
  if (not_finite > 0) {
    return {ErrorCode::kInvalidValue,
            cat("contains ", not_finite, " value", not_finite == 1 ? " that is" : "s that are",
                " not finite (NaN or infinity), the first bad one is ", first,
                "; replace them, a light field has values in [0, 1]"),
            location};
  }
  const std::string what =
      cat("a light field has values in [0, 1], but these are in ", low, "..", high, ", the first outside is ", first);
  if (low < -kRangeTolerance) {
    return {ErrorCode::kInvalidValue,
            cat(what, "; scale them to 0..1", low >= -1.0F && high <= 1.0F ? ", from -1..1 as (x + 1) / 2" : ""),
            location};
  }
  return {ErrorCode::kInvalidValue, cat(what, "; give the value that is white, e.g. ", likely_white(high)), location,
          Setting::kWhite};
}

Result<void> check_values(const LightField& light_field, float assumed_white, const std::string& location) {
  float low = light_field.data().front(), high = low;
  size_t below = 0, above = 0;
  for (const float value : light_field.data()) {
    low = std::min(low, value);
    high = std::max(high, value);
    below += value < -kRangeTolerance ? 1 : 0;
    above += value > 1.0F + kRangeTolerance ? 1 : 0;
  }
  const float most = std::round(high * assumed_white);
  const bool are_bits = assumed_white == 255.0F && most == 1.0F;
  const bool are_bytes = assumed_white == 65535.0F && most > 0.0F && most <= 255.0F;
  if (are_bits || are_bytes) {
    return Error{ErrorCode::kInvalidValue,
                 cat("the values are in ", std::round(low * assumed_white), "..", most,
                     ", although the largest of their type is ", assumed_white, "; give the value that is white, e.g. ",
                     are_bits ? 1 : 255),
                 location, Setting::kWhite};
  }
  const auto count = static_cast<double>(light_field.data().size());
  constexpr float kLeastContrast = 0.02F;
  if (assumed_white == 65535.0F && most > 0.0F && most <= 16383.0F) {
    log_warning(
        cat(location, ": the values are in ", std::round(low * assumed_white), "..", most,
            ", and 65535 is assumed to be white; if they have fewer than 16 bits, give the value that is white, e.g. ",
            likely_white(most)));
  } else if (high - low < kLeastContrast) {
    log_warning(
        cat(location, ": the values are ", high == low ? cat("all ", low) : cat("in ", low, "..", high),
            ", where 0 is black and 1 is white: there is hardly any contrast; if another value is white, give it"));
  }
  warn_of_range(low, high, static_cast<double>(below) / count, static_cast<double>(above) / count, location);
  return {};
}

Result<void> check_axes(const Shape& stored, const std::string& location) {
  constexpr size_t kFewViews = 32;
  if (stored.views_y <= stored.height || stored.views_x <= stored.width) return {};
  const std::string found = cat("read as [view_y, view_x, y, x] these are ", stored.views_y, "x", stored.views_x,
                                " views of ", stored.width, "x", stored.height, " px");
  if (std::max(stored.views_y, stored.views_x) > kFewViews) {
    return Error{ErrorCode::kShape, cat(found, "; the axes are in another order, transpose them"), location};
  }
  log_warning(cat(location, ": ", found, "; if the axes are in another order, transpose them"));
  return {};
}

}  // namespace e2lf::lightfield
