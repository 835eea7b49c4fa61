// SPDX-License-Identifier: MIT
// Reads the messages of .mcap files; declared in bag.h.
#include <algorithm>
#include <deque>
#include <map>
#include <optional>
#include <string_view>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/formats/rosbag/bag.h"
#include "e2lf/recordings/io/bytes.h"
#include "e2lf/recordings/io/decompress.h"

/// MCAP as specified at mcap.dev: records with a kind (u8), a length (u64) and content; chunks contain records.
namespace e2lf::formats::rosbag {
namespace {

constexpr std::string_view kMagic = "\x89MCAP0\r\n";
constexpr size_t kRecordHeader = 9, kFooterBytes = 20;
constexpr uint8_t kFooter = 0x02, kSchema = 0x03, kChannel = 0x04, kMessage = 0x05, kChunk = 0x06, kDataEnd = 0x0F;
/// Largest number of topics; further ones are skipped.
constexpr size_t kMaxTopics = 1000;

std::string text_of(Contents& fields) {
  return std::string(as_text(fields.take(fields.number<uint32_t>())));
}

std::optional<Compression> compression_of(const std::string& name) {
  if (name.empty()) return Compression::kNone;
  if (name == "lz4") return Compression::kLz4;
  return name == "zstd" ? std::optional(Compression::kZstd) : std::nullopt;
}

class McapBag final : public Bag {
 public:
  explicit McapBag(SourcePtr source) : source_(std::move(source)) {}

  Result<void> open() {
    E2LF_ASSIGN_OR_RETURN(const auto head, source_->fetch(kMagic.size()));
    if (!detect_mcap(head))
      return fail(ErrorCode::kFormat, source_->name(), "this is not an MCAP file, or it is incomplete");
    source_->consume(kMagic.size());
    // The topic of the first message precedes it and is then the first one.
    BagMessage first;
    E2LF_ASSIGN_OR_RETURN(const bool more, next(first, losses_of_first_));
    if (!source_->seekable()) {
      if (more) first_ = first;
      return {};
    }
    losses_of_first_ = {};
    E2LF_RETURN_IF_ERROR(read_summary());
    return rewind();
  }

  std::vector<Topic> topics() const override {
    std::vector<Topic> all;
    for (const Channel& channel : channels_) all.push_back(channel.topic);
    return all;
  }

  Result<bool> next(BagMessage& message, DecodeSummary& summary) override {
    summary.add_losses(std::exchange(losses_of_first_, {}));
    if (first_) {
      message = *std::exchange(first_, std::nullopt);
      return true;
    }
    for (;;) {
      if (!records_.empty()) {
        if (next_in_chunk(message, summary)) return true;
        continue;
      }
      source_->consume(std::exchange(used_, 0));
      position_ = source_->position();
      E2LF_ASSIGN_OR_RETURN(auto bytes, source_->fetch(kRecordHeader));
      if (bytes.size() < kRecordHeader) return end(Violation::kTruncated, summary);
      const uint8_t kind = bytes[0];
      const auto length = load_le<uint64_t>(&bytes[1]);
      if (kind == kDataEnd || kind == kFooter) return end(std::nullopt, summary);
      // The position of the next record is unknown.
      if (kind == 0 || length > kMaxPacketBytes) return end(Violation::kMisaligned, summary);
      E2LF_ASSIGN_OR_RETURN(bytes, source_->fetch(kRecordHeader + length));
      if (bytes.size() < kRecordHeader + length) return end(Violation::kTruncated, summary);
      used_ = kRecordHeader + static_cast<size_t>(length);
      const auto contents = bytes.subspan(kRecordHeader, static_cast<size_t>(length));
      if (kind == kChunk) {
        E2LF_RETURN_IF_ERROR(open_chunk(contents, summary));
      } else if (take_record(kind, contents, message)) {
        return true;
      }
    }
  }

  Result<void> rewind() override {
    records_ = {};
    used_ = 0;
    has_ended_ = false;
    return source_->seek(kMagic.size());
  }

 private:
  struct Channel {
    uint16_t id = 0;
    Topic topic;
  };

