// SPDX-License-Identifier: MIT
// Reads the events of the messages of a ROS 2 bag; declared in codecs.h.

#include <algorithm>
#include <deque>
#include <optional>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/formats/rosbag/bag.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::formats::rosbag {
namespace fs = std::filesystem;
namespace {

constexpr size_t kWordBytes = 8;
constexpr int64_t kNsPerUs = 1000;
constexpr const char* kList = "list";

/// A message of events whose payload is not decoded.
struct EventMessage {
  std::string_view encoding;  ///< "evt3", "mono", ...; "list" for messages that contain individual events
  uint64_t width = 0, height = 0;
  std::optional<uint64_t> number;  ///< number of the packet, if packets are numbered
  uint64_t time_base_ns = 0;
  std::span<const uint8_t> payload;
  uint32_t count = 0;  ///< number of events of a list, as the message states
  size_t place = 0;    ///< offset of the payload in the message, to which the fields of a list are aligned
};

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

/// Parses a message. Returns nothing if it is truncated, has the wrong type for its topic, or is from a machine with
/// the other byte order.
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
  if (type.starts_with("event_camera_msgs/") || type.starts_with("event_array_msgs/")) {
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

/// Returns whether decode_message() supports an encoding. "evt3" is not among them, because its words depend on those
/// of earlier messages.
bool is_known_encoding(std::string_view encoding) {
  constexpr std::string_view kKnown[] = {"mono", "trigger", kList};
  return std::find(std::begin(kKnown), std::end(kKnown), encoding) != std::end(kKnown);
}

/// Appends the content of a message to `batch`. Returns false if its payload is truncated; what precedes the truncation
/// is kept.
bool decode_message(const EventMessage& message, EventBatch& batch) {
  if (message.encoding == kList) return append_list(message, batch);
  const auto payload = message.payload;
  const auto base_ns = static_cast<int64_t>(std::min<uint64_t>(message.time_base_ns, INT64_MAX / 2));
  for (size_t i = 0; i + kWordBytes <= payload.size(); i += kWordBytes) {
    // 32 bits of time in ns since the base, 16 of x, 15 of y or of the trigger input, and the polarity.
    const auto word = load_le<uint64_t>(&payload[i]);
    const int64_t t_us = (base_ns + static_cast<int64_t>(word & UINT32_MAX)) / kNsPerUs;
    const auto x = static_cast<uint16_t>(word >> 32), y = static_cast<uint16_t>(word >> 48 & 0x7FFF);
    const auto p = static_cast<uint8_t>(word >> 63);
    if (message.encoding == "mono") {
      batch.events.push_back({x, y, p, t_us});
    } else {
      batch.triggers.push_back({t_us, y, p});
    }
  }
  return payload.size() % kWordBytes == 0;
}

/// Largest number of messages before the first one of the topic that is read.
constexpr size_t kMaxHeldMessages = 10'000;

bool is_trigger_topic(const Topic& topic) {
  return std::string_view(topic.name).substr(topic.name.rfind('/') + 1).starts_with("trigger");
}

/// The messages of one event topic and of the triggers beside it.
class ChosenMessages {
 public:
  /// `has_chosen` is true if the topic was selected by name; then others are not mentioned.
  ChosenMessages(BagPtr bag, Topic events, bool has_chosen)
      : bag_(std::move(bag)), events_(std::move(events)), has_chosen_(has_chosen) {
    const std::string space = events_.name.substr(0, events_.name.rfind('/') + 1);
    for (const Topic& topic : bag_->topics()) {
      if (topic.name.starts_with(space) && topic.name != events_.name && is_trigger_topic(topic))
        triggers_ = topic.name;
    }
  }

  /// Returns the first message of the topic, which next() will return again, or nothing if there is none.
  Result<std::optional<EventMessage>> first() {
    BagMessage message;
    while (held_.size() < kMaxHeldMessages) {
      E2LF_ASSIGN_OR_RETURN(const bool more, bag_->next(message, losses_of_held_));
      if (!more) break;
      held_.push_back({*message.topic, {message.data.begin(), message.data.end()}, message.byte});
      if (message.topic->name != events_.name) continue;
      if (auto parsed = parse_message(events_.type, held_.back().data)) return parsed;
    }
    return std::optional<EventMessage>();
  }

  /// Advances to the next message and counts what is left out; returns false at the end. Its data are valid until the
  /// next call.
  Result<bool> next(EventMessage& message, DecodeSummary& summary) {
    summary.add_losses(std::exchange(losses_of_held_, {}));
    for (;;) {
      BagMessage stored;
      if (!held_.empty()) {
        current_ = std::move(held_.front());
        held_.pop_front();
        stored = {&current_.topic, current_.data, current_.byte};
      } else {
        E2LF_ASSIGN_OR_RETURN(const bool more, bag_->next(stored, summary));
        if (!more) return false;
      }
      const bool is_events = stored.topic->name == events_.name;
      if (!is_events && stored.topic->name != triggers_) {
        summary.other_streams += has_chosen_ ? 0 : 1;
        continue;
      }
      const auto parsed = parse_message(stored.topic->type, stored.data);
      byte_ = stored.byte;
      if (!parsed) {
        count_bad(summary);
        continue;
      }
      message = *parsed;
      if (is_events) look_for_gap(message, summary);
      return true;
    }
  }

  void count_bad(DecodeSummary& summary) const { summary.add_dropped(Violation::kBadRecord, byte_); }

  Result<void> rewind() {
    held_.clear();
    losses_of_held_ = {};
    next_number_.reset();
    return bag_->rewind();
  }

 private:
  struct Held {
    Topic topic;
    std::vector<uint8_t> data;
    uint64_t byte = 0;
  };

  void look_for_gap(const EventMessage& message, DecodeSummary& summary) {
    if (!message.number) return;
    if (next_number_ && *message.number > *next_number_) summary.add(Violation::kMisaligned, byte_);
    next_number_ = *message.number + 1;
  }

  BagPtr bag_;
  Topic events_;
  std::string triggers_;
  bool has_chosen_;
  std::deque<Held> held_;
  Held current_;
  DecodeSummary losses_of_held_;
  std::optional<uint64_t> next_number_;
  uint64_t byte_ = 0;
};

/// The words of all evt3 messages as one RAW recording.
class Evt3Source final : public ByteSource {
 public:
  Evt3Source(ChosenMessages messages, bool seekable, std::string header, std::string name)
      : messages_(std::move(messages)), seekable_(seekable), header_(std::move(header)), name_(std::move(name)) {
    begin();
  }

  Result<std::span<const uint8_t>> fetch(size_t wanted) override {
    while (buffer_.size() - used_ < wanted) {
      EventMessage message;
      E2LF_ASSIGN_OR_RETURN(const bool more, messages_.next(message, losses_));
      if (!more) break;
      if (message.encoding != "evt3") {
        messages_.count_bad(losses_);
        continue;
      }
      buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<ptrdiff_t>(std::exchange(used_, 0)));
      buffer_.insert(buffer_.end(), message.payload.begin(), message.payload.end());
    }
    return std::span<const uint8_t>(buffer_).subspan(used_);
  }
  void consume(size_t count) override {
    E2LF_REQUIRE(count <= buffer_.size() - used_, "more consumed than fetched");
    used_ += count;
    position_ += count;
  }
  uint64_t position() const override { return position_; }
  Result<void> seek(uint64_t position) override {
    if (position < position_) {
      E2LF_RETURN_IF_ERROR(messages_.rewind());
      begin();
    }
    while (position_ < position) {
      E2LF_ASSIGN_OR_RETURN(const auto bytes, fetch(1));
      if (bytes.empty()) break;
      consume(static_cast<size_t>(std::min<uint64_t>(bytes.size(), position - position_)));
    }
    return {};
  }
  bool seekable() const override { return seekable_; }
  std::optional<uint64_t> size() const override { return std::nullopt; }
  std::string name() const override { return name_; }
  DecodeSummary left_out() const override { return losses_; }

 private:
  void begin() {
    buffer_.assign(header_.begin(), header_.end());
    used_ = 0;
    position_ = 0;
  }

  ChosenMessages messages_;
  bool seekable_;
  std::string header_, name_;
  std::vector<uint8_t> buffer_;
  size_t used_ = 0;
  uint64_t position_ = 0;
  DecodeSummary losses_;
};

class MessageBlocks final : public EventBlocks {
 public:
  explicit MessageBlocks(ChosenMessages messages) : messages_(std::move(messages)) {}

