// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/cycles/schedule.h"

namespace e2lf::cycles {

/// The content of the aperture: one of the codes, or its inverse.
struct ShownPattern {
  size_t code = 0;  ///< 0 = a1
  bool is_inverse = false;
  bool operator==(const ShownPattern&) const = default;
};

/// Returns the content of each pattern of a schedule, given by its name: "a1" to "aN", "inverse a1" to "inverse aN", or
/// "black" for "a1". Fails with kInvalidValue for any other name, or if the number of event images does not match N
/// codes: they are those of the N - 1 transitions into a2 to aN, or of all transitions.
[[nodiscard]] Result<std::vector<ShownPattern>> shown_patterns(const Schedule& schedule, size_t num_codes);

/// Returns the patterns between which the event images of a schedule lie, one more than there are images. `codes` are
/// a1 to aN, or capture::whole_cycle() of them. Returns nothing if they do not match the schedule or if the names of
/// its patterns are unknown.
[[nodiscard]] std::optional<capture::Codes> codes_of_images(const capture::Codes& codes, const Schedule& schedule);

/// Returns the schedule of the paper for a1 to aN, or for capture::whole_cycle() of them with the events of all
/// transitions used.
[[nodiscard]] Schedule paper_schedule_of(const capture::Codes& codes);

}  // namespace e2lf::cycles
