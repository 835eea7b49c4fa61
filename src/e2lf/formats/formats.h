// SPDX-License-Identifier: MIT
#pragma once

namespace e2lf::formats {

/// Registers the formats of this library with add_codec(), as a program does with its own: text, numpy arrays, DSEC,
/// DAT, AEDAT 4, and bags of ROS 2. Further calls do nothing.
void add_formats();

}  // namespace e2lf::formats
