// SPDX-License-Identifier: MIT
#include "e2lf/formats/formats.h"

#include <mutex>
#include <vector>

#include "e2lf/formats/codecs.h"
#include "e2lf/recordings/open/registry.h"

namespace e2lf::formats {
namespace {

using recordings::Codec;
namespace aedat = recordings::aedat;
namespace aedat4 = recordings::aedat4;
namespace dat = recordings::dat;
namespace rosbag = recordings::rosbag;

std::vector<Codec> all_formats() {
  return {
      {.name = "dat",
       .extensions = {".dat"},
       .description = "Prophesee DAT",
       .detect = dat::detect,
       .open = dat::open,
       .create = dat::create,
       .create_file = dat::create_file,
       .side_file = dat::trigger_path,
       .is_side_file = dat::is_trigger_file},
      {.name = "aedat4",
       .extensions = {".aedat4"},
       .description = "iniVation AEDAT 4",
       .detect = aedat4::detect,
       .open = aedat4::open},
      {.name = "aedat2",
       .extensions = {".aedat", ".aedat2"},
       .description = "AEDAT 2 of jAER",
       .detect = aedat::detect_aedat2,
       .open = aedat::open_aedat2},
      {.name = "aedat3", .description = "AEDAT 3 of cAER", .detect = aedat::detect_aedat3, .open = aedat::open_aedat3},
      {.name = "rosbag",
       .extensions = {".db3"},
       .description = "ROS 2 bag, stored with SQLite",
       .detect = rosbag::detect_sqlite,
       .open = rosbag::open_sqlite,
       .is_folder = rosbag::is_bag_folder,
       .open_folder = rosbag::open_folder},
      {.name = "mcap",
       .extensions = {".mcap"},
       .description = "ROS 2 bag, stored as MCAP",
       .detect = rosbag::detect_mcap,
       .open = rosbag::open_mcap},
  };
}

}  // namespace

void add_formats() {
  static std::once_flag once;
  std::call_once(once, [] {
    std::vector<Codec> formats = all_formats();
    // Each one is placed before those that were added earlier.
    for (auto format = formats.rbegin(); format != formats.rend(); ++format) recordings::add_codec(std::move(*format));
  });
}

}  // namespace e2lf::formats
