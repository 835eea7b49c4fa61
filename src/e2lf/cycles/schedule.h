// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"

namespace e2lf::cycles {

/// The sign that the events of the change to a pattern must have, if it is known: ON for white, OFF for black.
enum class BurstSign { kAny, kOn, kOff };

/// One pattern on the aperture.
struct ScheduledPattern {
  std::string name;
  int64_t duration_us = 10000;       ///< how long it is shown
  int64_t overhead_us = 0;           ///< time from its end to the start of the next
  std::optional<size_t> image;       ///< the event image of its events; absent = they are not used
  BurstSign sign = BurstSign::kAny;  ///< sign of the events that the change to this pattern causes

  [[nodiscard]] int64_t interval_us() const { return duration_us + overhead_us; }
  bool operator==(const ScheduledPattern&) const = default;
};

/// The patterns of one cycle in the order in which they are shown repeatedly.
struct Schedule {
  std::vector<ScheduledPattern> patterns;
  std::optional<capture::Orientation> views = {};  ///< orientation of the resulting views; absent = unknown
  std::optional<capture::Codes> codes = {};        ///< the coding patterns a1 to aN; absent = unknown

  [[nodiscard]] size_t size() const { return patterns.size(); }
  [[nodiscard]] size_t num_images() const;
  [[nodiscard]] int64_t cycle_us() const;
  /// Returns the pattern to which image 0 belongs, or size() if there is none.
  [[nodiscard]] size_t first_image_pattern() const;
  /// Returns the pattern with which a cycle of event images begins: 0, or that of image 0 if the images continue from
  /// the end of the list to its beginning, as those of all transitions do.
  [[nodiscard]] size_t first_of_cycle() const;
  bool operator==(const Schedule&) const = default;
};

/// Returns the sequence of the paper's Section 4.2 for N coding patterns, the first of which is black: the inverses of
/// a1..aN, then a1..aN. a1 and its inverse are shown for 15 ms and the others for 10 ms, and the events of a2..aN are
/// used. The 592 us between patterns result in the 94.7 ms of the paper's cycle for N = 4.
[[nodiscard]] Schedule paper_schedule(size_t num_codes = 4);

/// Returns a1..aN without inverses, each shown for `duration_us`. The events of a2..aN are used.
[[nodiscard]] Schedule plain_schedule(size_t num_codes, int64_t duration_us);

/// Returns the schedule with an event image for each pattern, beginning with that of image 0. For the paper's schedule,
/// these are 2N images of the transitions a1 to a2, ..., aN to the inverse of a1, ..., the inverse of aN to a1. Such a
/// cycle begins at a2 and ends with the a1 of the display's next repetition. The schedule must have an image.
[[nodiscard]] Schedule with_all_transitions(Schedule schedule);

/// Fails with kInvalidValue: no used patterns, a duration below 1 us or above half an hour, or images that are not
/// numbered 0..n-1 in order from first_of_cycle() on.
[[nodiscard]] Result<void> validate(const Schedule& schedule, const std::string& location);

/// Read and write a schedule as {"patterns": [{"name": "a2", "duration_us": 10000, "overhead_us": 0, "image": 0,
/// "sign": "on"}, ...], "views": "turned", "codes": {...}}. If image is omitted, the events are not used; views is a
/// name of capture::orientation_name(), and codes is what capture::codes_to_json() returns. Fails with kNotFound,
/// kFormat and kInvalidValue.
[[nodiscard]] Result<Schedule> read_schedule(const std::filesystem::path& path);
[[nodiscard]] Result<Schedule> parse_schedule(const std::string& text, const std::string& name);
[[nodiscard]] std::string schedule_text(const Schedule& schedule);

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
