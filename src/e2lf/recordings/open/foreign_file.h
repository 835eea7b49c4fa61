// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace e2lf::recordings {

/// Says what a file is that begins with `head` and is no recording that can be read, and what to do with it, as "a zip
/// archive; unpack it and give the recording in it"; nothing where the bytes do not tell. Names of files do not matter.
[[nodiscard]] std::optional<std::string> foreign_file_text(std::span<const uint8_t> head);

/// The same for a file that no format claims, by its name and by what its records would be: those of N-MNIST have
/// nothing at their beginning that tells.
[[nodiscard]] std::optional<std::string> foreign_records_text(std::span<const uint8_t> head,
                                                              const std::string& extension);

}  // namespace e2lf::recordings
