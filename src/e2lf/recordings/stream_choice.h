// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// A stream of events in a container that may hold several.
struct NamedStream {
  std::string number;  ///< the number that the file assigns
  std::string name;    ///< e.g. "events" or "/camera/events"; may be empty
  std::string camera;  ///< e.g. "DAVIS346_00000104"; may be empty
};

/// Returns the index of the stream that options.stream selects by number, name or camera, or that of the first one if
/// it is empty. Lists the streams in info.streams and, if several exist and none was selected, adds the assumption that
/// the others are left out. Fails with kInvalidValue if no stream or more than one matches, and with kFormat if there
/// are none.
[[nodiscard]] Result<size_t> choose_stream(const std::vector<NamedStream>& streams, const OpenOptions& options,
                                           const std::string& location, RecordingInfo& info);

}  // namespace e2lf::recordings
