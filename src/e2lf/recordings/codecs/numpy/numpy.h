// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::numpy {

/// Events as numpy arrays, in any order of time. A .npy file is one array of records with the fields x, y, p, t in any
/// order and of any type of numbers, or an array [events, 4]; we write OpenEB's records {x u2, y u2, p i2, t i8}, 16
/// bytes. It is streamed. An .npz file has the columns x, y, p, t as arrays of one length, or one array of records or
/// rows; trigger_p, trigger_id, trigger_t, and size = [width, height]; it is read and written whole, in memory.
/// Columns, names, units and polarities: table/layout.h.

[[nodiscard]] bool detect_npy(std::span<const uint8_t> head);
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_npy(std::unique_ptr<ByteSource> source,
                                                                const OpenOptions& options);
[[nodiscard]] Result<std::unique_ptr<RecordingWriter>> create_npy_file(const std::filesystem::path& path,
                                                                       const RecordingInfo& info);
/// Gives a file of create_npy_file()'s writer that was killed the number of events that are in it. Fails with kFormat
/// (no such file) and kIo.
[[nodiscard]] Result<void> recover_npy(const std::filesystem::path& path);

[[nodiscard]] bool detect_npz(std::span<const uint8_t> head);
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_npz(std::unique_ptr<ByteSource> source,
                                                                const OpenOptions& options);
[[nodiscard]] Result<std::unique_ptr<RecordingWriter>> create_npz(std::unique_ptr<ByteSink> sink,
                                                                  const RecordingInfo& info);

/// A folder as EVREAL reads it: events_ts.npy, events_xy.npy [events, 2], events_p.npy, and maybe metadata.json with
/// sensor_resolution = [height, width]. It is read whole, in memory.
[[nodiscard]] bool is_event_folder(const std::filesystem::path& path);
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_event_folder(const std::filesystem::path& path,
                                                                         const OpenOptions& options);

}  // namespace e2lf::recordings::numpy
