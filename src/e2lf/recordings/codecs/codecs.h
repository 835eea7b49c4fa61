// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <hdf5.h>
#include <span>

#include "e2lf/recordings/recording.h"

// The formats of the core: what is read and written of each, and the functions in the table of open/registry.cpp.
// Those that detect a format look at the first bytes of a file.

namespace e2lf::recordings {

/// Returns whether `head` begins with the header of a RAW recording (and not of a DAT file).
[[nodiscard]] bool is_raw_header(std::span<const uint8_t> head);

/// Opens a Prophesee RAW recording: EVT2, EVT2.1 (either byte order), EVT3 or EVT4, as its header or options.format
/// states.
[[nodiscard]] Result<ReaderPtr> open_raw(SourcePtr source, const OpenOptions& options);

/// Creates a RAW recording in info.format, or in EVT3 if that is not a RAW encoding that can be written.
[[nodiscard]] Result<WriterPtr> create_raw(SinkPtr sink, const RecordingInfo& info);

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

/// Opens a recording in this layout or in the one of add_layout(). Fails with kNotFound if the file has neither.
[[nodiscard]] Result<ReaderPtr> open(SourcePtr source, const OpenOptions& options);

/// Creates a recording. Chunks that ECF cannot represent (coordinates of 2048 and above, negative times) are stored
/// without compression.
[[nodiscard]] Result<WriterPtr> create_file(const std::filesystem::path& path, const RecordingInfo& info);

/// Opens the events of an HDF5 file that is not Metavision's; `info` contains its header and size.
using OpenLayout = Result<ReaderPtr> (*)(hid_t file, RecordingInfo info, const ByteSource& source,
                                         const OpenOptions& options);

/// Adds the other layouts of HDF5, which open() tries for files without CD.
void add_layout(OpenLayout open);

}  // namespace e2lf::recordings::hdf5_events
