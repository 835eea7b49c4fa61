// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>
#include <vector>

#include "e2lf/recordings/io/hdf5_file.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::hdf5_events::dsec {

/// The location of a table of events in an HDF5 file.
struct EventPlace {
  std::string name;                    ///< name of the group or data set, for messages and --stream
  std::array<std::string, 4> columns;  ///< data sets of x, y, p and t; all empty if `rows` contains them
  std::string rows;                    ///< a data set [events, 4] or [4, events], or one of records
  std::array<std::string, 4> fields;   ///< names of x, y, p and t in records; all empty for a matrix
};

/// Returns the tables of events in a file: groups with data sets whose names denote the columns x, y, p and t
/// (table/layout.h), matrices whose name contains "event", and data sets of records with these fields. The usual
/// places (`events` and the root) come first, the others in the order of their paths. At most 10,000 objects are
/// inspected.
[[nodiscard]] std::vector<EventPlace> find_event_places(hid_t file);

/// Reads the size of the sensor from a file: the numbers width and height in the group of the events or in the root, as
/// data sets or attributes, or the attribute sensor_resolution = [height, width]. Does not change `info` if there are
/// none.
void read_sensor_size(hid_t file, const std::string& group, RecordingInfo& info);

}  // namespace e2lf::recordings::hdf5_events::dsec
