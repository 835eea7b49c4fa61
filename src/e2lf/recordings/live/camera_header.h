// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>

namespace e2lf::recordings {

/// Returns the header of a RAW recording with these keys, the date and the end mark. Keys with empty values are left
/// out.
[[nodiscard]] std::string camera_header(std::map<std::string, std::string> keys);

}  // namespace e2lf::recordings
