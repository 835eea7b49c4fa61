// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// Text of a file for people: control characters, which could command a terminal, become question marks.
[[nodiscard]] std::string one_line(std::string text);

/// One stream of events of a container that may hold several.
struct NamedStream {
  std::string number;  ///< as the file counts it
  std::string name;    ///< as "events" or "/camera/events"; may be empty
  std::string camera;  ///< as "DAVIS346_00000104"; may be empty
};

/// Returns the index of the stream that options.stream names by number, name or camera, or of the first one where it is
/// empty. Lists the streams in info.streams, and says there that the others are left out. Fails with kInvalidValue
/// where no stream or more than one is of that name, and with kFormat where there are none.
[[nodiscard]] Result<size_t> choose_stream(const std::vector<NamedStream>& streams, const OpenOptions& options,
                                           const std::string& location, RecordingInfo& info);

}  // namespace e2lf::recordings
