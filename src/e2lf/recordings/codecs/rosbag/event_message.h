// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "e2lf/recordings/codecs/rosbag/bag.h"
#include "e2lf/recordings/event.h"

namespace e2lf::recordings::rosbag {

/// A message of events, without its events decoded.
struct EventMessage {
  std::string_view encoding;  ///< "evt3", "mono", ...; "list" of messages that hold events one by one
  uint64_t width = 0, height = 0;
  std::optional<uint64_t> number;  ///< of the packet, where they are counted
  uint64_t time_base_ns = 0;
  std::span<const uint8_t> payload;
  uint32_t count = 0;  ///< of the events of a list, as the message claims
  size_t place = 0;    ///< of the payload in the message, which fields of a list are aligned to
};

/// Takes a message apart. Nothing where it is cut, not of a topic's type, or of a machine with the other byte order.
[[nodiscard]] std::optional<EventMessage> parse_message(const std::string& type, std::span<const uint8_t> message);

/// Whether decode_message() knows an encoding. "evt3" is not among them: its words need those of the messages before.
[[nodiscard]] bool is_known_encoding(std::string_view encoding);

/// Appends what a message holds to `batch`. False where its payload is cut; what stands in front of that is kept.
[[nodiscard]] bool decode_message(const EventMessage& message, EventBatch& batch);

}  // namespace e2lf::recordings::rosbag
