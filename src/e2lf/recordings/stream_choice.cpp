// SPDX-License-Identifier: MIT
#include "e2lf/recordings/stream_choice.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::recordings {

namespace {

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
                                  Setting::kStream});
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
                 location, Setting::kStream};
  }
  return static_cast<size_t>(first - streams.begin());
}

}  // namespace e2lf::recordings
