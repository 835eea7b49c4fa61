// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "e2lf/recordings/codecs/rosbag/bag.h"
#include "e2lf/recordings/event.h"

namespace e2lf::recordings::rosbag {

/// A message of events whose payload is not decoded.
struct EventMessage {
  std::string_view encoding;  ///< "evt3", "mono", ...; "list" for messages that contain individual events
  uint64_t width = 0, height = 0;
  std::optional<uint64_t> number;  ///< of the packet, if packets are numbered
  uint64_t time_base_ns = 0;
  std::span<const uint8_t> payload;
  uint32_t count = 0;  ///< number of events of a list, as the message states
  size_t place = 0;    ///< offset of the payload in the message, to which the fields of a list are aligned
};

/// Parses a message. Returns nothing if it is truncated, has the wrong type for its topic, or is from a machine with
/// the other byte order.
[[nodiscard]] std::optional<EventMessage> parse_message(const std::string& type, std::span<const uint8_t> message);

/// Returns whether decode_message() supports an encoding. "evt3" is not among them, because its words depend on those
/// of earlier messages.
[[nodiscard]] bool is_known_encoding(std::string_view encoding);

/// Appends the content of a message to `batch`. Returns false if its payload is truncated; what precedes the truncation
/// is kept.
[[nodiscard]] bool decode_message(const EventMessage& message, EventBatch& batch);

}  // namespace e2lf::recordings::rosbag
