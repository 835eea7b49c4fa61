// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>
#include <vector>

#include "e2lf/recordings/io/hdf5_file.h"

namespace e2lf::recordings::hdf5_events {

/// Where an HDF5 file holds a table of events.
struct EventPlace {
  std::string name;                    ///< for people and --stream: the group, or the data set
  std::array<std::string, 4> columns;  ///< data sets of x, y, p and t; all empty where `rows` holds all of them
  std::string rows;                    ///< a data set [events, 4] or [4, events], or one of records
  std::array<std::string, 4> fields;   ///< of records: the names of x, y, p and t; all empty for a matrix
};

/// Returns the tables of events in a file, in the order of their paths and the usual places (`events`, the file itself)
/// first: groups with data sets that are named as the columns x, y, p and t (table/column_names.h), matrices whose name
/// has "event" in it, and data sets of records with these fields. Where the usual places hold some columns but not all,
/// the missing ones keep the names by which errors call them. At most 10,000 objects are looked at.
[[nodiscard]] std::vector<EventPlace> find_event_places(hid_t file);

}  // namespace e2lf::recordings::hdf5_events
