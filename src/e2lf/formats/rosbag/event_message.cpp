// SPDX-License-Identifier: MIT
// Decodes messages of event_camera_msgs; declared in bag.h.
#include <algorithm>

#include "e2lf/base/little_endian.h"
#include "e2lf/formats/rosbag/bag.h"
#include "e2lf/recordings/io/bytes.h"

namespace e2lf::formats::rosbag {
namespace {

constexpr size_t kWordBytes = 8;
constexpr int64_t kNsPerUs = 1000;
constexpr const char* kList = "list";

/// Reads the fields of a little-endian CDR message, each of which is aligned to its size.
class Fields : public Contents {
 public:
  /// `place` is the offset of the bytes after the header of the message.
  explicit Fields(std::span<const uint8_t> bytes, size_t place = 0) : Contents(bytes), end_(place + bytes.size()) {}

  template <typename T>
  T number() {
    take((sizeof(T) - place() % sizeof(T)) % sizeof(T));
    return Contents::number<T>();
  }
  std::string_view text() {
    const std::string_view with_zero = as_text(take(number<uint32_t>()));
    return with_zero.substr(0, with_zero.size() - std::min<size_t>(with_zero.size(), 1));
  }
  [[nodiscard]] size_t place() const { return end_ - rest().size(); }

 private:
  size_t end_;
};

bool is_packet_type(const std::string& type) {
  return type.starts_with("event_camera_msgs/") || type.starts_with("event_array_msgs/");
}

/// Appends the events of 64-bit words: 32 bits of time in ns since the base, 16 of x, 15 of y, and the polarity.
void append_mono(uint64_t word, int64_t base_ns, EventBatch& batch) {
  const int64_t t_us = (base_ns + static_cast<int64_t>(word & UINT32_MAX)) / kNsPerUs;
  batch.events.push_back({static_cast<uint16_t>(word >> 32), static_cast<uint16_t>(word >> 48 & 0x7FFF),
                          static_cast<uint8_t>(word >> 63), t_us});
}

void append_trigger(uint64_t word, int64_t base_ns, EventBatch& batch) {
  const int64_t t_us = (base_ns + static_cast<int64_t>(word & UINT32_MAX)) / kNsPerUs;
  batch.triggers.push_back({t_us, static_cast<uint16_t>(word >> 48 & 0x7FFF), static_cast<uint8_t>(word >> 63)});
}

/// Appends individual events: x, y, seconds and nanoseconds since 1970, polarity.
bool append_list(const EventMessage& message, EventBatch& batch) {
  Fields fields(message.payload, message.place);
  for (uint32_t i = 0; i < message.count; ++i) {
    Event event;
    event.x = fields.number<uint16_t>();
    event.y = fields.number<uint16_t>();
    const int64_t seconds = fields.number<int32_t>();
    event.t = seconds * 1'000'000 + fields.number<uint32_t>() / kNsPerUs;
    event.p = static_cast<uint8_t>(fields.number<uint8_t>() != 0);
    if (fields.is_cut()) return false;
    batch.events.push_back(event);
  }
  return true;
}

}  // namespace

bool is_event_type(const std::string& type) {
  constexpr std::string_view kTypes[] = {"event_camera_msgs/msg/EventPacket", "event_array_msgs/msg/EventArray",
                                         "dvs_msgs/msg/EventArray", "prophesee_event_msgs/msg/EventArray"};
  return std::find(std::begin(kTypes), std::end(kTypes), type) != std::end(kTypes);
}

std::optional<EventMessage> parse_message(const std::string& type, std::span<const uint8_t> message) {
  constexpr size_t kHeaderBytes = 4;
  constexpr uint8_t kLittleEndian = 1;
  if (message.size() < kHeaderBytes || message[0] != 0 || (message[1] & 1) != kLittleEndian) return std::nullopt;
  Fields fields(message.subspan(kHeaderBytes));
  fields.number<int32_t>();  // time stamp
  fields.number<uint32_t>();
  fields.text();  // the camera's frame
  EventMessage result;
  result.height = fields.number<uint32_t>();
  result.width = fields.number<uint32_t>();
  if (is_packet_type(type)) {
    result.number = fields.number<uint64_t>();
    result.time_base_ns = fields.number<uint64_t>();
    result.encoding = fields.text();
    if (fields.number<uint8_t>() != 0) return std::nullopt;  // big-endian
    result.payload = fields.take(fields.number<uint32_t>());
  } else {
    result.encoding = kList;
    result.count = fields.number<uint32_t>();
    result.place = fields.place();
    result.payload = fields.take(fields.rest().size());
  }
  if (fields.is_cut() || result.width > UINT16_MAX + 1 || result.height > UINT16_MAX + 1) return std::nullopt;
  return result;
}

bool is_known_encoding(std::string_view encoding) {
  constexpr std::string_view kKnown[] = {"mono", "trigger", kList};
  return std::find(std::begin(kKnown), std::end(kKnown), encoding) != std::end(kKnown);
}

bool decode_message(const EventMessage& message, EventBatch& batch) {
  if (message.encoding == kList) return append_list(message, batch);
  const auto payload = message.payload;
  const auto base_ns = static_cast<int64_t>(std::min<uint64_t>(message.time_base_ns, INT64_MAX / 2));
  for (size_t i = 0; i + kWordBytes <= payload.size(); i += kWordBytes) {
    const auto word = load_le<uint64_t>(&payload[i]);
    if (message.encoding == "mono") append_mono(word, base_ns, batch);
    if (message.encoding == "trigger") append_trigger(word, base_ns, batch);
  }
  return payload.size() % kWordBytes == 0;
}

}  // namespace e2lf::formats::rosbag
