// SPDX-License-Identifier: MIT
#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/events/aedat4/aedat4.h"
#include "e2lf/events/aedat4/aedat4_header.h"
#include "e2lf/events/aedat4/aedat4_packets.h"
#include "e2lf/events/batch_check.h"
#include "e2lf/events/event_blocks.h"
#include "e2lf/events/little_endian.h"

namespace e2lf::events::aedat4 {
namespace {

constexpr size_t kPacketHeader = 8;

enum class Use : uint8_t { kEvents, kTriggers, kNone };

class Aedat4Blocks final : public EventBlocks {
 public:
  Aedat4Blocks(std::unique_ptr<ByteSource> source, Header header, std::unique_ptr<Decompressor> decompressor,
               const Stream* events)
      : source_(std::move(source)), header_(std::move(header)), decompressor_(std::move(decompressor)) {
    for (const Stream& stream : header_.streams) {
      uses_.push_back({stream.id, events != nullptr && stream.id == events->id ? Use::kEvents
                                  : stream.type == "TRIG"                      ? Use::kTriggers
                                                                               : Use::kNone});
    }
  }

  /// One packet.
  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    block.clear();
    const uint64_t position = source_->position();
    if (header_.table_position != 0 && position >= header_.table_position) return false;
    E2LF_ASSIGN_OR_RETURN(auto bytes, source_->fetch(kPacketHeader));
    if (bytes.empty()) return false;
    if (bytes.size() < kPacketHeader) return give_up(Violation::kTruncated, summary);
    const auto id = load_le<int32_t>(bytes.data()), size = load_le<int32_t>(bytes.data() + 4);
    const Use* const use = use_of(id);
    if (use == nullptr || size < 0 || static_cast<size_t>(size) > kMaxPacketBytes) {
      // Without a file table, a foreign packet is where a proper end would be; nothing tells where the next begins.
      return give_up(Violation::kMisaligned, summary);
    }
    const size_t whole = kPacketHeader + static_cast<size_t>(size);
    E2LF_ASSIGN_OR_RETURN(bytes, source_->fetch(whole));
    if (bytes.size() < whole) return give_up(Violation::kTruncated, summary);
    if (*use != Use::kNone && !append_packet(bytes.subspan(kPacketHeader, whole - kPacketHeader), *use, block)) {
      summary.add(Violation::kBadRecord, position);
      ++summary.dropped_words;
    }
    source_->consume(whole);
    return true;
  }

  Result<void> seek_before(int64_t) override {
    has_given_up_ = false;
    last_trigger_us_ = INT64_MIN;
    return source_->seek(header_.bytes);
  }

 private:
  const Use* use_of(int32_t id) const {
    for (const auto& [known, use] : uses_) {
      if (known == id) return &use;
    }
    return nullptr;
  }

  bool append_packet(std::span<const uint8_t> packed, Use use, EventBatch& block) {
    if (!decompressor_->unpack(packed, unpacked_)) return false;
    if (use == Use::kEvents) return append_events(unpacked_, block.events);
    if (!append_triggers(unpacked_, block.triggers)) return false;
    // Several trigger streams may overlap in time; one that lies before what was handed out is damaged.
    std::erase_if(block.triggers, [this](const Trigger& trigger) {
      if (trigger.t < last_trigger_us_ || !is_time(trigger.t)) return true;
      last_trigger_us_ = trigger.t;
      return false;
    });
    return true;
  }

  /// The packets end here.
  Result<bool> give_up(Violation violation, DecodeSummary& summary) {
    if (!std::exchange(has_given_up_, true)) summary.add(violation, source_->position());
    return false;
  }

  std::unique_ptr<ByteSource> source_;
  Header header_;
  std::unique_ptr<Decompressor> decompressor_;
  std::vector<std::pair<int32_t, Use>> uses_;
  std::vector<uint8_t> unpacked_;
  bool has_given_up_ = false;
  int64_t last_trigger_us_ = INT64_MIN;
};

const Stream* lowest_event_stream(const Header& header) {
  const Stream* lowest = nullptr;
  for (const Stream& stream : header.streams) {
    if (stream.type == "EVTS" && (lowest == nullptr || stream.id < lowest->id)) lowest = &stream;
  }
  return lowest;
}

}  // namespace

bool detect(std::span<const uint8_t> head) {
  return header_size(head).has_value();
}

Result<std::unique_ptr<RecordingReader>> open(std::unique_ptr<ByteSource> source, const OpenOptions& options) {
  const std::string name = source->name();
  E2LF_ASSIGN_OR_RETURN(auto bytes, source->fetch(kVersionLine.size() + 4));
  const auto size = header_size(bytes);
  if (!size || *size > kMaxHeaderBytes) {
    return Error{ErrorCode::kFormat, "not an AEDAT4 recording, or its header is damaged", name};
  }
  E2LF_ASSIGN_OR_RETURN(bytes, source->fetch(*size));
  E2LF_ASSIGN_OR_RETURN(Header header, parse_header(bytes, name));
  source->consume(header.bytes);
  E2LF_ASSIGN_OR_RETURN(auto decompressor, make_decompressor(header.compression));

  RecordingInfo info;
  info.format = "aedat4";
  const Stream* const events = lowest_event_stream(header);
  if (events == nullptr) return Error{ErrorCode::kFormat, "the recording has no stream of events", name};
  info.width = events->width;
  info.height = events->height;
  if (!events->source.empty()) info.header.emplace_back("source", events->source);
  for (const Stream& stream : header.streams) info.header.emplace_back(cat("stream_", stream.id), stream.type);
  E2LF_RETURN_IF_ERROR(apply_size_option(options, info, name));
  auto blocks = std::make_unique<Aedat4Blocks>(std::move(source), header, std::move(decompressor), events);
  return make_block_reader(std::move(blocks), std::move(info), name, options);
}

}  // namespace e2lf::events::aedat4
