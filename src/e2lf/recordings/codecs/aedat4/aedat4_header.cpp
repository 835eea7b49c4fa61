// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/aedat4/aedat4_header.h"

#include <charconv>

#include "e2lf/base/text.h"
#include "e2lf/recordings/codecs/aedat4/flatbuffer.h"

namespace e2lf::recordings::aedat4 {
namespace {

constexpr size_t kCompressionField = 0, kTableField = 1, kInfoField = 2;

/// Returns the value of attribute `key` in a tag, e.g. path in <node name="0" path="/outInfo/0/">.
std::string_view attribute(std::string_view tag, std::string_view key) {
  const size_t begin = tag.find(cat(" ", key, "=\""));
  if (begin == std::string_view::npos) return {};
  const size_t value = begin + key.size() + 3;
  const size_t end = tag.find('"', value);
  return end == std::string_view::npos ? std::string_view() : tag.substr(value, end - value);
}

/// Returns the number in a path ".../outInfo/<number>/" or ".../outInfo/<number>/info/".
std::optional<int32_t> stream_of_path(std::string_view path) {
  const size_t place = path.find("/outInfo/");
  if (place == std::string_view::npos) return std::nullopt;
  const std::string_view rest = path.substr(place + 9);
  int32_t id = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), id);
  if (error != std::errc() || end == rest.data() + rest.size() || *end != '/') return std::nullopt;
  return id;
}

size_t size_of_text(std::string_view text) {
  size_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value <= 65536 ? value : 0;
}

Stream& stream_with(std::vector<Stream>& streams, int32_t id) {
  for (Stream& stream : streams) {
    if (stream.id == id) return stream;
  }
  streams.push_back({});
  streams.back().id = id;
  return streams.back();
}

}  // namespace

std::vector<Stream> parse_streams(std::string_view xml) {
  std::vector<Stream> streams;
  std::optional<int32_t> current;
  for (size_t begin = xml.find('<'); begin != std::string_view::npos; begin = xml.find('<', begin + 1)) {
    const size_t end = xml.find('>', begin);
    if (end == std::string_view::npos) break;
    const std::string_view tag = xml.substr(begin, end - begin);
    if (tag.starts_with("<node")) {
      current = stream_of_path(attribute(tag, "path"));
    } else if (tag.starts_with("<attr") && current) {
      const std::string_view key = attribute(tag, "key");
      const std::string_view value = xml.substr(end + 1, xml.find('<', end) - end - 1);
      Stream& stream = stream_with(streams, *current);
      if (key == "typeIdentifier") stream.type = value;
      if (key == "sizeX") stream.width = size_of_text(value);
      if (key == "sizeY") stream.height = size_of_text(value);
      if (key == "source") stream.source = value;
      if (key == "originalOutputName") stream.output = value;
    }
  }
  return streams;
}

std::optional<size_t> header_size(std::span<const uint8_t> head) {
  const size_t line = kVersionLine.size();
  if (head.size() < line + 4) return std::nullopt;
  if (std::string_view(reinterpret_cast<const char*>(head.data()), line) != kVersionLine) return std::nullopt;
  return line + 4 + load_le<uint32_t>(head.data() + line);
}

Result<Header> parse_header(std::span<const uint8_t> bytes, const std::string& name) {
  Header header;
  const auto size = header_size(bytes);
  const Error malformed{ErrorCode::kFormat, "the AEDAT4 header is damaged; record or copy the file again", name};
  if (!size || *size > bytes.size()) return malformed;
  header.bytes = *size;
  const size_t begin = kVersionLine.size() + 4;
  const FlatBuffer buffer(bytes.subspan(begin, *size - begin));
  const auto root = buffer.root("IOHE");
  if (!root) return malformed;
  header.compression = static_cast<Compression>(buffer.number_field<int32_t>(*root, kCompressionField, 0));
  const auto table = buffer.number_field<int64_t>(*root, kTableField, -1);
  header.table_position = table > 0 ? static_cast<uint64_t>(table) : 0;
  const auto info = buffer.vector_field(*root, kInfoField, 1);
  if (!info) return malformed;
  header.streams = parse_streams({reinterpret_cast<const char*>(info->data()), info->size()});
  return header;
}

}  // namespace e2lf::recordings::aedat4