  /// One message.
  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    block.clear();
    EventMessage message;
    E2LF_ASSIGN_OR_RETURN(const bool more, messages_.next(message, summary));
    if (more && (!is_known_encoding(message.encoding) || !decode_message(message, block))) messages_.count_bad(summary);
    return more;
  }

  Result<void> seek_before(int64_t) override { return messages_.rewind(); }

 private:
  ChosenMessages messages_;
};

/// Returns the topics that can be read: those with only triggers if there are no others.
std::vector<Topic> topics_to_read(const Bag& bag) {
  std::vector<Topic> topics = bag.topics();
  std::vector<Topic> events;
  std::copy_if(topics.begin(), topics.end(), std::back_inserter(events),
               [](const Topic& topic) { return !is_trigger_topic(topic); });
  return events.empty() ? topics : events;
}

/// The topics of a stream are known only after a first message, which is read here and returned again.
Result<ReaderPtr> open_bag(Result<BagPtr> opened, bool seekable, const std::string& format, const std::string& name,
                           const OpenOptions& options) {
  E2LF_ASSIGN_OR_RETURN(BagPtr bag, std::move(opened));
  const std::vector<Topic> topics = topics_to_read(*bag);
  if (topics.empty()) {
    return fail(
        ErrorCode::kFormat, name,
        "the bag contains no topic of events (event_camera_msgs/EventPacket, dvs_msgs/EventArray); give another bag");
  }
  RecordingInfo info{.format = format};
  std::vector<NamedStream> streams;
  for (const Topic& topic : topics) streams.push_back({cat(streams.size()), topic.name, ""});
  E2LF_ASSIGN_OR_RETURN(const size_t chosen, choose_stream(streams, options, name, info));
  info.header = {{"topic", header_text(topics[chosen].name)}, {"type", topics[chosen].type}};
  ChosenMessages messages(std::move(bag), topics[chosen], !options.stream.empty());
  E2LF_ASSIGN_OR_RETURN(const std::optional<EventMessage> first, messages.first());
  if (first) {
    info.header.emplace_back("encoding", header_text(std::string(first->encoding)));
    info.width = first->width;
    info.height = first->height;
  }
  E2LF_RETURN_IF_ERROR(apply_size_option(options, info, name));
  if (!first || is_known_encoding(first->encoding)) {
    return std::make_unique<RecordingReader>(std::make_unique<MessageBlocks>(std::move(messages)), std::move(info),
                                             name, options);
  }
  if (first->encoding != "evt3") {
    return fail(ErrorCode::kUnsupported, cat(name, ": ", header_text(topics[chosen].name)),
                "the events are in an encoding other than evt3, mono and trigger; record them in one of these");
  }
  std::string header = "% evt 3.0\n";
  if (info.width != 0 && info.height != 0) header += cat("% geometry ", info.width, "x", info.height, "\n");
  OpenOptions raw = options;
  raw.format = "evt3";
  raw.stream.clear();
  raw.width = raw.height = 0;
  auto words = std::make_shared<Evt3Source>(std::move(messages), seekable, header + "% end\n", name);
  E2LF_ASSIGN_OR_RETURN(auto reader, open_recording(std::move(words), raw));
  reader->take_container(std::move(info));
  return reader;
}

}  // namespace

