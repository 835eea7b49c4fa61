// SPDX-License-Identifier: MIT
// Reads AEDAT 3; declared in codecs.h.
#include <algorithm>
#include <charconv>
#include <map>
#include <string_view>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/formats/aedat/text_header.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/io/header_text.h"
#include "e2lf/recordings/stream_choice.h"

namespace e2lf::recordings::aedat {
namespace {

constexpr std::string_view kVersion = "#!AER-DAT3.";
constexpr size_t kPacketHeader = 28, kEventBytes = 8;
constexpr size_t kMaxPacketBytes = size_t{1} << 26;
constexpr int16_t kSpecialType = 0, kPolarityType = 1;
constexpr int16_t kAnySource = -1;

struct Packet {
  int16_t type = 0, source = 0;
  size_t bytes = 0;         ///< size of the content after the header
  int64_t overflow_us = 0;  ///< added to its times
};

/// Returns nothing if the bytes are not the header of a packet. Packets of other types may contain events of any size.
std::optional<Packet> parse_packet(std::span<const uint8_t> bytes) {
  const auto word = [&](size_t place) { return load_le<int32_t>(bytes.data() + place); };
  const Packet packet{load_le<int16_t>(bytes.data()), load_le<int16_t>(bytes.data() + 2),
                      static_cast<size_t>(word(4)) * static_cast<size_t>(word(20)), int64_t{word(12)} << 31};
  const bool is_read = packet.type == kSpecialType || packet.type == kPolarityType;
  if (packet.type < 0 || packet.source < 0 || word(4) <= 0 || word(12) < 0 || word(20) < 0) return std::nullopt;
  if (static_cast<size_t>(word(4)) > kMaxPacketBytes || packet.bytes > kMaxPacketBytes) return std::nullopt;
  if (is_read && (word(4) != kEventBytes || word(8) != 4)) return std::nullopt;
  return packet;
}

/// The meaning of a type of special events; types that are not listed are not external signals.
struct TriggerMeaning {
  uint32_t type;
  uint16_t id;
  uint8_t p;
};
constexpr TriggerMeaning kMeanings[] = {{2, 0, 1}, {3, 0, 0},  {4, 0, 1},  {6, 1, 1},  {7, 1, 0}, {8, 1, 1},
                                        {9, 2, 1}, {10, 2, 0}, {11, 2, 1}, {12, 3, 1}, {13, 3, 0}};

class Aedat3Blocks final : public EventBlocks {
 public:
  /// `flip_height` is the height of the sensor if rows are counted from the bottom, otherwise 0.
  Aedat3Blocks(SourcePtr source, int16_t chosen, bool has_chosen, size_t flip_height)
      : source_(std::move(source)),
        chosen_(chosen),
        has_chosen_(has_chosen),
        flip_height_(flip_height),
        header_bytes_(source_->position()) {}

  /// One packet.
  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    block.clear();
    begins_recording_ = false;
    E2LF_ASSIGN_OR_RETURN(auto bytes, source_->fetch(kPacketHeader));
    if (bytes.empty()) return false;
    if (bytes.size() < kPacketHeader) return give_up(Violation::kTruncated, summary);
    const auto packet = parse_packet(bytes);
    // A recording that was appended with its header.
    if (!packet && detect_aedat3(bytes)) {
      E2LF_ASSIGN_OR_RETURN(const TextHeader header, read_text_header(*source_));
      begins_recording_ = header.bytes > 0;
      if (begins_recording_) return true;
    }
    // The position of the next packet is unknown.
    if (!packet) return give_up(Violation::kMisaligned, summary);
    E2LF_ASSIGN_OR_RETURN(bytes, source_->fetch(kPacketHeader + packet->bytes));
    const size_t whole = std::min(bytes.size() - kPacketHeader, packet->bytes) / kEventBytes * kEventBytes;
    const auto events = bytes.subspan(kPacketHeader, whole);
    const bool is_chosen = chosen_ == kAnySource || packet->source == chosen_;
    if (packet->type == kPolarityType && is_chosen) append_events(events, packet->overflow_us, block.events);
    if (packet->type == kSpecialType && is_chosen) append_triggers(events, packet->overflow_us, block.triggers);
    if (packet->type == kPolarityType && !is_chosen && !has_chosen_) ++summary.other_streams;
    if (bytes.size() < kPacketHeader + packet->bytes) {
      summary.add(Violation::kTruncated, source_->position());
      source_->consume(bytes.size());
      return true;
    }
    source_->consume(kPacketHeader + packet->bytes);
    return true;
  }

  bool begins_recording() const override { return begins_recording_; }

  Result<void> seek_before(int64_t) override {
    has_given_up_ = false;
    return source_->seek(header_bytes_);
  }

