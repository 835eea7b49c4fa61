// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// One format: how it is found, opened and created. The table of those that are built in is in registry.cpp.
struct Codec {
  std::string name = {};                     ///< OpenOptions::format, RecordingInfo::format
  std::vector<std::string> extensions = {};  ///< lower case, with the dot; the first codec of the table with one wins
  std::string description = {};              ///< for help texts

  /// Whether the columns and the unit of time are not fixed: OpenOptions::columns and time_unit are refused elsewhere.
  bool is_table = false;

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

  /// For formats that are folders of files.
  bool (*is_folder)(const std::filesystem::path& path) = nullptr;
  Result<std::unique_ptr<RecordingReader>> (*open_folder)(const std::filesystem::path& path,
                                                          const OpenOptions& options) = nullptr;

  /// Where the triggers of a file are that the format has no place for, when the reader looks for them there.
  std::filesystem::path (*side_file)(const std::filesystem::path& path) = nullptr;

  /// Whether the writer holds all in memory until finish().
  bool is_written_at_end = false;

  /// Makes what a writer that was killed left a file that can be read; null = it can be read as it is.
  Result<void> (*recover)(const std::filesystem::path& path) = nullptr;
};

/// All formats, in the order in which detection asks them. What they point to stays.
[[nodiscard]] std::vector<const Codec*> codecs();

/// Adds a format for this process. It is asked before all others, so it also takes the place of one of its name.
void add_codec(Codec codec);

/// Whether a folder is a recording, as a bag of ROS 2 is.
[[nodiscard]] bool is_recording_folder(const std::filesystem::path& path);

/// The codec of that name. Fails with kInvalidValue and the nearest name.
[[nodiscard]] Result<const Codec*> find_codec(const std::string& name);

}  // namespace e2lf::recordings
