// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::rosbag {

/// Bags of ROS 2: an SQLite database (.db3), an MCAP file, or a folder of either with a metadata.yaml.
///
/// Read are the messages event_camera_msgs/EventPacket and event_array_msgs/EventArray in the encodings evt3, mono,
/// trigger, libcaer and libcaer_cmp, and dvs_msgs/EventArray and prophesee_event_msgs/EventArray. Each topic of such
/// messages is a stream; of several, the first is read where options.stream names no other. Triggers come from the
/// events' own messages, or from a topic beside them whose name ends in "trigger". Messages of other topics of events
/// are counted as left out where no stream was named, and so is each place where numbers of packets are missing. Times
/// are those of the sensor, whole microseconds; those of evt3 are the sensor's clock, the others count from 1970.
/// Messages or chunks compressed by Zstd are read where the build has it.

[[nodiscard]] bool detect_sqlite(std::span<const uint8_t> head);
[[nodiscard]] bool detect_mcap(std::span<const uint8_t> head);

/// A database that does not come from a file is read into memory. Both fail with kFormat (damaged, no bag, no topic of
/// events), kMissingDependency (SQLite, Zstd), kUnsupported (an unknown encoding) and kInvalidValue (no stream of that
/// name).
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_sqlite(std::unique_ptr<ByteSource> source,
                                                                   const OpenOptions& options);
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_mcap(std::unique_ptr<ByteSource> source,
                                                                 const OpenOptions& options);

/// Whether a folder holds a metadata.yaml and files of a bag.
[[nodiscard]] bool is_bag_folder(const std::filesystem::path& path);

/// The files of a folder in the order of metadata.yaml.
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_folder(const std::filesystem::path& path,
                                                                   const OpenOptions& options);

}  // namespace e2lf::recordings::rosbag
