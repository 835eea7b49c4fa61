// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "e2lf/events/recording.h"

namespace e2lf::events::npy_events {

/// Events as numpy arrays. A .npy file is one array of records with the fields x, y, p, t (also "polarity", "on",
/// "ts", "timestamp") in any order and of any integer type; we write OpenEB's {x u2, y u2, p i2, t i8}, 16 bytes. It is
/// streamed. An .npz file has the columns x, y, p, t as arrays of one length, trigger_p, trigger_id, trigger_t, and
/// size = [width, height]; it is read and written whole, in memory. Times are microseconds, polarities 0/1 or -1/1.

[[nodiscard]] bool detect_npy(std::span<const uint8_t> head);
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_npy(std::unique_ptr<ByteSource> source,
                                                                const OpenOptions& options);
[[nodiscard]] Result<std::unique_ptr<RecordingWriter>> create_npy_file(const std::filesystem::path& path,
                                                                       const RecordingInfo& info);

[[nodiscard]] bool detect_npz(std::span<const uint8_t> head);
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_npz(std::unique_ptr<ByteSource> source,
                                                                const OpenOptions& options);
[[nodiscard]] Result<std::unique_ptr<RecordingWriter>> create_npz(std::unique_ptr<ByteSink> sink,
                                                                  const RecordingInfo& info);

}  // namespace e2lf::events::npy_events
