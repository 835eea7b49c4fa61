// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "e2lf/recordings/io/byte_source.h"

namespace e2lf::recordings::rosbag {

struct Topic {
  std::string name, type;  ///< as "/event_camera/events", "event_camera_msgs/msg/EventPacket"
};

struct BagMessage {
  const Topic* topic = nullptr;   ///< valid while the bag is
  std::span<const uint8_t> data;  ///< valid until the next message
  uint64_t byte = 0;              ///< where it is in the file, or its number
};

/// The messages of a bag's topics of events, in the order in which they were stored.
class Bag {
 public:
  virtual ~Bag() = default;

  /// The topics of events that are known so far; of a file that can be sought all of them.
  [[nodiscard]] virtual std::vector<Topic> topics() const = 0;

  /// Goes to the next message and counts what cannot be read; false at the end. Fails with kIo and kUnsupported.
  [[nodiscard]] virtual Result<bool> next(BagMessage& message, DecodeSummary& summary) = 0;

  /// Goes back to the first message. Fails with kUnsupported (a stream) and kIo.
  [[nodiscard]] virtual Result<void> rewind() = 0;
};

/// Whether messages of a type are events.
[[nodiscard]] bool is_event_type(const std::string& type);

/// Largest message that is believed, in bytes.
inline constexpr size_t kMaxMessageBytes = size_t{1} << 26;

[[nodiscard]] Result<std::unique_ptr<Bag>> open_sqlite_bag(std::unique_ptr<ByteSource> source);
[[nodiscard]] Result<std::unique_ptr<Bag>> open_mcap_bag(std::unique_ptr<ByteSource> source);

}  // namespace e2lf::recordings::rosbag
