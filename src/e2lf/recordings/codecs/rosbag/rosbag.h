// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::rosbag {

/// Bags of ROS 2: an SQLite database (.db3), an MCAP file, or a folder of either with a metadata.yaml.
///
/// Supported messages are event_camera_msgs/EventPacket and event_array_msgs/EventArray in the encodings evt3, mono,
/// trigger, libcaer and libcaer_cmp, and dvs_msgs/EventArray and prophesee_event_msgs/EventArray. Each topic of such
/// messages is a stream; the first one is read if options.stream does not select another. Triggers come from the same
/// messages, or from a topic beside them whose name ends in "trigger". If no stream was selected, messages of other
/// event topics are counted as left out; gaps in the packet numbers are counted, too. Times are those of the sensor in
/// integral microseconds: with evt3 those of its clock, otherwise counted from 1970. Zstd compression of messages and
/// chunks is supported in builds with Zstd.

[[nodiscard]] bool detect_sqlite(std::span<const uint8_t> head);
[[nodiscard]] bool detect_mcap(std::span<const uint8_t> head);

/// Opens a bag. A database that does not come from a file is read into memory. Fails with kFormat (damaged, not a bag,
/// or no event topic), kMissingDependency (SQLite, Zstd), kUnsupported (an unknown encoding) and kInvalidValue (no
/// stream with this name).
[[nodiscard]] Result<ReaderPtr> open_sqlite(SourcePtr source, const OpenOptions& options);
[[nodiscard]] Result<ReaderPtr> open_mcap(SourcePtr source, const OpenOptions& options);

/// Returns whether a folder contains a metadata.yaml and files of a bag.
[[nodiscard]] bool is_bag_folder(const std::filesystem::path& path);

/// Opens the files of a folder in the order of metadata.yaml.
[[nodiscard]] Result<ReaderPtr> open_folder(const std::filesystem::path& path, const OpenOptions& options);

}  // namespace e2lf::recordings::rosbag
