// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "e2lf/base/result.h"

namespace e2lf::recordings {

/// The requirements of a recording format on the place where it is written.
struct RecordingPlace {
  bool streams = false;  ///< written from front to back, so that a pipe or device is sufficient
  /// Returns the path of the file for triggers that the format cannot hold; null if it can.
  std::filesystem::path (*side_file)(const std::filesystem::path& path) = nullptr;
  bool is_written_at_end = false;  ///< if the writer is killed, nothing is left
  /// Makes the file of a killed writer readable, and fails if that is not possible; null if it is readable as it is.
  Result<void> (*recover)(const std::filesystem::path& path) = nullptr;
};

/// Returns the requirements, by the same rules as create_recording(). Fails with kInvalidValue (unknown format).
[[nodiscard]] Result<RecordingPlace> place_of_recording(const std::filesystem::path& path, const std::string& format);

}  // namespace e2lf::recordings
