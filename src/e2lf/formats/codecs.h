// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <span>

#include "e2lf/recordings/recording.h"

// The formats of this library: what is read and written of each, and the functions that formats.cpp registers. Those
// that detect a format look at the first bytes of a file.

namespace e2lf::recordings::dat {

/// Prophesee DAT: a text header, one byte each for the type and the size of records, then 8-byte records (u32 time in
/// us, u32 coordinates and polarity). Times wrap around after 71.6 minutes; the reader unwraps them, which requires
/// gaps between records of less than 17 minutes. Seeking uses the times of a few records. Triggers are
/// stored in a second file: name_trigger.dat for name_cd.dat or name.dat, which is read if it exists.

[[nodiscard]] bool detect(std::span<const uint8_t> head);
[[nodiscard]] Result<ReaderPtr> open(SourcePtr source, const OpenOptions& options);

/// Writes version 2 with the low 32 bits of the times. The first event must be before 2^32 us; otherwise writing fails
/// with kInvalidValue, and the recording must be shifted to zero. A sink only receives events; if the recording is a
/// file, triggers are written to a second one.
[[nodiscard]] Result<WriterPtr> create(SinkPtr sink, const RecordingInfo& info);
[[nodiscard]] Result<WriterPtr> create_file(const std::filesystem::path& path, const RecordingInfo& info);

/// Returns name_trigger.dat for name_cd.dat or name.dat.
[[nodiscard]] std::filesystem::path trigger_path(const std::filesystem::path& path);

/// Returns whether a file begins like a name_trigger.dat and not like a file of events.
[[nodiscard]] bool is_trigger_file(const std::filesystem::path& path);

}  // namespace e2lf::recordings::dat

namespace e2lf::recordings::aedat4 {

/// iniVation AEDAT 4: a version line, a FlatBuffer header, then packets (i32 stream, i32 size, compressed FlatBuffer).
/// The events of one stream are read: the one that options.stream selects, or that with the lowest number. Triggers are
/// those of all trigger streams, or, if there are several cameras, of the same camera. If no stream was selected,
/// packets of other event and trigger streams are counted as left out. Frames and inertial data are skipped. Trigger 0
/// is the external input and 1 the generator; a pulse counts as a rising edge; resets and frame marks are not triggers.
/// LZ4 and uncompressed packets are always supported, Zstd if the build has it. The table at the end of the file is not
/// needed: seeking skips from packet to packet without decompressing them.

[[nodiscard]] bool detect(std::span<const uint8_t> head);

/// Opens an AEDAT 4 recording. Fails with kFormat and kTruncated (header), kUnsupported (an unknown compression),
/// kMissingDependency (Zstd) and kInvalidValue (no stream with this name).
[[nodiscard]] Result<ReaderPtr> open(SourcePtr source, const OpenOptions& options);

}  // namespace e2lf::recordings::aedat4

namespace e2lf::recordings::aedat {

/// The older AEDAT formats. Both begin with lines of text; AEDAT 4 is a different format (codecs/aedat4).
///
/// AEDAT 2 (jAER): big-endian records of a 32-bit address and a 32-bit time in us. The meaning of the bits of an
/// address depends on the camera, a DVS128 or one of the DAVIS cameras, which the header may name ("# AEChip:
/// ...Davis240C"); otherwise, the size must be given, or all addresses of a file determine the kind. jAER counts rows
/// from the bottom and the columns of the address from the right; the events that are returned are counted from the top
/// left. The external input is trigger 0, and a pulse counts as a rising edge. Frames and inertial data are skipped.
/// Several DAVIS cameras, whose numbers are in the low four bits of the addresses, are several streams.
///
/// AEDAT 3 (cAER): little-endian packets of events of one type and source. Polarity and special events are read.
/// Triggers 0, 1 and 2 are the external inputs, and 3 is the generator; a pulse counts as a rising edge. Several
/// sources are several streams. Rows of AEDAT 3.0 are counted from the bottom, those of 3.1 from the top.
///
/// AEDAT 2 does not support fast seeking: a seek reads from the start.

[[nodiscard]] bool detect_aedat2(std::span<const uint8_t> head);
[[nodiscard]] bool detect_aedat3(std::span<const uint8_t> head);

/// Opens an AEDAT 2 recording. Fails with kFormat (no such header) and kInvalidValue (a size that contradicts the
/// header).
[[nodiscard]] Result<ReaderPtr> open_aedat2(SourcePtr source, const OpenOptions& options);

/// Opens an AEDAT 3 recording. Fails with kFormat (no such header), kUnsupported (compressed packets) and kInvalidValue
/// (no stream with this name).
[[nodiscard]] Result<ReaderPtr> open_aedat3(SourcePtr source, const OpenOptions& options);

}  // namespace e2lf::recordings::aedat

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
