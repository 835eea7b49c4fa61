// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/aedat4/aedat4_packets.h"

#include "e2lf/recordings/codecs/aedat4/flatbuffer.h"

namespace e2lf::recordings::aedat4 {
namespace {

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

}  // namespace e2lf::recordings::aedat4
