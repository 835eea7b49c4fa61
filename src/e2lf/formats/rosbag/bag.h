// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/little_endian.h"
#include "e2lf/formats/codecs.h"

namespace e2lf::formats::rosbag {

/// Reads little-endian fields from the front of bytes; missing ones are 0 or empty.
class Contents {
 public:
  explicit Contents(std::span<const uint8_t> bytes) : rest_(bytes) {}

  template <typename T>
  T number() {
    const auto field = take(sizeof(T));
    return field.size() == sizeof(T) ? load_le<T>(field.data()) : T{0};
  }
  std::span<const uint8_t> take(uint64_t count) {
    is_cut_ |= count > rest_.size();
    const auto field = rest_.first(static_cast<size_t>(std::min<uint64_t>(count, rest_.size())));
    rest_ = rest_.subspan(field.size());
    return field;
  }
  [[nodiscard]] std::span<const uint8_t> rest() const { return rest_; }
  [[nodiscard]] bool is_cut() const { return is_cut_; }

 private:
  std::span<const uint8_t> rest_;
  bool is_cut_ = false;
};

struct Topic {
  std::string name, type;  ///< e.g. "/event_camera/events", "event_camera_msgs/msg/EventPacket"
};

struct BagMessage {
  const Topic* topic = nullptr;   ///< valid during the lifetime of the bag
  std::span<const uint8_t> data;  ///< valid until the next message
  uint64_t byte = 0;              ///< position in the file, or number of the message
};

/// The messages of the event topics of a bag, in the order in which they were stored.
class Bag {
 public:
  virtual ~Bag() = default;

  /// Returns the event topics that are known so far; for a seekable file, all of them.
  [[nodiscard]] virtual std::vector<Topic> topics() const = 0;

  /// Advances to the next message and counts what cannot be read. Returns false at the end. Fails with kIo and
  /// kUnsupported.
  [[nodiscard]] virtual Result<bool> next(BagMessage& message, DecodeSummary& summary) = 0;

  /// Returns to the first message. Fails with kUnsupported (a stream) and kIo.
  [[nodiscard]] virtual Result<void> rewind() = 0;
};

using BagPtr = std::unique_ptr<Bag>;

/// Returns whether messages of a type contain events.
[[nodiscard]] bool is_event_type(const std::string& type);

[[nodiscard]] Result<BagPtr> open_sqlite_bag(SourcePtr source);
[[nodiscard]] Result<BagPtr> open_mcap_bag(SourcePtr source);
/// Opens the files of a folder in the order of their numbers.
[[nodiscard]] Result<BagPtr> open_folder_bag(const std::filesystem::path& folder);

}  // namespace e2lf::formats::rosbag
