// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/output.h"
#include "e2lf/recordings/live/camera.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// A format: how it is detected, opened and created. registry.cpp contains the table of RAW and HDF5;
/// formats::add_formats() adds the others as a program adds its own.
struct Codec {
  std::string name = {};  ///< OpenOptions::format and RecordingInfo::format
  std::vector<std::string> extensions =
      {};  ///< lower case, with the dot; the first codec in the table takes precedence

  /// Whether the columns and the unit of time vary; other formats refuse OpenOptions::columns and time_unit.
  bool is_table = false;

  /// Returns whether a file that begins with `head` has this format; null = selected only by extension or name.
  bool (*detect)(std::span<const uint8_t> head) = nullptr;

  /// Null if the format cannot be read or written, respectively. To create a recording, info.format is the name of the
  /// codec, except for "raw", which comprises several.
  Result<ReaderPtr> (*open)(SourcePtr source, const OpenOptions& options) = nullptr;
  Result<WriterPtr> (*create)(SinkPtr sink, const RecordingInfo& info) = nullptr;

  /// For formats that write their file themselves, instead of `create`.
  Result<WriterPtr> (*create_file)(const std::filesystem::path& path, const RecordingInfo& info) = nullptr;

  /// For formats that are folders of files.
  bool (*is_folder)(const std::filesystem::path& path) = nullptr;
  Result<ReaderPtr> (*open_folder)(const std::filesystem::path& path, const OpenOptions& options) = nullptr;

  /// Returns the path of the file with triggers that the format cannot hold, if the reader looks for it.
  std::filesystem::path (*side_file)(const std::filesystem::path& path) = nullptr;

  /// Returns whether a file with such a path was written by this codec, judging by its first bytes; null = it is text,
  /// as that of side_trigger_path().
  bool (*is_side_file)(const std::filesystem::path& path) = nullptr;

  /// Whether the writer keeps everything in memory until finish().
  bool is_written_at_end = false;
};

/// Returns all formats in the order of detection. The pointers remain valid.
[[nodiscard]] std::vector<const Codec*> codecs();

/// Adds a format for this process. It is tried before all others, and thus also replaces a format with the same name.
void add_codec(Codec codec);

/// Returns the codec of a new recording, by the same rules as create_recording(): the one with the name `format`, or if
/// that is empty, the one of the extension. Fails with kInvalidValue.
[[nodiscard]] Result<const Codec*> codec_to_write(const std::filesystem::path& path, const std::string& format);

/// Returns whether a folder is a recording, such as a ROS 2 bag.
[[nodiscard]] bool is_recording_folder(const std::filesystem::path& path);

/// Returns the codec with this name. Fails with kInvalidValue, suggesting the nearest name.
[[nodiscard]] Result<const Codec*> find_codec(const std::string& name);

/// Returns the path of the file or folder that is read if a name is opened: the recording of "replay:FILE?speed=2", or
/// the file behind standard input. Returns an empty path if there is none (a camera, a pipe or a socket).
[[nodiscard]] std::filesystem::path file_of_recording(const std::string& name);

/// Opens a recording by name: a file or standard input ("-") with open_recording(), and with open_live_bytes() the name
/// of a camera (camera://NAME, replay:FILE, tcp://ADDRESS:PORT), a named pipe, or standard input that is a pipe or
/// socket. In a program without cameras, pipes are read as files. Fails as these functions do.
[[nodiscard]] Result<ReaderPtr> open_named_recording(const std::string& name, const OpenOptions& options = {});

/// Returns the rules for an output that is made from these inputs, which are named as open_named_recording() takes
/// them: files, replayed recordings, pipes and cameras. The output is live if the first input is not a file.
[[nodiscard]] OutputRules output_rules(const std::vector<std::filesystem::path>& inputs, bool overwrite);

/// Returns the same rules for a recording of this format, with its file of triggers.
[[nodiscard]] OutputRules recording_output_rules(const std::vector<std::filesystem::path>& inputs, bool overwrite,
                                                 const Codec& codec);

}  // namespace e2lf::recordings
