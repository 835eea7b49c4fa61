// SPDX-License-Identifier: MIT
// Reads AEDAT 4; declared in codecs.h.
#include <algorithm>
#include <map>
#include <optional>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/io/decompress.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::formats::aedat4 {
namespace {

struct Stream {
  int32_t id = 0;
  std::string type = {};  ///< "EVTS", "TRIG", "FRME", "IMUS"
  size_t width = 0, height = 0;
  std::string source = {};  ///< name of the camera
  std::string output = {};  ///< name of the stream in its module, e.g. "events"
};

struct Header {
  Compression compression = Compression::kNone;
  uint64_t table_position = 0;  ///< offset of the end of the packets; 0 = unknown, at the end of the file
  std::vector<Stream> streams;
};

constexpr std::string_view kVersion = "#!AER-DAT4.0";  // until "\r\n", or "\n" of some writers
constexpr size_t kMaxHeaderBytes = size_t{1} << 22;    // larger ones are damage

/// Reads the fields of a FlatBuffer. Every offset is checked against the buffer, so that damage yields nothing instead
/// of a wrong value. (A table begins with the distance back to its vtable, which lists the offsets of the fields.
/// Strings, vectors and sub-tables are referenced by u32 offsets.)
class FlatBuffer {
 public:
  explicit FlatBuffer(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  /// Returns the position of the root table if the identifier of the buffer is `id` (four characters).
  [[nodiscard]] std::optional<size_t> root(std::string_view id) const {
    const auto place = follow(0);
    if (!place || bytes_.size() < 8 || as_text(bytes_.subspan(4, 4)) != id) return std::nullopt;
    return place;
  }

  /// Returns the position of field number `field` of the table, or nothing if it has its default value or is damaged.
  [[nodiscard]] std::optional<size_t> field(size_t table, size_t field) const {
    const auto back = number<int32_t>(table);
    if (!back) return std::nullopt;
    const int64_t vtable = static_cast<int64_t>(table) - *back;
    if (vtable < 0) return std::nullopt;
    const auto vtable_size = number<uint16_t>(static_cast<size_t>(vtable));
    const size_t entry = 4 + 2 * field;
    if (!vtable_size || entry + 2 > *vtable_size) return std::nullopt;
    const auto offset = number<uint16_t>(static_cast<size_t>(vtable) + entry);
    if (!offset || *offset == 0) return std::nullopt;
    return table + *offset;
  }

  template <typename T>
  [[nodiscard]] std::optional<T> number(size_t place) const {
    if (place > bytes_.size() || bytes_.size() - place < sizeof(T)) return std::nullopt;
    return load_le<T>(bytes_.data() + place);
  }

  /// Returns the value of a numeric field, or its default.
  template <typename T>
  [[nodiscard]] T number_field(size_t table, size_t index, T default_value) const {
    const auto place = field(table, index);
    return place ? number<T>(*place).value_or(default_value) : default_value;
  }

  /// Returns the elements of a vector field, or the characters of a string field, with `element_size` bytes each.
  [[nodiscard]] std::optional<std::span<const uint8_t>> vector_field(size_t table, size_t index,
                                                                     size_t element_size) const {
    const auto place = field(table, index);
    const auto vector = place ? follow(*place) : std::nullopt;
    const auto count = vector ? number<uint32_t>(*vector) : std::nullopt;
    if (!count || (bytes_.size() - *vector - 4) / element_size < *count) return std::nullopt;
    return bytes_.subspan(*vector + 4, *count * element_size);
  }

  /// Returns the position to which the u32 offset at `place` points.
  [[nodiscard]] std::optional<size_t> follow(size_t place) const {
    const auto offset = number<uint32_t>(place);
    if (!offset || *offset > bytes_.size() - place) return std::nullopt;
    return place + *offset;
  }

  /// Returns the position of an element of a vector that vector_field() returned.
  [[nodiscard]] size_t place_of(const uint8_t* element) const { return static_cast<size_t>(element - bytes_.data()); }

 private:
  std::span<const uint8_t> bytes_;
};

constexpr size_t kCompressionField = 0, kTableField = 1, kInfoField = 2;

/// Returns the value of attribute `key` in a tag, e.g. path in <node name="0" path="/outInfo/0/"> or
/// path='/outInfo/0/'.
std::string_view attribute(std::string_view tag, std::string_view key) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::string with_equals = cat(key, "=");
  for (size_t begin = tag.find(with_equals); begin != std::string_view::npos;
       begin = tag.find(with_equals, begin + 1)) {
    const size_t quote = begin + with_equals.size();
    if (begin == 0 || kBlanks.find(tag[begin - 1]) == std::string_view::npos || quote >= tag.size()) continue;
    if (tag[quote] != '"' && tag[quote] != '\'') continue;
    const size_t end = tag.find(tag[quote], quote + 1);
    return end == std::string_view::npos ? std::string_view() : tag.substr(quote + 1, end - quote - 1);
  }
  return {};
}

/// Returns the number in a path ".../outInfo/<number>/" or ".../outInfo/<number>/info/".
std::optional<int32_t> stream_of_path(std::string_view path) {
  constexpr std::string_view kBefore = "/outInfo/";
  const size_t place = path.find(kBefore);
  if (place == std::string_view::npos) return std::nullopt;
  const std::string_view rest = path.substr(place + kBefore.size());
  const size_t end = rest.find('/');
  return end == std::string_view::npos ? std::nullopt : parse_number<int32_t>(rest.substr(0, end));
}

Stream& stream_with(std::vector<Stream>& streams, int32_t id) {
  const auto found = std::ranges::find(streams, id, &Stream::id);
  return found != streams.end() ? *found : streams.emplace_back(Stream{.id = id});
}

constexpr size_t kPacketHeader = 8, kSizePrefix = 4;
constexpr size_t kEventBytes = 16;  // i64 t, i16 x, i16 y, u8 on, padding
constexpr size_t kElementsField = 0, kTriggerTimeField = 0, kTriggerTypeField = 1;

/// The external signals by their type in the format, without their times.
constexpr std::pair<int8_t, Trigger> kSignals[] = {
    {1, {0, 0, 1}}, {2, {0, 0, 0}}, {3, {0, 0, 1}}, {4, {0, 1, 1}}, {5, {0, 1, 0}}};

/// Parses the streams in the header's XML: nodes /mainloop/.../outInfo/<id>/ with typeIdentifier, sizeX, sizeY and
/// source.
std::vector<Stream> parse_streams(std::string_view xml) {
  std::vector<Stream> streams;
  std::optional<int32_t> current;
  for (size_t begin = xml.find('<'); begin != std::string_view::npos; begin = xml.find('<', begin + 1)) {
    const size_t end = xml.find('>', begin);
    if (end == std::string_view::npos) break;
    const std::string_view tag = xml.substr(begin, end - begin);
    if (tag.starts_with("<node")) {
      current = stream_of_path(attribute(tag, "path"));
    } else if (tag.starts_with("<attr") && current) {
      const std::string_view key = attribute(tag, "key");
      const std::string_view value = xml.substr(end + 1, xml.find('<', end) - end - 1);
      Stream& stream = stream_with(streams, *current);
      if (key == "typeIdentifier") stream.type = value;
      if (key == "sizeX") stream.width = parse_side(value, 65536).value_or(0);
      if (key == "sizeY") stream.height = parse_side(value, 65536).value_or(0);
      if (key == "source") stream.source = value;
      if (key == "originalOutputName") stream.output = value;
    }
  }
  return streams;
}

/// The number of bytes that show where the header ends.
constexpr size_t kHeaderBegin = kVersion.size() + 6;

/// The header in bytes of the file: its FlatBuffer.
struct HeaderPlace {
  size_t begin = 0, end = 0;
};

/// Returns the place of the header from the first kHeaderBegin bytes, or nothing if it is not an AEDAT 4 file.
std::optional<HeaderPlace> header_place(std::span<const uint8_t> head) {
  const std::string_view text = as_text(head);
  if (head.size() < kHeaderBegin || !text.starts_with(kVersion)) return std::nullopt;
  const size_t line = text.find('\n', kVersion.size()) + 1;
  if (line != kVersion.size() + 1 && (line != kVersion.size() + 2 || text[line - 2] != '\r')) return std::nullopt;
  return HeaderPlace{line + 4, line + 4 + load_le<uint32_t>(head.data() + line)};
}

/// Reads the header at the position of the source, after which the packets follow. Returns nothing if there is none.
/// Fails with kFormat and kIo.
Result<std::optional<Header>> read_header(ByteSource& source) {
  E2LF_ASSIGN_OR_RETURN(auto bytes, source.fetch(kHeaderBegin));
  const auto place = header_place(bytes);
  if (!place || place->end > kMaxHeaderBytes) return std::optional<Header>();
  E2LF_ASSIGN_OR_RETURN(bytes, source.fetch(place->end));
  const Error malformed{ErrorCode::kFormat, "the AEDAT4 header is damaged; record or copy the file again",
                        source.name()};
  if (place->end > bytes.size()) return malformed;
  const FlatBuffer buffer(bytes.subspan(place->begin, place->end - place->begin));
  const auto root = buffer.root("IOHE");
  if (!root) return malformed;
  Header header;
  header.compression = static_cast<Compression>(buffer.number_field<int32_t>(*root, kCompressionField, 0));
  const auto table = buffer.number_field<int64_t>(*root, kTableField, -1);
  header.table_position = table > 0 ? static_cast<uint64_t>(table) : 0;
  const auto info = buffer.vector_field(*root, kInfoField, 1);
  if (!info) return malformed;
  header.streams = parse_streams(as_text(*info));
  source.consume(place->end);
  return std::optional(std::move(header));
}

/// Returns the elements of a decompressed packet, which may be none, or nothing if it is of another kind or truncated.
std::optional<std::span<const uint8_t>> elements_of(const FlatBuffer& packet, std::string_view id, size_t bytes_each) {
  const auto root = packet.root(id);
  if (!root) return std::nullopt;
  if (!packet.field(*root, kElementsField)) return std::span<const uint8_t>();
  return packet.vector_field(*root, kElementsField, bytes_each);
}

/// Appends the events of an EVTS packet. Returns false, without appending any, if it is not one or is truncated.
/// Negative coordinates become 65535, which is outside any sensor.
bool append_events(const FlatBuffer& packet, EventColumns& events) {
  const auto elements = elements_of(packet, "EVTS", kEventBytes);
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

/// Appends the external signals of a TRIG packet. Returns false if it is not one.
bool append_triggers(const FlatBuffer& packet, std::vector<Trigger>& triggers) {
  const auto elements = elements_of(packet, "TRIG", sizeof(uint32_t));
  if (!elements) return false;
  for (size_t i = 0; i < elements->size(); i += sizeof(uint32_t)) {
    const auto table = packet.follow(packet.place_of(elements->data() + i));
    if (!table) return false;
    const auto type = packet.number_field<int8_t>(*table, kTriggerTypeField, 0);
    for (const auto& [known, signal] : kSignals) {
      if (known != type) continue;
      triggers.push_back({packet.number_field<int64_t>(*table, kTriggerTimeField, 0), signal.id, signal.p});
    }
  }
  return true;
}

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
        std::ranges::any_of(event_streams, [&](const Stream& stream) { return stream.source != events.source; });
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
    if (!packet && as_text(bytes).starts_with(kVersion.substr(0, kPacketHeader))) return read_appended_header();
    if (!packet) return pass_over_unknown(summary);
    E2LF_ASSIGN_OR_RETURN(bytes, source_->fetch(packet->bytes));
    if (bytes.size() < packet->bytes) return give_up(Violation::kTruncated, summary);
    const auto packed = bytes.subspan(kPacketHeader, packet->bytes - kPacketHeader);
    if (packet->use == Use::kLeftOut) {
      ++summary.other_streams;
    } else if (packet->use != Use::kNone && !append_packet(packed, packet->use, block)) {
      summary.add_dropped(Violation::kBadRecord, position);
    }
    source_->consume(packet->bytes);
    if (!block.events.empty() && std::ranges::none_of(block.events.t, is_time)) {
      return fail(ErrorCode::kFormat, cat(source_->name(), ": byte ", position),
                  "the times of the events are too large to be microseconds, as AEDAT4 has them, such as nanoseconds "
                  "of a computer's clock; write microseconds");
    }
    return true;
  }

