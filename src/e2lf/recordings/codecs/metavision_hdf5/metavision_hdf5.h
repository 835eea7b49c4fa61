// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::hdf5_events {

/// Metavision HDF5: /CD/events with records {x u2, y u2, p i2, t i8} in chunks of 16384 with the ECF filter, which is
/// implemented here and requires no plugin; /EXT_TRIGGER/events; /CD/indexes and /EXT_TRIGGER/indexes (one entry per 2
/// ms); and the camera's header as attributes of the root. Other filters are supported if the HDF5 library has them.

/// Returns true for any HDF5 file.
[[nodiscard]] bool detect(std::span<const uint8_t> head);

/// Opens a recording in this layout or in that of DSEC (see dsec_hdf5.h). Fails with kNotFound if the file has neither.
[[nodiscard]] Result<ReaderPtr> open(SourcePtr source, const OpenOptions& options);

/// Creates a recording. Chunks that ECF cannot represent (coordinates of 2048 and above, negative times) are stored
/// without compression.
[[nodiscard]] Result<WriterPtr> create_file(const std::filesystem::path& path, const RecordingInfo& info);

/// Fails if a file whose writer was killed cannot be read, that is, within the first second of writing.
[[nodiscard]] Result<void> recover(const std::filesystem::path& path);

}  // namespace e2lf::recordings::hdf5_events
