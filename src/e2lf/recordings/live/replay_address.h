// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "e2lf/base/result.h"

namespace e2lf::recordings {

/// What is replayed, and how.
struct ReplayAddress {
  std::string path;
  double speed = 1;     ///< of the replay, relative to the recording's own
  uint64_t repeat = 1;  ///< how often it is played
};

/// Parses FILE or FILE?speed=S&repeat=N. A file that has the whole text as its name is meant. Fails with kInvalidValue:
/// another key, a speed that is not above 0 and at most 1000, or a number of repeats that is not 1 to 1,000,000.
[[nodiscard]] Result<ReplayAddress> parse_replay_address(const std::string& address);

/// Returns the length of the path at the beginning of such a text.
[[nodiscard]] size_t replay_path_size(const std::string& address);

}  // namespace e2lf::recordings
