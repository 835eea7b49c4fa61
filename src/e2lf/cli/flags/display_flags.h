// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/patterns/display.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/program/inputs.h"

namespace e2lf::cli {

/// The flags that choose patterns and place them on a display.
struct DisplayFlags {
  CodesSource codes;
  capture::DisplayLayout layout;
  unsigned rotation_deg = 0;
  bool no_inverses = false;
  int64_t duration_us = 10000;  ///< duration of each pattern, with no_inverses
};

/// Declares the flags.
void add_display_options(CLI::App& app, DisplayFlags& flags);

/// The sequence of images that a display shows in one cycle.
struct DisplaySequence {
  capture::Codes codes;
  cycles::Schedule schedule;
  std::vector<lightfield::ByteImage> frames;  ///< one for each pattern of the schedule
};

/// Renders the patterns in the order of the schedule. Fails as load_codes() and capture::render_pattern() do.
[[nodiscard]] Result<DisplaySequence> display_sequence(const DisplayFlags& flags, RunRecord& record);

}  // namespace e2lf::cli
