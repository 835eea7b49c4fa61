// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/io/hdf5_file.h"

namespace e2lf::recordings::hdf5_events {

/// The HDF5 layout of the DSEC data set: columns events/x, y (u2), p (u1), t (u4, us after t_offset), ms_to_idx (u8:
/// index of the first event at or after each millisecond after t_offset) and t_offset (i8, us). It has no place for
/// triggers.

/// Writes the layout, uncompressed. Fails in write() with kInvalidValue beyond 71 minutes after the first event.
[[nodiscard]] Result<std::unique_ptr<RecordingWriter>> create_dsec_file(const std::filesystem::path& path,
                                                                        const RecordingInfo& info);

/// Events as blocks, from the places of event_places.h, numbers of any type. Of several places options.stream chooses
/// one by its number or name. Times are as OpenOptions::time_unit says. What is assumed is added to `info`. Fails with
/// kNotFound when the file has no such place and kShape when columns differ in length.
[[nodiscard]] Result<std::unique_ptr<EventBlocks>> open_columns(hid_t file, const OpenOptions& options,
                                                                const std::string& location, RecordingInfo& info);

}  // namespace e2lf::recordings::hdf5_events
