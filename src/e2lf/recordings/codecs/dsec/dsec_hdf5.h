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

/// Creates a recording in this layout, uncompressed. Its write() fails with kInvalidValue for times more than 71
/// minutes after the first event.
[[nodiscard]] Result<WriterPtr> create_dsec_file(const std::filesystem::path& path, const RecordingInfo& info);

/// Opens a table of events (event_places.h) whose columns have any numeric type. If there are several tables,
/// options.stream selects one by its number or name. OpenOptions::time_unit states the unit of the times. Assumptions
/// are added to `info`. Fails with kNotFound if the file contains no table, and with kShape if columns differ in
/// length.
struct TableOfEvents {
  BlocksPtr blocks;
  TimeUnit unit = TimeUnit::kMicroseconds;
  int64_t zero_us = 0;  ///< time of a row of zeros
};
[[nodiscard]] Result<TableOfEvents> open_columns(hid_t file, const OpenOptions& options, const std::string& location,
                                                 RecordingInfo& info);

}  // namespace e2lf::recordings::hdf5_events
