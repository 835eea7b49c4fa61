// SPDX-License-Identifier: MIT
#include "e2lf/formats/formats.h"

#include <algorithm>
#include <mutex>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/recordings/codecs/codecs.h"
#include "e2lf/recordings/io/header_text.h"
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
       .is_folder = numpy::is_column_folder,
       .open_folder = numpy::open_column_folder,
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

std::string text_of(const NamedStream& stream) {
  std::string about = stream.name;
  if (!stream.camera.empty()) about += cat(about.empty() ? "" : " of ", stream.camera);
  return about.empty() ? stream.number : cat(stream.number, " (", header_text(about), ")");
}

}  // namespace

Result<size_t> choose_stream(const std::vector<NamedStream>& streams, const OpenOptions& options,
                             const std::string& location, RecordingInfo& info) {
  if (streams.empty()) return fail(ErrorCode::kFormat, location, "the recording has no stream of events");
  for (const NamedStream& stream : streams) info.streams.push_back(text_of(stream));
  const std::string& wanted = options.stream;
  if (wanted.empty()) {
    if (streams.size() > 1) {
      info.assumptions.push_back({cat("there are ", streams.size(), " streams of events, ", join(info.streams),
                                      ", of which the first is read and the others are left out"),
                                  "stream"});
    }
    return size_t{0};
  }
  const auto is_named = [&wanted](const NamedStream& stream) {
    return wanted == stream.number || wanted == stream.name || wanted == stream.camera;
  };
  // "left" of "davis/left/events".
  const auto is_in_path = [&wanted](const NamedStream& stream) {
    return cat("/", stream.name, "/").find(cat("/", wanted, "/")) != std::string::npos;
  };
  const bool has_named = std::any_of(streams.begin(), streams.end(), is_named);
  const auto is_wanted = [&](const NamedStream& stream) { return has_named ? is_named(stream) : is_in_path(stream); };
  const auto first = std::find_if(streams.begin(), streams.end(), is_wanted);
  const auto count = std::count_if(streams.begin(), streams.end(), is_wanted);
  if (count != 1) {
    return Error{ErrorCode::kInvalidValue,
                 cat(count == 0 ? "there is no stream of events named " : "there are several streams of events named ",
                     header_text(wanted), "; there are ", join(info.streams), ": choose one by its number"),
                 location, "stream"};
  }
  return static_cast<size_t>(first - streams.begin());
}

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
