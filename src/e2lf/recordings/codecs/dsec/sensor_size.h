// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/recordings/io/hdf5_file.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::hdf5_events {

/// Reads the size of the sensor from a file: the numbers width and height in the group of the events or in the root, as
/// data sets or attributes, or the attribute sensor_resolution = [height, width]. Does not change `info` if there are
/// none.
void read_sensor_size(hid_t file, const std::string& group, RecordingInfo& info);

}  // namespace e2lf::recordings::hdf5_events
