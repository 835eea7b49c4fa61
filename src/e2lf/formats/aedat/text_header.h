// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/io/bytes.h"

namespace e2lf::recordings::aedat {

/// The lines of text at the start of AEDAT 1 to 3.
struct TextHeader {
  std::vector<std::string> lines;  ///< without "#" and the line ending; the version line is the first
  size_t bytes = 0;                ///< offset of the data

  /// Returns the text after `key` in a line that begins with it, without surrounding blanks.
  [[nodiscard]] std::optional<std::string> find(std::string_view key) const;
};

/// Reads and consumes the header: lines that begin with #, up to one that declares the end of the header, or up to the
/// data. A line with other characters than text belongs to the data. Fails with kFormat if the header is longer than 16
/// MiB.
[[nodiscard]] Result<TextHeader> read_text_header(ByteSource& source);

struct CameraModel {
  const char* name;
  size_t width, height;  ///< px
  bool is_davis;         ///< whether addresses of AEDAT 2 are those of a DAVIS rather than of a DVS128
};

/// Returns the camera that a name denotes, e.g. "eu.seebetter.ini.chips.davis.Davis240C", "DVS128" or
/// "DAVIS346_00000104".
[[nodiscard]] std::optional<CameraModel> find_camera_model(std::string_view name);

}  // namespace e2lf::recordings::aedat
