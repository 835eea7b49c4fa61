// SPDX-License-Identifier: MIT
#include "e2lf/formats/aedat/text_header.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::recordings::aedat {
namespace {

constexpr size_t kMaxHeaderBytes = size_t{1} << 24;

bool is_text(std::string_view line) {
  return std::all_of(line.begin(), line.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x20 || byte == '\t' || byte == '\r';
  });
}

bool is_last(std::string_view line) {
  return line.starts_with("!END-HEADER") || line.starts_with("End Of ASCII Header");
}

}  // namespace

std::optional<std::string> TextHeader::find(std::string_view key) const {
  for (const std::string& line : lines) {
    std::string_view rest = line;
    while (rest.starts_with(' ')) rest.remove_prefix(1);
    if (!rest.starts_with(key)) continue;
    rest.remove_prefix(key.size());
    const size_t begin = rest.find_first_not_of(" \t");
    return begin == std::string_view::npos ? "" : std::string(rest.substr(begin));
  }
  return std::nullopt;
}

Result<TextHeader> read_text_header(ByteSource& source) {
  TextHeader header;
  size_t wanted = kDetectBytes;
  E2LF_ASSIGN_OR_RETURN(auto bytes, source.fetch(wanted));
  for (bool is_done = false; !is_done;) {
    const std::string_view rest = as_text(bytes).substr(header.bytes);
    const size_t end = rest.find('\n');
    if (end == std::string_view::npos && rest.starts_with('#') && is_text(rest) && bytes.size() >= wanted) {
      if (wanted >= kMaxHeaderBytes) {
        return Error{ErrorCode::kFormat, "the AEDAT header has no end; record or copy the file again", source.name()};
      }
      wanted *= 2;
      E2LF_ASSIGN_OR_RETURN(bytes, source.fetch(wanted));
      continue;
    }
    std::string_view line = rest.substr(0, end);
    if (end == std::string_view::npos || !line.starts_with('#') || !is_text(line)) break;
    header.bytes += end + 1;
    line.remove_prefix(1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    header.lines.emplace_back(line);
    is_done = is_last(line);
  }
  source.consume(header.bytes);
  return header;
}

std::optional<CameraModel> find_camera_model(std::string_view name) {
  static constexpr CameraModel kKnown[] = {
      {"dvs128", 128, 128, false},    {"tmpdiff128", 128, 128, false}, {"davis240", 240, 180, true},
      {"davis346", 346, 260, true},   {"davis640", 640, 480, true},    {"davisrgb640", 640, 480, true},
      {"davis208", 208, 192, true},   {"davis128", 128, 128, true},    {"dvs240", 240, 180, true},
      {"dvxplorer", 640, 480, false}, {"dvs132", 132, 104, false}};
  const std::string text = lower_case(name);
  for (const CameraModel& known : kKnown) {
    if (text.find(known.name) != std::string::npos) return known;
  }
  return std::nullopt;
}

}  // namespace e2lf::recordings::aedat
