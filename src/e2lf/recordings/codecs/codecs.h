// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <span>

#include "e2lf/recordings/recording.h"

// The formats of the library: what is read and written of each, and the functions in the table of open/registry.cpp.
// Those that detect a format look at the first bytes of a file.

namespace e2lf::recordings {

/// Opens a Prophesee RAW recording: EVT2, EVT2.1 (either byte order), EVT3 or EVT4, as its header or options.format
/// states.
[[nodiscard]] Result<ReaderPtr> open_raw(SourcePtr source, const OpenOptions& options);

/// Creates a RAW recording in info.format, or in EVT3 if that is not a RAW encoding.
[[nodiscard]] Result<WriterPtr> create_raw(SinkPtr sink, const RecordingInfo& info);

/// Create a RAW recording in one of the encodings.
[[nodiscard]] Result<WriterPtr> create_evt2(SinkPtr sink, const RecordingInfo& info);
[[nodiscard]] Result<WriterPtr> create_evt21(SinkPtr sink, const RecordingInfo& info);
[[nodiscard]] Result<WriterPtr> create_evt3(SinkPtr sink, const RecordingInfo& info);

}  // namespace e2lf::recordings

namespace e2lf::recordings::evt4 {

/// Returns a reader of EVT4 words, which begin at the position of the source; `info` contains the header. Times
/// continue where the 34-bit clock wraps around, after 4 h 46 min.
[[nodiscard]] ReaderPtr make_reader(SourcePtr source, RecordingInfo info, const OpenOptions& options);

}  // namespace e2lf::recordings::evt4

namespace e2lf::recordings::hdf5_events {

/// Metavision HDF5: /CD/events with records {x u2, y u2, p i2, t i8} in chunks of 16384 with the ECF filter, which is
/// implemented here and requires no plugin; /EXT_TRIGGER/events; /CD/indexes and /EXT_TRIGGER/indexes (one entry per 2
/// ms); and the camera's header as attributes of the root. Other filters are supported if the HDF5 library has them.

/// Returns true for any HDF5 file.
[[nodiscard]] bool detect(std::span<const uint8_t> head);

/// Opens a recording in this layout or in that of DSEC (below). Fails with kNotFound if the file has neither.
[[nodiscard]] Result<ReaderPtr> open(SourcePtr source, const OpenOptions& options);

/// Creates a recording. Chunks that ECF cannot represent (coordinates of 2048 and above, negative times) are stored
/// without compression.
[[nodiscard]] Result<WriterPtr> create_file(const std::filesystem::path& path, const RecordingInfo& info);

/// Fails if a file whose writer was killed cannot be read, that is, within the first second of writing.
[[nodiscard]] Result<void> recover(const std::filesystem::path& path);

/// The HDF5 layout of the DSEC data set: columns events/x, y (u2), p (u1), t (u4, us after t_offset), ms_to_idx (u8:
/// index of the first event at or after each millisecond after t_offset) and t_offset (i8, us). It has no place for
/// triggers.

/// Creates a recording in this layout, uncompressed. Its write() fails with kInvalidValue for times more than 71
/// minutes after the first event.
[[nodiscard]] Result<WriterPtr> create_dsec_file(const std::filesystem::path& path, const RecordingInfo& info);

}  // namespace e2lf::recordings::hdf5_events

namespace e2lf::recordings::numpy {

/// Events as numpy arrays, in any order of time. A .npy file is an array of records with the fields x, y, p, t in any
/// order and of any numeric type, or an array [events, 4]. It is streamed. Written are OpenEB's records {x u2, y u2, p
/// i2, t i8}, 16 bytes. An .npz file contains the columns x, y, p, t as arrays of equal length, or one array of records
/// or rows, and optionally trigger_p, trigger_id, trigger_t, and size = [width, height]. It is read and written as a
/// whole, in memory. table/layout.h describes columns, names, units and polarities.

[[nodiscard]] bool detect_npy(std::span<const uint8_t> head);
[[nodiscard]] Result<ReaderPtr> open_npy(SourcePtr source, const OpenOptions& options);
[[nodiscard]] Result<WriterPtr> create_npy_file(const std::filesystem::path& path, const RecordingInfo& info);
/// Corrects the number of events in a file whose create_npy_file() writer was killed. Fails with kFormat (not such a
/// file) and kIo.
[[nodiscard]] Result<void> recover_npy(const std::filesystem::path& path);

[[nodiscard]] bool detect_npz(std::span<const uint8_t> head);
[[nodiscard]] Result<ReaderPtr> open_npz(SourcePtr source, const OpenOptions& options);
[[nodiscard]] Result<WriterPtr> create_npz(SinkPtr sink, const RecordingInfo& info);

/// Opens an array [4, events], or one of [events, 4] in Fortran order, which is read as a whole, in memory.
[[nodiscard]] Result<ReaderPtr> open_npy_columns(SourcePtr source, const OpenOptions& options);

/// A folder with a .npy file for each field of an event, as those of EVREAL (events_ts, events_xy [events, 2],
/// events_p) and EV-IMO have, and optionally metadata.json with sensor_resolution = [height, width]. It is read as a
/// whole, in memory.
[[nodiscard]] bool is_event_folder(const std::filesystem::path& path);
[[nodiscard]] Result<ReaderPtr> open_event_folder(const std::filesystem::path& path, const OpenOptions& options);

}  // namespace e2lf::recordings::numpy

namespace e2lf::recordings::text {

/// Events as lines of text. Two orders are written:
///   csv: x,y,p,t   t in integral microseconds; first line "%geometry:W,H" if the size is known
///   txt: t x y p   t in seconds with six decimals; first line "W H" if the size is known
/// If the size of a .csv is not known, its first line is "%x,y,p,t". Readers accept columns with names in any order and
/// unit (table/layout.h), other separators and comments. Lines that are not events are dropped (kBadRecord); if most
/// are not, opening or reading fails with kFormat.

/// Returns whether the first lines are rows of numbers.
[[nodiscard]] bool detect(std::span<const uint8_t> head);

[[nodiscard]] Result<ReaderPtr> open_csv(SourcePtr source, const OpenOptions& options);
[[nodiscard]] Result<ReaderPtr> open_txt(SourcePtr source, const OpenOptions& options);

[[nodiscard]] Result<WriterPtr> create_csv(SinkPtr sink, const RecordingInfo& info);
[[nodiscard]] Result<WriterPtr> create_txt(SinkPtr sink, const RecordingInfo& info);

}  // namespace e2lf::recordings::text
