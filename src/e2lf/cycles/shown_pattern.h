// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/cycles/schedule.h"

namespace e2lf::cycles {

/// What the aperture shows: one of the codes, or its inverse.
struct ShownPattern {
  size_t code = 0;  ///< 0 = a1
  bool is_inverse = false;
  bool operator==(const ShownPattern&) const = default;
};

/// Returns what each pattern of a schedule is, by its name: "a1" to "aN", "inverse a1" to "inverse aN", or "black" for
/// "a1". Fails with kInvalidValue for another name, or when patterns of the schedule and images are not those of N
/// codes: the images are those of the N - 1 transitions into a2 to aN, or of all transitions.
[[nodiscard]] Result<std::vector<ShownPattern>> shown_patterns(const Schedule& schedule, size_t num_codes);

/// Returns the patterns between which the event images of a schedule lie, one more than there are images. `codes` are
/// a1 to aN, or capture::whole_cycle() of them. Nothing where they are not those of the schedule, or where the names of
/// its patterns do not tell.
[[nodiscard]] std::optional<capture::Codes> codes_of_images(const capture::Codes& codes, const Schedule& schedule);

/// Returns the paper's schedule for a1 to aN, or for capture::whole_cycle() of them with the events of all transitions
/// used.
[[nodiscard]] Schedule paper_schedule_of(const capture::Codes& codes);

}  // namespace e2lf::cycles
