// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "e2lf/recordings/recording.h"

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
