// SPDX-License-Identifier: MIT
// Reads AEDAT 4; declared in codecs.h.
#include <algorithm>
#include <cstring>
#include <iterator>
#include <map>
#include <optional>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/formats/aedat4/aedat4_format.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/io/header_text.h"
#include "e2lf/recordings/stream_choice.h"

namespace e2lf::formats::aedat4 {
namespace {

constexpr size_t kPacketHeader = 8;

enum class Use : uint8_t { kEvents, kTriggers, kLeftOut, kNone };

/// Returns how a stream is used when the events of another are read; `has_chosen` is true if that was selected by name.
Use use_of_stream(const Stream& stream, const Stream& events, bool has_several_cameras, bool has_chosen) {
  if (stream.id == events.id) return Use::kEvents;
  const bool is_trigger = stream.type == "TRIG";
  if (is_trigger && (!has_several_cameras || stream.source == events.source)) return Use::kTriggers;
  return has_chosen || (!is_trigger && stream.type != "EVTS") ? Use::kNone : Use::kLeftOut;
}

class Aedat4Blocks final : public EventBlocks {
 public:
  /// `events` is the stream to read, one of `event_streams`.
  Aedat4Blocks(SourcePtr source, Header header, const std::vector<Stream>& event_streams, const Stream& events,
               bool has_chosen)
      : source_(std::move(source)), header_(std::move(header)) {
    const bool has_several_cameras =
        std::any_of(event_streams.begin(), event_streams.end(),
                    [&events](const Stream& stream) { return stream.source != events.source; });
    for (const Stream& stream : header_.streams) {
      uses_.emplace(stream.id, use_of_stream(stream, events, has_several_cameras, has_chosen));
    }
  }

  /// One packet.
  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    block.clear();
    begins_recording_ = false;
    const uint64_t position = source_->position();
    if (header_.table_position != 0 && position >= header_.table_position) return pass_over_table();
    E2LF_ASSIGN_OR_RETURN(auto bytes, source_->fetch(kPacketHeader));
    if (bytes.empty()) return false;
    if (bytes.size() < kPacketHeader) return give_up(Violation::kTruncated, summary);
    const auto packet = parse_packet(bytes);
    if (!packet && begins_header(bytes)) return read_appended_header();
    // Without a file table, a foreign packet occurs where a regular end would be. The position of the next packet is
    // unknown.
    if (!packet) return give_up(Violation::kMisaligned, summary);
    E2LF_ASSIGN_OR_RETURN(bytes, source_->fetch(packet->bytes));
    if (bytes.size() < packet->bytes) return give_up(Violation::kTruncated, summary);
    const auto packed = bytes.subspan(kPacketHeader, packet->bytes - kPacketHeader);
    if (packet->use == Use::kLeftOut) {
      ++summary.other_streams;
    } else if (packet->use != Use::kNone && !append_packet(packed, packet->use, block)) {
      summary.add_dropped(Violation::kBadRecord, position);
    }
    source_->consume(packet->bytes);
    return true;
  }

  bool begins_recording() const override { return begins_recording_; }

  Result<void> seek_before(int64_t) override {
    has_given_up_ = false;
    header_.table_position = first_table_position_;
    return source_->seek(header_.bytes);
  }

 private:
  static bool begins_header(std::span<const uint8_t> bytes) {
    const size_t count = std::min(bytes.size(), kVersionLine.size());
    return std::memcmp(bytes.data(), kVersionLine.data(), count) == 0;
  }

  /// Skips the table of the packets to the header of an appended recording. Returns false if there is none.
  Result<bool> pass_over_table() {
    constexpr size_t kSearchedBytes = size_t{1} << 16;
    for (;;) {
      E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(kSearchedBytes));
      const auto line = std::search(bytes.begin(), bytes.end(), kVersionLine.begin(), kVersionLine.end());
      if (line != bytes.end()) {
        source_->consume(static_cast<size_t>(line - bytes.begin()));
        return read_appended_header();
      }
      const bool has_ended = bytes.size() < kSearchedBytes;
      source_->consume(has_ended ? bytes.size() : bytes.size() - kVersionLine.size());
      if (has_ended) return false;
    }
  }

