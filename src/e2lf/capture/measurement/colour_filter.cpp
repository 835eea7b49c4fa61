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

EventImages behind_filter(const EventImages& images, size_t place) {
  E2LF_REQUIRE(images.height % 2 == 0 && images.width % 2 == 0 && place < 4, "filters cover blocks of 2x2 pixels");
  EventImages part(images.count, images.height / 2, images.width / 2);
  for (size_t k = 0; k < images.count; ++k) {
    const auto from = images.image(k);
    const auto to = part.image(k);
    for (size_t y = 0; y < part.height; ++y) {
      const size_t row = (2 * y + place / 2) * images.width + place % 2;
      for (size_t x = 0; x < part.width; ++x) to[y * part.width + x] = from[row + 2 * x];
    }
  }
  return part;
}

}  // namespace e2lf::capture
