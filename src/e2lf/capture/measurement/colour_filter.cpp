// SPDX-License-Identifier: MIT
#include "e2lf/capture/measurement/colour_filter.h"

#include <algorithm>

#include "e2lf/base/contract.h"
#include "e2lf/base/text.h"

namespace e2lf::capture {

Result<ColourFilter> colour_filter_from_name(const std::string& name) {
  constexpr std::string_view kLetters = "rgb";
  const bool has_each =
      std::all_of(kLetters.begin(), kLetters.end(), [&](char c) { return name.find(c) != name.npos; });
  if (name.size() != 4 || !has_each || name.find_first_not_of(kLetters) != std::string::npos) {
    return Error{ErrorCode::kInvalidValue,
                 cat("\"", name, "\" is not a colour filter; give the colours of 2x2 pixels row by row, such as rggb"),
                 "colour_filter"};
  }
  ColourFilter filter;
  for (size_t i = 0; i < 4; ++i) filter.channels[i] = kLetters.find(name[i]);
  return filter;
}

PlanesView<const int16_t> behind_filter(const PlanesView<const int16_t>& images, size_t place) {
  const auto [count, height, width] = images.extents;
  E2LF_REQUIRE(height % 2 == 0 && width % 2 == 0 && place < 4, "filters cover blocks of 2x2 pixels");
  return {&images[0][place / 2][place % 2],
          {count, height / 2, width / 2},
          {images.strides[0], 2 * images.strides[1], 2 * images.strides[2]}};
}

}  // namespace e2lf::capture
