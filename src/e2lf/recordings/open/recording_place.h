// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "e2lf/base/result.h"

namespace e2lf::recordings {

/// What the format of a recording asks of the place where it is written.
struct RecordingPlace {
  bool streams = false;  ///< written front to back: a pipe or device will do
  /// Where the triggers go that the format has no place for; null where it has one.
  std::filesystem::path (*side_file)(const std::filesystem::path& path) = nullptr;
  bool is_written_at_end = false;  ///< of a writer that was killed nothing is left
  /// Makes what a writer that was killed left a file that can be read, and fails where that cannot be done; null = it
  /// can be read as it is.
  Result<void> (*recover)(const std::filesystem::path& path) = nullptr;
};

/// By the same rules as create_recording(). Fails with kInvalidValue on an unknown format.
[[nodiscard]] Result<RecordingPlace> place_of_recording(const std::filesystem::path& path, const std::string& format);

}  // namespace e2lf::recordings
