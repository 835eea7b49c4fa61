// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace e2lf::recordings {

/// Describes a file that begins with `head` and is not a readable recording, and what to do with it, e.g. "a zip
/// archive; unpack it, then give the recording in it". Returns nothing if the bytes are not conclusive. Names of files
/// do not matter.
[[nodiscard]] std::optional<std::string> foreign_file_text(std::span<const uint8_t> head);

/// Describes a file that no format recognises by its extension and the plausibility of its records: those of N-MNIST
/// have no distinctive beginning.
[[nodiscard]] std::optional<std::string> foreign_records_text(std::span<const uint8_t> head,
                                                              const std::string& extension);

}  // namespace e2lf::recordings
