// SPDX-License-Identifier: MIT
#include "e2lf/formats/formats.h"

#include <mutex>
#include <vector>

#include "e2lf/formats/codecs.h"
#include "e2lf/recordings/codecs/codecs.h"
#include "e2lf/recordings/open/registry.h"
#include "e2lf/recordings/side_triggers.h"

namespace e2lf::formats {
namespace {

std::vector<Codec> all_formats() {
  return {
      {.name = "dat",
       .extensions = {".dat"},
       .detect = dat::detect,
       .open = dat::open,
       .create = dat::create,
       .create_file = dat::create_file,
       .side_file = dat::trigger_path,
       .is_side_file = dat::is_trigger_file},
      {.name = "aedat4", .extensions = {".aedat4"}, .detect = aedat4::detect, .open = aedat4::open},
      {.name = "rosbag",
       .extensions = {".db3"},
       .detect = rosbag::detect_sqlite,
       .open = rosbag::open_sqlite,
       .is_folder = rosbag::is_bag_folder,
       .open_folder = rosbag::open_folder},
      {.name = "mcap", .extensions = {".mcap"}, .detect = rosbag::detect_mcap, .open = rosbag::open_mcap},
      {.name = "dsec",
       .extensions = {".h5"},
       .is_table = true,
       .open = hdf5_events::open,
       .side_file = recordings::side_trigger_path},
      {.name = "npy",
       .extensions = {".npy"},
       .is_table = true,
       .detect = numpy::detect_npy,
       .open = numpy::open_npy,
       .side_file = recordings::side_trigger_path},
      {.name = "npz",
       .extensions = {".npz"},
       .is_table = true,
       .detect = numpy::detect_npz,
       .open = numpy::open_npz,
       .create = numpy::create_npz,
       .is_written_at_end = true},
      {.name = "csv",
       .extensions = {".csv"},
       .is_table = true,
       .detect = text::detect,
       .open = text::open_csv,
       .create = text::create_csv,
       .side_file = recordings::side_trigger_path},
      {.name = "txt",
       .extensions = {".txt"},
       .is_table = true,
       .open = text::open_txt,
       .side_file = recordings::side_trigger_path},
  };
}

}  // namespace

void add_formats() {
  static std::once_flag once;
  std::call_once(once, [] {
    std::vector<Codec> formats = all_formats();
    // Each one is placed before those that were added earlier.
    hdf5_events::add_layout(dsec::open_columns);
    for (auto format = formats.rbegin(); format != formats.rend(); ++format) recordings::add_codec(std::move(*format));
  });
}

}  // namespace e2lf::formats
