// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/profile/orientation.h"

namespace e2lf::cycles {

/// Which sign the events of the change to a pattern must have, where that is known: to white is ON, to black is OFF.
enum class BurstSign { kAny, kOn, kOff };

/// One pattern on the aperture.
struct ScheduledPattern {
  std::string name;
  int64_t duration_us = 10000;       ///< how long it is shown
  int64_t overhead_us = 0;           ///< from its end to the start of the next
  std::optional<size_t> image;       ///< the event image that its events go to; nothing = they are not used
  BurstSign sign = BurstSign::kAny;  ///< of the events that the change to it makes

  [[nodiscard]] int64_t interval_us() const { return duration_us + overhead_us; }
  bool operator==(const ScheduledPattern&) const = default;
};

/// The patterns of one cycle in the order in which they are shown, again and again.
struct Schedule {
  std::vector<ScheduledPattern> patterns;
  std::optional<capture::Orientation> views = {};  ///< how the views come out; nothing = not known

  [[nodiscard]] size_t size() const { return patterns.size(); }
  [[nodiscard]] size_t num_images() const;
  [[nodiscard]] int64_t cycle_us() const;
  /// The pattern that image 0 belongs to; size() where there is none.
  [[nodiscard]] size_t first_image_pattern() const;
  /// The pattern that a cycle of event images begins with: 0, or that of image 0 where the images go on behind the end
  /// of the list at its begin, as those of all transitions do.
  [[nodiscard]] size_t first_of_cycle() const;
  bool operator==(const Schedule&) const = default;
};

/// The sequence of the paper's Section 4.2 for N coding patterns of which the first is black: the inverses of
/// a1..aN, then a1..aN; 15 ms for a1 and its inverse, 10 ms for the others; events are used in a2..aN. 592 us from
/// pattern to pattern make the 94.7 ms of the paper's cycle for N = 4.
[[nodiscard]] Schedule paper_schedule(size_t num_codes = 4);

/// a1..aN without inverses, each for `duration_us`; events are used in a2..aN.
[[nodiscard]] Schedule plain_schedule(size_t num_codes, int64_t duration_us);

/// Returns the schedule with an event image for each pattern, the one of image 0 first: in the paper's, 2N images of
/// the transitions a1 to a2, ..., aN to the inverse of a1, ..., the inverse of aN to a1. Such a cycle begins at a2 and
/// ends with the a1 of the display's next repetition. There must be an image.
[[nodiscard]] Schedule with_all_transitions(Schedule schedule);

/// Fails with kInvalidValue: no patterns, a duration below 1 us, images that are not 0..n-1 once each in this order,
/// from first_of_cycle() on.
[[nodiscard]] Result<void> validate(const Schedule& schedule, const std::string& location);

/// {"patterns": [{"name": "a2", "duration_us": 10000, "overhead_us": 0, "image": 0, "sign": "on"}, ...],
/// "views": "turned"}; image left out = not used, views as capture::orientation_name() says them. Fails with kNotFound,
/// kFormat and kInvalidValue.
[[nodiscard]] Result<Schedule> read_schedule(const std::filesystem::path& path);
[[nodiscard]] Result<Schedule> parse_schedule(const std::string& text, const std::string& name);
[[nodiscard]] std::string schedule_text(const Schedule& schedule);

}  // namespace e2lf::cycles