  bool begins_recording() const override { return begins_recording_; }

  Result<void> seek_before(int64_t) override {
    has_given_up_ = false;
    header_.table_position = first_table_position_;
    return source_->seek(begin_);
  }

 private:
  /// Skips a packet of a stream that the header does not list, which it is if another packet follows. Otherwise, bytes
  /// are missing, and the position of the next packet is unknown; without a table, the table may also begin here.
  Result<bool> pass_over_unknown(DecodeSummary& summary) {
    E2LF_ASSIGN_OR_RETURN(auto bytes, source_->fetch(kPacketHeader));
    const auto size = load_le<int32_t>(bytes.data() + 4);
    if (size <= 0 || static_cast<size_t>(size) > kMaxPacketBytes) return give_up(Violation::kMisaligned, summary);
    const size_t end = kPacketHeader + static_cast<size_t>(size);
    E2LF_ASSIGN_OR_RETURN(bytes, source_->fetch(end + kPacketHeader));
    const auto after = bytes.size() >= end + kPacketHeader ? parse_packet(bytes.subspan(end)) : std::nullopt;
    const bool is_followed = after && after->bytes > kPacketHeader;
    if (!is_followed && (header_.table_position == 0 || source_->position() + end != header_.table_position)) {
      return give_up(Violation::kMisaligned, summary);
    }
    ++summary.other_streams;
    source_->consume(end);
    return true;
  }

