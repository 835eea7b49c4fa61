// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "e2lf/cycles/schedule.h"
#include "e2lf/recordings/event.h"

namespace e2lf::cycles {

/// The edges of one trigger input.
struct TriggerInput {
  uint64_t rising = 0, falling = 0;
  std::vector<int64_t> rising_us, falling_us;  ///< the times of the first ones
};

/// Counts the triggers of a recording by input and edge, and keeps the times of the first ones.
class TriggerSurvey {
 public:
  void add(std::span<const recordings::Trigger> triggers);

  [[nodiscard]] const std::map<uint16_t, TriggerInput>& inputs() const { return inputs_; }

  static constexpr size_t kMostTimes = 4096;  ///< largest number of times kept of each edge

 private:
  std::map<uint16_t, TriggerInput> inputs_;
};

/// The user's options, which the advice must take into account.
struct SurveyOptions {
  bool takes_rising = true, takes_falling = false;
  bool has_channel = false;  ///< true if `channel` was named
  uint16_t channel = 0;
  bool one_trigger_per_cycle = false;
};

/// Describes in one line the triggers found and those that the schedule expects: inputs, edges, counts and the usual
/// interval.
[[nodiscard]] std::string survey_text(const TriggerSurvey& survey, const Schedule& schedule);

/// Returns the advice that is most likely to help if the triggers do not form whole cycles of the schedule, as a
/// sentence that names the option. It is empty if the triggers match the schedule. `last_us` is the last time of the
/// recording.
[[nodiscard]] std::string trigger_advice(const TriggerSurvey& survey, const Schedule& schedule,
                                         const SurveyOptions& options, int64_t last_us);

}  // namespace e2lf::cycles