  /// Decompresses a chunk to records_; one that cannot be decompressed is counted.
  Result<void> open_chunk(std::span<const uint8_t> contents, DecodeSummary& summary) {
    Contents fields(contents);
    fields.take(28);  // times, size and check sum of the records
    const std::string name = text_of(fields);
    const auto compression = compression_of(name);
    if (!compression && !fields.is_cut()) {
      return fail(ErrorCode::kUnsupported, source_->name(),
                  "the chunks are compressed with an unknown algorithm; convert the bag to lz4 or zstd");
    }
    const auto packed = fields.take(fields.number<uint64_t>());
    const bool is_whole = !fields.is_cut() && compression.has_value();
    if (is_whole) E2LF_RETURN_IF_ERROR(check_compression(*compression));
    if (is_whole && decompress(*compression, packed, unpacked_)) {
      records_ = unpacked_;
    } else {
      summary.add_dropped(Violation::kBadRecord, position_);
    }
    return {};
  }

  /// Reads the next record of the chunk; returns whether it is a message.
  bool next_in_chunk(BagMessage& message, DecodeSummary& summary) {
    Contents fields(records_);
    const auto kind = fields.number<uint8_t>();
    const auto contents = fields.take(fields.number<uint64_t>());
    if (fields.is_cut()) {
      summary.add(Violation::kBadRecord, position_);
      records_ = {};
      return false;
    }
    records_ = fields.rest();
    return take_record(kind, contents, message);
  }

  /// Stores schemas and channels; returns whether the record is a message of an event topic.
  bool take_record(uint8_t kind, std::span<const uint8_t> contents, BagMessage& message) {
    Contents fields(contents);
    const auto id = fields.number<uint16_t>();
    if (kind == kSchema && types_.size() < kMaxTopics) types_.emplace(id, text_of(fields));
    if (kind != kChannel && kind != kMessage) return false;
    const auto channel =
        std::find_if(channels_.begin(), channels_.end(), [id](const Channel& candidate) { return candidate.id == id; });
    if (kind == kChannel && channel == channels_.end() && channels_.size() < kMaxTopics) {
      const auto type = types_.find(fields.number<uint16_t>());
      if (type != types_.end() && is_event_type(type->second))
        channels_.push_back({id, {text_of(fields), type->second}});
    }
    if (kind == kChannel || channel == channels_.end()) return false;
    fields.take(20);  // number and times
    if (fields.is_cut()) return false;
    message = {&channel->topic, fields.rest(), position_};
    return true;
  }

  /// Reads schemas and channels from the end of the file, if they are there.
  Result<void> read_summary() {
    const uint64_t size = source_->size().value_or(0), tail = kRecordHeader + kFooterBytes + kMagic.size();
    if (size < tail + kMagic.size()) return {};
    E2LF_RETURN_IF_ERROR(source_->seek(size - tail));
    E2LF_ASSIGN_OR_RETURN(auto bytes, source_->fetch(tail));
    if (bytes.size() < tail || bytes[0] != kFooter) return {};
    const auto begin = load_le<uint64_t>(&bytes[kRecordHeader]);
    if (begin == 0 || begin > size - tail || size - tail - begin > kMaxPacketBytes) return {};
    E2LF_RETURN_IF_ERROR(source_->seek(begin));
    E2LF_ASSIGN_OR_RETURN(bytes, source_->fetch(size - tail - begin));
    Contents summary(bytes.first(std::min<size_t>(bytes.size(), size - tail - begin)));
    while (!summary.rest().empty() && !summary.is_cut()) {
      BagMessage none;
      const auto kind = summary.number<uint8_t>();
      const auto contents = summary.take(summary.number<uint64_t>());
      if (kind == kSchema || kind == kChannel) take_record(kind, contents, none);
    }
    return {};
  }

  Result<bool> end(std::optional<Violation> violation, DecodeSummary& summary) {
    if (!std::exchange(has_ended_, true) && violation) summary.add(*violation, position_);
    return false;
  }

  SourcePtr source_;
  std::map<uint16_t, std::string> types_;
  std::deque<Channel> channels_;     ///< event topics in the order in which the file names them
  std::optional<BagMessage> first_;  ///< for a stream: read to determine its topic, and not returned yet
  DecodeSummary losses_of_first_;
  std::vector<uint8_t> unpacked_;
  std::span<const uint8_t> records_;  ///< records of the chunk that were not read yet
  size_t used_ = 0;                   ///< number of available bytes that the last record occupies
  uint64_t position_ = 0;             ///< of the last record
  bool has_ended_ = false;
};

}  // namespace

bool detect_mcap(std::span<const uint8_t> head) {
  return as_text(head).starts_with(kMagic);
}

Result<BagPtr> open_mcap_bag(SourcePtr source) {
  auto bag = std::make_unique<McapBag>(std::move(source));
  E2LF_RETURN_IF_ERROR(bag->open());
  return BagPtr(std::move(bag));
}

}  // namespace e2lf::formats::rosbag