  /// Reads the header of an appended recording, whose streams are identified with those of the first one.
  Result<bool> read_appended_header() {
    const uint64_t begin = source_->position();
    E2LF_ASSIGN_OR_RETURN(auto bytes, source_->fetch(kVersionLine.size() + 4));
    const auto size = header_size(bytes);
    if (!size || *size > kMaxHeaderBytes) return false;
    E2LF_ASSIGN_OR_RETURN(bytes, source_->fetch(*size));
    E2LF_ASSIGN_OR_RETURN(const Header header, parse_header(bytes, source_->name()));
    if (header.compression != header_.compression) {
      return fail(ErrorCode::kUnsupported, cat(source_->name(), ": byte ", begin),
                  "the recording that was appended here is compressed in another way; split the file here");
    }
    header_.table_position = header.table_position == 0 ? 0 : begin + header.table_position;
    source_->consume(header.bytes);
    begins_recording_ = true;
    return true;
  }

  struct Packet {
    Use use = Use::kNone;
    size_t bytes = 0;  ///< size including the header
  };

  /// Returns the packet that begins with these bytes, or nothing if it does not belong to this file.
  std::optional<Packet> parse_packet(std::span<const uint8_t> bytes) const {
    const auto use = uses_.find(load_le<int32_t>(bytes.data()));
    const auto size = load_le<int32_t>(bytes.data() + 4);
    if (use == uses_.end() || size < 0 || static_cast<size_t>(size) > kMaxPacketBytes) return std::nullopt;
    return Packet{use->second, kPacketHeader + static_cast<size_t>(size)};
  }

  bool append_packet(std::span<const uint8_t> packed, Use use, EventBatch& block) {
    if (!decompress(header_.compression, packed, unpacked_)) return false;
    if (use == Use::kEvents) return append_events(unpacked_, block.events);
    return append_triggers(unpacked_, block.triggers);
  }

  /// Ends the packets here.
  Result<bool> give_up(Violation violation, DecodeSummary& summary) {
    if (!std::exchange(has_given_up_, true)) summary.add(violation, source_->position());
    return false;
  }

  SourcePtr source_;
  Header header_;
  uint64_t first_table_position_ = header_.table_position;
  std::map<int32_t, Use> uses_;
  std::vector<uint8_t> unpacked_;
  bool has_given_up_ = false;
  bool begins_recording_ = false;
};

/// Returns the streams of events, by their numbers.
std::vector<Stream> streams_of_events(const Header& header) {
  std::vector<Stream> streams;
  std::copy_if(header.streams.begin(), header.streams.end(), std::back_inserter(streams),
               [](const Stream& stream) { return stream.type == "EVTS"; });
  std::sort(streams.begin(), streams.end(), [](const Stream& a, const Stream& b) { return a.id < b.id; });
  return streams;
}

}  // namespace

bool detect(std::span<const uint8_t> head) {
  return header_size(head).has_value();
}

Result<ReaderPtr> open(SourcePtr source, const OpenOptions& options) {
  const std::string name = source->name();
  E2LF_ASSIGN_OR_RETURN(auto bytes, source->fetch(kVersionLine.size() + 4));
  const auto size = header_size(bytes);
  if (!size || *size > kMaxHeaderBytes) {
    return fail(ErrorCode::kFormat, name, "this is not an AEDAT4 recording, or its header is damaged");
  }
  E2LF_ASSIGN_OR_RETURN(bytes, source->fetch(*size));
  E2LF_ASSIGN_OR_RETURN(Header header, parse_header(bytes, name));
  source->consume(header.bytes);
  E2LF_RETURN_IF_ERROR(check_compression(header.compression));

  RecordingInfo info{.format = "aedat4"};
  const std::vector<Stream> event_streams = streams_of_events(header);
  std::vector<NamedStream> named;
  for (const Stream& stream : event_streams) named.push_back({cat(stream.id), stream.output, stream.source});
  E2LF_ASSIGN_OR_RETURN(const size_t chosen, choose_stream(named, options, name, info));
  const Stream& events = event_streams[chosen];
  info.width = events.width;
  info.height = events.height;
  if (!events.source.empty()) info.header.emplace_back("source", header_text(events.source));
  for (const Stream& stream : header.streams)
    info.header.emplace_back(cat("stream_", stream.id), header_text(stream.type));
  E2LF_RETURN_IF_ERROR(apply_size_option(options, info, name));
  auto blocks =
      std::make_unique<Aedat4Blocks>(std::move(source), header, event_streams, events, !options.stream.empty());
  return std::make_unique<RecordingReader>(std::move(blocks), std::move(info), name, options);
}

}  // namespace e2lf::formats::aedat4
