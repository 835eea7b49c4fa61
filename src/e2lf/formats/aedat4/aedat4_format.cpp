// SPDX-License-Identifier: MIT
#include "e2lf/formats/aedat4/aedat4_format.h"

#include <charconv>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::formats::aedat4 {
namespace {

/// Reads the fields of a FlatBuffer. Every offset is checked against the buffer, so that damage yields nothing instead
/// of a wrong value. (A table begins with the distance back to its vtable, which lists the offsets of the fields.
/// Strings, vectors and sub-tables are referenced by u32 offsets.)
class FlatBuffer {
 public:
  explicit FlatBuffer(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  /// Returns the position of the root table if the identifier of the buffer is `id` (four characters).
  [[nodiscard]] std::optional<size_t> root(std::string_view id) const {
    const auto place = follow(0);
    if (!place || bytes_.size() < 8 || as_text(bytes_.subspan(4, 4)) != id) return std::nullopt;
    return place;
  }

  /// Returns the position of field number `field` of the table, or nothing if it has its default value or is damaged.
  [[nodiscard]] std::optional<size_t> field(size_t table, size_t field) const {
    const auto back = number<int32_t>(table);
    if (!back) return std::nullopt;
    const int64_t vtable = static_cast<int64_t>(table) - *back;
    if (vtable < 0) return std::nullopt;
    const auto vtable_size = number<uint16_t>(static_cast<size_t>(vtable));
    const size_t entry = 4 + 2 * field;
    if (!vtable_size || entry + 2 > *vtable_size) return std::nullopt;
    const auto offset = number<uint16_t>(static_cast<size_t>(vtable) + entry);
    if (!offset || *offset == 0) return std::nullopt;
    return table + *offset;
  }

  template <typename T>
  [[nodiscard]] std::optional<T> number(size_t place) const {
    if (place > bytes_.size() || bytes_.size() - place < sizeof(T)) return std::nullopt;
    return load_le<T>(bytes_.data() + place);
  }

  /// Returns the value of a numeric field, or its default.
  template <typename T>
  [[nodiscard]] T number_field(size_t table, size_t index, T default_value) const {
    const auto place = field(table, index);
    return place ? number<T>(*place).value_or(default_value) : default_value;
  }

  /// Returns the elements of a vector field, or the characters of a string field, with `element_size` bytes each.
  [[nodiscard]] std::optional<std::span<const uint8_t>> vector_field(size_t table, size_t index,
                                                                     size_t element_size) const {
    const auto place = field(table, index);
    const auto vector = place ? follow(*place) : std::nullopt;
    const auto count = vector ? number<uint32_t>(*vector) : std::nullopt;
    if (!count || (bytes_.size() - *vector - 4) / element_size < *count) return std::nullopt;
    return bytes_.subspan(*vector + 4, *count * element_size);
  }

  /// Returns the position to which the u32 offset at `place` points.
  [[nodiscard]] std::optional<size_t> follow(size_t place) const {
    const auto offset = number<uint32_t>(place);
    if (!offset || *offset > bytes_.size() - place) return std::nullopt;
    return place + *offset;
  }

  /// Returns the position of an element of a vector that vector_field() returned.
  [[nodiscard]] size_t place_of(const uint8_t* element) const { return static_cast<size_t>(element - bytes_.data()); }

 private:
  std::span<const uint8_t> bytes_;
};

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

Stream& stream_with(std::vector<Stream>& streams, int32_t id) {
  for (Stream& stream : streams) {
    if (stream.id == id) return stream;
  }
  streams.push_back({});
  streams.back().id = id;
  return streams.back();
}

constexpr size_t kSizePrefix = 4;
constexpr size_t kEventBytes = 16;  // i64 t, i16 x, i16 y, u8 on, padding
constexpr size_t kElementsField = 0, kTriggerTimeField = 0, kTriggerTypeField = 1;

/// The meaning of a trigger type of the format; types that are not listed are not external signals.
struct TriggerMeaning {
  int8_t type;
  uint16_t id;
  uint8_t p;
};
constexpr TriggerMeaning kMeanings[] = {{1, 0, 1}, {2, 0, 0}, {3, 0, 1}, {4, 1, 1}, {5, 1, 0}};

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
      if (key == "sizeX") stream.width = parse_side(value, 65536).value_or(0);
      if (key == "sizeY") stream.height = parse_side(value, 65536).value_or(0);
      if (key == "source") stream.source = value;
      if (key == "originalOutputName") stream.output = value;
    }
  }
  return streams;
}

std::optional<size_t> header_size(std::span<const uint8_t> head) {
  const size_t line = kVersionLine.size();
  if (head.size() < line + 4) return std::nullopt;
  if (!as_text(head).starts_with(kVersionLine)) return std::nullopt;
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
  header.streams = parse_streams(as_text(*info));
  return header;
}

bool append_events(std::span<const uint8_t> packet, EventColumns& events) {
  if (packet.size() < kSizePrefix) return false;
  const FlatBuffer buffer(packet.subspan(kSizePrefix));
  const auto root = buffer.root("EVTS");
  if (!root) return false;
  if (!buffer.field(*root, kElementsField)) return true;  // no events
  const auto elements = buffer.vector_field(*root, kElementsField, kEventBytes);
  if (!elements) return false;
  const size_t begin = events.size(), count = elements->size() / kEventBytes;
  events.resize(begin + count);
  for (size_t i = 0; i < count; ++i) {
    const uint8_t* const event = elements->data() + i * kEventBytes;
    const auto x = load_le<uint16_t>(event + 8), y = load_le<uint16_t>(event + 10);
    events.t[begin + i] = load_le<int64_t>(event);
    events.x[begin + i] = x > INT16_MAX ? UINT16_MAX : x;
    events.y[begin + i] = y > INT16_MAX ? UINT16_MAX : y;
    events.p[begin + i] = event[12] != 0;
  }
  return true;
}

bool append_triggers(std::span<const uint8_t> packet, std::vector<Trigger>& triggers) {
  if (packet.size() < kSizePrefix) return false;
  const FlatBuffer buffer(packet.subspan(kSizePrefix));
  const auto root = buffer.root("TRIG");
  if (!root) return false;
  if (!buffer.field(*root, kElementsField)) return true;
  const auto elements = buffer.vector_field(*root, kElementsField, sizeof(uint32_t));
  if (!elements) return false;
  for (size_t i = 0; i < elements->size(); i += sizeof(uint32_t)) {
    const auto table = buffer.follow(buffer.place_of(elements->data() + i));
    if (!table) return false;
    const auto type = buffer.number_field<int8_t>(*table, kTriggerTypeField, 0);
    for (const TriggerMeaning& meaning : kMeanings) {
      if (meaning.type != type) continue;
      triggers.push_back({buffer.number_field<int64_t>(*table, kTriggerTimeField, 0), meaning.id, meaning.p});
    }
  }
  return true;
}

}  // namespace e2lf::formats::aedat4