  /// Skips the table of the packets to the header of an appended recording. Returns false if there is none.
  Result<bool> pass_over_table() {
    constexpr size_t kSearchedBytes = size_t{1} << 16;
    for (;;) {
      E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(kSearchedBytes));
      const auto line = std::search(bytes.begin(), bytes.end(), kVersion.begin(), kVersion.end());
      if (line != bytes.end()) {
        source_->consume(static_cast<size_t>(line - bytes.begin()));
        return read_appended_header();
      }
      const bool has_ended = bytes.size() < kSearchedBytes;
      source_->consume(has_ended ? bytes.size() : bytes.size() - kVersion.size());
      if (has_ended) return false;
    }
  }

  /// Reads the header of an appended recording, whose streams are identified with those of the first one.
  Result<bool> read_appended_header() {
    const uint64_t begin = source_->position();
    E2LF_ASSIGN_OR_RETURN(const auto header, read_header(*source_));
    if (!header) return false;
    if (header->compression != header_.compression) {
      return fail(ErrorCode::kUnsupported, cat(source_->name(), ": byte ", begin),
                  "the recording that was appended here is compressed in another way; split the file here");
    }
    header_.table_position = header->table_position == 0 ? 0 : begin + header->table_position;
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
    const FlatBuffer packet(std::span<const uint8_t>(unpacked_).subspan(std::min(unpacked_.size(), kSizePrefix)));
    return use == Use::kEvents ? append_events(packet, block.events) : append_triggers(packet, block.triggers);
  }

  /// Ends the packets here.
  Result<bool> give_up(Violation violation, DecodeSummary& summary) {
    if (!std::exchange(has_given_up_, true)) summary.add(violation, source_->position());
    return false;
  }

  SourcePtr source_;
  uint64_t begin_ = source_->position();  ///< of the packets
  Header header_;
  uint64_t first_table_position_ = header_.table_position;
  std::map<int32_t, Use> uses_;
  std::vector<uint8_t> unpacked_;
  bool has_given_up_ = false;
  bool begins_recording_ = false;
};

std::vector<Stream> streams_of_events(const Header& header) {
  std::vector<Stream> streams = header.streams;
  std::erase_if(streams, [](const Stream& stream) { return stream.type != "EVTS"; });
  std::ranges::sort(streams, {}, &Stream::id);
  return streams;
}

}  // namespace

bool detect(std::span<const uint8_t> head) {
  return header_place(head).has_value();
}

Result<ReaderPtr> open(SourcePtr source, const OpenOptions& options) {
  const std::string name = source->name();
  E2LF_ASSIGN_OR_RETURN(const auto found, read_header(*source));
  if (!found) return fail(ErrorCode::kFormat, name, "this is not an AEDAT4 recording, or its header is damaged");
  const Header& header = *found;
  if (const auto known = check_compression(header.compression); !known) {
    return Error{known.error().code, known.error().message, name};
  }

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
