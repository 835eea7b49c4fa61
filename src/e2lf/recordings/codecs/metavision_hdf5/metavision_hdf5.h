// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::hdf5_events {

/// Metavision HDF5: /CD/events as records {x u2, y u2, p i2, t i8} in chunks of 16384 under the ECF filter, which is
/// applied here and needs no plugin; /EXT_TRIGGER/events; /CD/indexes and /EXT_TRIGGER/indexes (one entry per 2 ms);
/// the camera's header as attributes of the root. Other filters are read when the HDF5 library has them.

/// True for any HDF5 file.
[[nodiscard]] bool detect(std::span<const uint8_t> head);

/// Also reads the DSEC layout (see dsec_hdf5.h). Fails with kNotFound when the file has neither.
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open(std::unique_ptr<ByteSource> source,
                                                            const OpenOptions& options);

/// A chunk that ECF cannot hold (coordinates of 2048 and above, negative times) is stored without compression.
[[nodiscard]] Result<std::unique_ptr<RecordingWriter>> create_file(const std::filesystem::path& path,
                                                                   const RecordingInfo& info);

/// Fails where a file whose writer was killed cannot be read: within the first second of writing.
[[nodiscard]] Result<void> recover(const std::filesystem::path& path);

}  // namespace e2lf::recordings::hdf5_events