 private:
  void append_events(std::span<const uint8_t> packet, int64_t overflow_us, EventColumns& events) const {
    for (size_t i = 0; i < packet.size(); i += kEventBytes) {
      const auto data = load_le<uint32_t>(&packet[i]);
      if ((data & 1) == 0) continue;  // removed by a filter
      const uint32_t y = data >> 2 & 0x7FFF;
      const uint32_t from_top = flip_height_ == 0 ? y : y < flip_height_ ? flip_height_ - 1 - y : UINT16_MAX;
      events.push_back({static_cast<uint16_t>(data >> 17), static_cast<uint16_t>(from_top),
                        static_cast<uint8_t>(data >> 1 & 1), overflow_us + load_le<int32_t>(&packet[i + 4])});
    }
  }

  static void append_triggers(std::span<const uint8_t> packet, int64_t overflow_us, std::vector<Trigger>& triggers) {
    for (size_t i = 0; i < packet.size(); i += kEventBytes) {
      const auto data = load_le<uint32_t>(&packet[i]);
      for (const TriggerMeaning& meaning : kMeanings) {
        if ((data & 1) == 0 || meaning.type != (data >> 1 & 0x7F)) continue;
        triggers.push_back({overflow_us + load_le<int32_t>(&packet[i + 4]), meaning.id, meaning.p});
      }
    }
  }

  Result<bool> give_up(Violation violation, DecodeSummary& summary) {
    if (!std::exchange(has_given_up_, true)) summary.add(violation, source_->position());
    return false;
  }

  SourcePtr source_;
  int16_t chosen_;
  bool has_chosen_;
  size_t flip_height_;
  uint64_t header_bytes_;
  bool has_given_up_ = false;
  bool begins_recording_ = false;
};

/// Returns the sources in the header, "Source 1: DVS128", by number.
std::map<int16_t, std::string> sources_of(const TextHeader& header) {
  constexpr std::string_view kKey = "Source ";
  std::map<int16_t, std::string> sources;
  for (const std::string& line : header.lines) {
    if (!line.starts_with(kKey)) continue;
    int16_t number = 0;
    const auto [end, error] = std::from_chars(line.data() + kKey.size(), line.data() + line.size(), number);
    if (error != std::errc() || *end != ':') continue;
    const size_t name = line.find_first_not_of(' ', static_cast<size_t>(end + 1 - line.data()));
    sources[number] = name == std::string::npos ? "" : line.substr(name);
  }
  return sources;
}

}  // namespace

bool detect_aedat3(std::span<const uint8_t> head) {
  return as_text(head).starts_with(kVersion);
}

Result<ReaderPtr> open_aedat3(SourcePtr source, const OpenOptions& options) {
  const std::string name = source->name();
  E2LF_ASSIGN_OR_RETURN(const TextHeader header, read_text_header(*source));
  if (header.lines.empty() || !("#" + header.lines[0]).starts_with(kVersion)) {
    return Error{ErrorCode::kFormat, cat("this is not an AEDAT 3 recording, whose first line begins with ", kVersion),
                 name};
  }
  const std::string format = header.find("Format:").value_or("RAW");
  if (format != "RAW" && format != "PNGFrames") {
    return Error{ErrorCode::kUnsupported,
                 cat("the packets are stored as ", one_line(format), "; record or convert them as RAW"), name};
  }
  std::map<int16_t, std::string> sources = sources_of(header);
  if (sources.empty()) sources[0] = "";
  RecordingInfo info{.format = "aedat3"};
  std::vector<NamedStream> streams;
  for (const auto& [number, camera] : sources) streams.push_back({cat(number), "", camera});
  E2LF_ASSIGN_OR_RETURN(const size_t chosen, choose_stream(streams, options, name, info));
  const auto chosen_source = std::next(sources.begin(), static_cast<ptrdiff_t>(chosen));
  if (const auto model = find_camera_model(chosen_source->second)) {
    info.width = model->width;
    info.height = model->height;
  }
  if (!chosen_source->second.empty()) info.header.emplace_back("source", one_line(chosen_source->second));
  if (const auto start = header.find("Start-Time:")) info.header.emplace_back("start_time", one_line(*start));
  E2LF_RETURN_IF_ERROR(apply_size_option(options, info, name));
  const bool is_from_bottom = ("#" + header.lines[0]).starts_with("#!AER-DAT3.0");
  // If there is a single source, all packets belong to it, whatever their number.
  const int16_t number = sources.size() == 1 ? kAnySource : chosen_source->first;
  auto blocks = std::make_unique<Aedat3Blocks>(std::move(source), number, !options.stream.empty(),
                                               is_from_bottom ? info.height : 0);
  return make_block_reader(std::move(blocks), std::move(info), name, options);
}

}  // namespace e2lf::recordings::aedat
