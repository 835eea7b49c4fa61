// SPDX-License-Identifier: MIT
#include "e2lf/capture/profile/orientation.h"

#include "e2lf/base/text.h"

namespace e2lf::capture {

const char* orientation_name(const Orientation& orientation) {
  if (orientation == kTurned) return "turned";
  return orientation.flip_x ? "flipped-x" : orientation.flip_y ? "flipped-y" : "upright";
}

Result<Orientation> orientation_from_name(const std::string& name, const std::string& location) {
  for (const Orientation& known : {Orientation{}, kTurned, Orientation{true, false}, Orientation{false, true}}) {
    if (name == orientation_name(known)) return known;
  }
  return Error{ErrorCode::kInvalidValue,
               cat("\"", name, "\" is not an orientation of views; use upright, turned, flipped-x or flipped-y"),
               location};
}

}  // namespace e2lf::capture
