// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "e2lf/events/event_blocks.h"
#include "e2lf/events/hdf5/hdf5_file.h"

namespace e2lf::events::hdf5 {

/// The HDF5 layout of the DSEC data set: columns events/x, y (u2), p (u1), t (u4, us after t_offset), ms_to_idx (u8:
/// index of the first event at or after each millisecond after t_offset) and t_offset (i8, us). It has no place for
/// triggers.

/// Writes the layout, uncompressed. Fails in write() with kInvalidValue beyond 71 minutes after the first event.
[[nodiscard]] Result<std::unique_ptr<RecordingWriter>> create_dsec_file(const std::filesystem::path& path,
                                                                        const RecordingInfo& info);

/// The columns as blocks. Fails with kNotFound when the file does not have them and kShape when they differ in length.
[[nodiscard]] Result<std::unique_ptr<EventBlocks>> open_dsec(hid_t file, const std::string& location);

}  // namespace e2lf::events::hdf5
