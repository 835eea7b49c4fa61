// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <hdf5.h>
#include <span>
#include <string>
#include <vector>

#include "e2lf/recordings/recording.h"

// The formats of this library: what is read and written of each, the functions that formats.cpp registers, and the
// choice of a stream, which several of them share. Functions that detect a format look at the first bytes of a file.

namespace e2lf::formats {
using namespace recordings;

/// A stream of events in a container that may hold several.
struct NamedStream {
  std::string number;  ///< the number that the file assigns
  std::string name;    ///< e.g. "events" or "/camera/events"; may be empty
  std::string camera;  ///< e.g. "DAVIS346_00000104"; may be empty
};

/// Returns the index of the stream that options.stream selects by number, name or camera, or that of the first one if
/// it is empty. Lists the streams in info.streams and, if several exist and none was selected, adds the assumption that
/// the others are left out. Fails with kInvalidValue if no stream or more than one matches, and with kFormat if there
/// are none.
[[nodiscard]] Result<size_t> choose_stream(const std::vector<NamedStream>& streams, const OpenOptions& options,
                                           const std::string& location, RecordingInfo& info);

}  // namespace e2lf::formats

namespace e2lf::formats::dat {

/// Prophesee DAT: a text header, one byte each for the type and the size of records, then 8-byte records (u32 time in
/// us, u32 coordinates and polarity). Times wrap around after 71.6 minutes; the reader unwraps them, which requires
/// gaps between records of less than 17 minutes. A seek reads from the start. Triggers are stored in a second file:
/// name_trigger.dat for name_cd.dat or name.dat, which is read if it exists.

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

}  // namespace e2lf::formats::dat

namespace e2lf::formats::aedat4 {

/// iniVation AEDAT 4: a version line, a FlatBuffer header, then packets (i32 stream, i32 size, compressed FlatBuffer).
/// The events of one stream are read: the one that options.stream selects, or that with the lowest number. Triggers are
/// those of all trigger streams, or, if there are several cameras, of the same camera. If no stream was selected,
/// packets of other event and trigger streams are counted as left out. Frames and inertial data are skipped. Trigger 0
/// is the external input and 1 the generator; a pulse counts as a rising edge; resets and frame marks are not triggers.
/// LZ4 and uncompressed packets are always supported, Zstd if the build has it. The table at the end of the file is not
/// needed, and a seek reads from the start.

[[nodiscard]] bool detect(std::span<const uint8_t> head);

/// Opens an AEDAT 4 recording. Fails with kFormat and kTruncated (header), kUnsupported (an unknown compression),
/// kMissingDependency (Zstd) and kInvalidValue (no stream with this name).
[[nodiscard]] Result<ReaderPtr> open(SourcePtr source, const OpenOptions& options);

}  // namespace e2lf::formats::aedat4

namespace e2lf::formats::rosbag {

/// Bags of ROS 2: an SQLite database (.db3), an MCAP file, or a folder of either.
///
/// Supported messages are event_camera_msgs/EventPacket and event_array_msgs/EventArray in the encodings evt3, mono
/// and trigger, and dvs_msgs/EventArray and prophesee_event_msgs/EventArray. Each topic of such
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

/// Returns whether a folder contains files of a bag.
[[nodiscard]] bool is_bag_folder(const std::filesystem::path& path);

/// Opens the files of a folder in the order of their numbers.
[[nodiscard]] Result<ReaderPtr> open_folder(const std::filesystem::path& path, const OpenOptions& options);

}  // namespace e2lf::formats::rosbag

namespace e2lf::formats::dsec {

/// The HDF5 layout of the DSEC data set: columns events/x, y (u2), p (u1), t (u4, us after t_offset), ms_to_idx (u8:
/// index of the first event at or after each millisecond after t_offset) and t_offset (i8, us).

/// Opens the table of events in an HDF5 file that is not Metavision's, with columns of any numeric type. If there are
/// several tables, options.stream selects one by its number or name. Fails with kNotFound if the file contains no
/// table, and with kShape if columns differ in length.
[[nodiscard]] Result<ReaderPtr> open_columns(hid_t file, RecordingInfo info, const ByteSource& source,
                                             const OpenOptions& options);

}  // namespace e2lf::formats::dsec

namespace e2lf::formats::numpy {

/// Events as numpy arrays, which are read as a whole, in memory. A .npy file is an array of records with the fields x,
/// y, p, t in any order and of any numeric type, or an array [events, 4]. An .npz file contains the columns x, y, p, t
/// as arrays of equal length, or one array of records or rows, and optionally trigger_p, trigger_id, trigger_t, and
/// size = [width, height]; it is also written. A folder may contain the columns as .npy files with their names, as in
/// EVIMO2: events_t.npy, events_xy.npy [events, 2], events_p.npy. table/table.h describes columns, names, units and
/// polarities.

[[nodiscard]] bool detect_npy(std::span<const uint8_t> head);
[[nodiscard]] Result<ReaderPtr> open_npy(SourcePtr source, const OpenOptions& options);

/// Returns whether a folder contains all columns of events as .npy files.
[[nodiscard]] bool is_column_folder(const std::filesystem::path& path);
[[nodiscard]] Result<ReaderPtr> open_column_folder(const std::filesystem::path& path, const OpenOptions& options);

[[nodiscard]] bool detect_npz(std::span<const uint8_t> head);
[[nodiscard]] Result<ReaderPtr> open_npz(SourcePtr source, const OpenOptions& options);
[[nodiscard]] Result<WriterPtr> create_npz(SinkPtr sink, const RecordingInfo& info);

}  // namespace e2lf::formats::numpy

namespace e2lf::formats::text {

/// Events as lines of text. Written are lines x,y,p,t with t in integral microseconds, below "%geometry:W,H" or, if the
/// size is not known, "%x,y,p,t". Readers accept columns with names in any order and unit (table/table.h), other
/// separators and comments. In a .txt without names, the columns are t x y p, with t in seconds. Lines that are not
/// events are dropped (kBadRecord); if most are not, opening or reading fails with kFormat.

/// Returns whether the first lines are rows of numbers.
[[nodiscard]] bool detect(std::span<const uint8_t> head);

[[nodiscard]] Result<ReaderPtr> open_csv(SourcePtr source, const OpenOptions& options);
[[nodiscard]] Result<ReaderPtr> open_txt(SourcePtr source, const OpenOptions& options);

[[nodiscard]] Result<WriterPtr> create_csv(SinkPtr sink, const RecordingInfo& info);

}  // namespace e2lf::formats::text
