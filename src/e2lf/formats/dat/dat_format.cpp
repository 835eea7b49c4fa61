// SPDX-License-Identifier: MIT
#include "e2lf/formats/dat/dat_format.h"

#include <charconv>
#include <string_view>

#include "e2lf/base/text.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::recordings::dat {
namespace {

size_t number_or_zero(const std::optional<std::string>& text) {
  size_t value = 0;
  if (text) std::from_chars(text->data(), text->data() + text->size(), value);
  return value > 65536 ? 0 : value;
}

}  // namespace

std::optional<Header> parse_header(std::span<const uint8_t> head) {
  auto lines = parse_percent_header(as_text(head), /*ended=*/true);
  if (!lines || lines->keys.empty() || head.size() < lines->num_bytes + 2) return std::nullopt;
  Header header;
  header.info.format = "dat";
  header.info.header = std::move(lines->keys);
  header.bytes = lines->num_bytes + 2;
  if (header.info.find("evt") || header.info.find("format")) return std::nullopt;
  header.type = head[lines->num_bytes];
  const bool known = header.type == kTypeEvent2d || header.type == kTypeCd || header.type == kTypeTrigger;
  if (!known || head[lines->num_bytes + 1] != kRecordBytes) return std::nullopt;
  if (const auto version = number_or_zero(header.info.find("Version")); version != 0) {
    header.version = static_cast<int>(version);
  }
  header.info.width = number_or_zero(header.info.find("Width"));
  header.info.height = number_or_zero(header.info.find("Height"));
  return header;
}

std::string make_header(const RecordingInfo& info, uint8_t type) {
  std::string text = cat("% Data file containing ", type == kTypeTrigger ? "external trigger" : "CD", " events.\n");
  text += "% Version 2\n";
  if (const auto date = info.find("date")) text += cat("% Date ", header_text(*date), "\n");
  if (info.height != 0) text += cat("% Height ", info.height, "\n");
  if (info.width != 0) text += cat("% Width ", info.width, "\n");
  text += "% end\n";
  text += static_cast<char>(type);
  text += static_cast<char>(kRecordBytes);
  return text;
}

}  // namespace e2lf::recordings::dat
