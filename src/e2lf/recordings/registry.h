// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "e2lf/recordings/recording.h"

namespace e2lf::events {

/// The first bytes of a file that detection looks at.
inline constexpr size_t kDetectBytes = 4096;

/// One format: how it is found, opened and created. The table of all of them is in registry.cpp, one line each.
struct Codec {
  std::string name = {};                     ///< OpenOptions::format, RecordingInfo::format
  std::vector<std::string> extensions = {};  ///< lower case, with the dot; the first codec of the table with one wins
  std::string description = {};              ///< for help texts

  /// Whether a file that begins with `head` is of this format; null = by extension or by name only.
  bool (*detect)(std::span<const uint8_t> head) = nullptr;

  /// Null where the format cannot be read / written.
  Result<std::unique_ptr<RecordingReader>> (*open)(std::unique_ptr<ByteSource> source,
                                                   const OpenOptions& options) = nullptr;
  Result<std::unique_ptr<RecordingWriter>> (*create)(std::unique_ptr<ByteSink> sink,
                                                     const RecordingInfo& info) = nullptr;

  /// For formats that write their file themselves (in place of `create`).
  Result<std::unique_ptr<RecordingWriter>> (*create_file)(const std::filesystem::path& path,
                                                          const RecordingInfo& info) = nullptr;

  /// Where the triggers of a file are that the format has no place for, when the reader looks for them there.
  std::filesystem::path (*side_file)(const std::filesystem::path& path) = nullptr;
};

/// All formats, in the order in which detection asks them.
[[nodiscard]] std::span<const Codec> codecs();

/// The codec of that name. Fails with kInvalidValue and the nearest name.
[[nodiscard]] Result<const Codec*> find_codec(const std::string& name);

}  // namespace e2lf::events