bool is_event_type(const std::string& type) {
  constexpr std::string_view kTypes[] = {"event_camera_msgs/msg/EventPacket", "event_array_msgs/msg/EventArray",
                                         "dvs_msgs/msg/EventArray", "prophesee_event_msgs/msg/EventArray"};
  return std::find(std::begin(kTypes), std::end(kTypes), type) != std::end(kTypes);
}

bool detect_sqlite(std::span<const uint8_t> head) {
  using namespace std::string_view_literals;
  return as_text(head).starts_with("SQLite format 3\0"sv);
}

Result<ReaderPtr> open_sqlite(SourcePtr source, const OpenOptions& options) {
  const std::string name = source->name();
  return open_bag(open_sqlite_bag(std::move(source)), /*seekable=*/true, "rosbag", name, options);
}

Result<ReaderPtr> open_mcap(SourcePtr source, const OpenOptions& options) {
  const std::string name = source->name();
  const bool seekable = source->seekable();
  return open_bag(open_mcap_bag(std::move(source)), seekable, "mcap", name, options);
}

Result<ReaderPtr> open_folder(const fs::path& path, const OpenOptions& options) {
  return open_bag(open_folder_bag(path), /*seekable=*/true, "rosbag", path.string(), options);
}

}  // namespace e2lf::formats::rosbag
