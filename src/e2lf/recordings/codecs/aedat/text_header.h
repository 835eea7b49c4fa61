// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/io/byte_source.h"

namespace e2lf::recordings::aedat {

/// The lines of text that AEDAT 1 to 3 begin with.
struct TextHeader {
  std::vector<std::string> lines;  ///< without "#" and the end of the line; the version line is the first
  size_t bytes = 0;                ///< where the data begin

  /// What follows `key` in a line that begins with it, without blanks around it.
  [[nodiscard]] std::optional<std::string> find(std::string_view key) const;
};

/// Reads and consumes the header: lines that begin with # up to one that says that it is the last, or to the data.
/// A line that holds other than text belongs to the data. Fails with kFormat where the header is longer than 16 MiB.
[[nodiscard]] Result<TextHeader> read_text_header(ByteSource& source);

struct CameraModel {
  const char* name;
  size_t width, height;  ///< px
  bool is_davis;         ///< addresses of AEDAT 2 are those of a DAVIS, else those of a DVS128
};

/// The camera that a name stands for, as "eu.seebetter.ini.chips.davis.Davis240C", "DVS128" or "DAVIS346_00000104".
[[nodiscard]] std::optional<CameraModel> find_camera_model(std::string_view name);

}  // namespace e2lf::recordings::aedat
