// SPDX-License-Identifier: MIT
// Reads and writes DAT; declared in codecs.h.

#include <algorithm>
#include <charconv>
#include <vector>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::formats::dat {
namespace {

constexpr size_t kTriggerBlock = 4096;
constexpr size_t kTypeBytes = 2, kRecordBytes = 8;
constexpr uint8_t kTypeEvent2d = 0x00, kTypeCd = 0x0C, kTypeTrigger = 0x0E;

struct Header {
  RecordingInfo info;
  int version = 1;
  uint8_t type = kTypeCd;
  size_t bytes = 0;  ///< offset of the records
};

size_t number_or_zero(const std::optional<std::string>& text) {
  size_t value = 0;
  if (text) std::from_chars(text->data(), text->data() + text->size(), value);
  return value > 65536 ? 0 : value;
}

/// Interprets the lines of the header and the two bytes after it. Returns nothing if they are not the start of a DAT
/// file: no "%" line, the keys of a RAW file, or another record type or size.
std::optional<Header> interpret(PercentHeader lines, std::span<const uint8_t> head) {
  if (lines.num_bytes == 0 || head.size() < lines.num_bytes + kTypeBytes) return std::nullopt;
  Header header;
  header.info.format = "dat";
  header.info.header = std::move(lines.keys);
  header.bytes = lines.num_bytes + kTypeBytes;
  if (header.info.find("evt") || header.info.find("format")) return std::nullopt;
  header.type = head[lines.num_bytes];
  const bool known = header.type == kTypeEvent2d || header.type == kTypeCd || header.type == kTypeTrigger;
  if (!known || head[lines.num_bytes + 1] != kRecordBytes) return std::nullopt;
  if (const auto version = number_or_zero(header.info.find("Version")); version != 0) {
    header.version = static_cast<int>(version);
  }
  header.info.width = number_or_zero(header.info.find("Width"));
  header.info.height = number_or_zero(header.info.find("Height"));
  return header;
}

/// Returns the header of a version 2 file.
std::string make_header(const RecordingInfo& info, uint8_t type) {
  std::string text = cat("% Data file containing ", type == kTypeTrigger ? "external trigger" : "CD", " events.\n");
  text += "% Version 2\n";
  if (const auto date = info.find("date")) text += cat("% Date ", header_text(*date), "\n");
  if (info.height != 0) text += cat("% Height ", info.height, "\n");
  if (info.width != 0) text += cat("% Width ", info.width, "\n");
  text += "% end\n";
  text += static_cast<char>(type);
  text += static_cast<char>(kRecordBytes);
  return text;
}

/// The layout of x, y and p in the second word of a record.
struct PlaceBits {
  uint32_t x_mask, y_shift, y_mask, p_shift, p_mask;
};
constexpr PlaceBits kVersion1 = {0x1FF, 9, 0xFF, 17, 0x1};
constexpr PlaceBits kVersion2 = {0x3FFF, 14, 0x3FFF, 28, 0xF};

/// Appends the records as events, except those with p > 1, and returns the number of these.
size_t append_events(std::span<const uint8_t> records, const PlaceBits& bits, TimeUnwrapper<32>& unwrap,
                     EventColumns& out) {
  const size_t begin = out.size(), count = records.size() / kRecordBytes;
  out.resize(begin + count);
  size_t next = begin;
  for (size_t i = 0; i < count; ++i) {
    const auto place = load_le<uint32_t>(&records[i * kRecordBytes + 4]);
    const uint32_t p = place >> bits.p_shift & bits.p_mask;
    out.x[next] = static_cast<uint16_t>(place & bits.x_mask);
    out.y[next] = static_cast<uint16_t>(place >> bits.y_shift & bits.y_mask);
    out.p[next] = static_cast<uint8_t>(p);
    out.t[next] = unwrap(load_le<uint32_t>(&records[i * kRecordBytes]));
    next += p <= 1;
  }
  out.resize(next);
  return begin + count - next;
}

Trigger trigger_of_record(const uint8_t* record, TimeUnwrapper<32>& unwrap) {
  const auto word = load_le<uint32_t>(record + 4);
  return {unwrap(load_le<uint32_t>(record)), static_cast<uint16_t>(word >> 26 & 0x3F),
          static_cast<uint8_t>(word & 0xF ? 1 : 0)};
}

Result<Header> read_header(ByteSource& source) {
  std::span<const uint8_t> head;
  std::optional<PercentHeader> lines;
  for (bool ended = false; !ended && !(lines && head.size() >= lines->num_bytes + kTypeBytes);) {
    const size_t wanted = head.size() + 1;
    E2LF_ASSIGN_OR_RETURN(head, source.fetch(wanted));
    ended = head.size() < wanted;
    lines = parse_percent_header(as_text(head), ended, DataBegin::kIsNoPercent);
  }
  std::optional<Header> header = lines ? interpret(*std::move(lines), head) : std::nullopt;
  if (!header) {
    return fail(ErrorCode::kFormat, source.name(),
                "this is not a DAT recording, which has a header of % lines and 8-byte records");
  }
  source.consume(header->bytes);
  return *std::move(header);
}

/// The records of a _trigger.dat file.
class TriggerFile final : public EventBlocks {
 public:
  /// `header_bytes` is the offset of the records and the position of the source.
  TriggerFile(SourcePtr source, size_t header_bytes) : source_(std::move(source)), header_bytes_(header_bytes) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    block.clear();
    E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(kRecordBytes));
    const size_t count = std::min(bytes.size() / kRecordBytes, kTriggerBlock);
    if (count == 0 && !bytes.empty()) summary.add(Violation::kTruncated, source_->position());
    for (size_t i = 0; i < count; ++i) block.triggers.push_back(trigger_of_record(&bytes[i * kRecordBytes], unwrap_));
    source_->consume(count * kRecordBytes);
    return count > 0;
  }

  Result<void> seek_before(int64_t) override {
    unwrap_ = {};
    return source_->seek(header_bytes_);
  }

 private:
  SourcePtr source_;
  size_t header_bytes_;
  TimeUnwrapper<32> unwrap_;
};

/// Returns the index of the first record that is text beginning with "%", as a header does, or their number if there is
/// none.
size_t find_text(std::span<const uint8_t> records) {
  const auto is_text = [](uint8_t byte) { return byte >= ' ' ? byte != 0x7F : byte >= '\t' && byte <= '\r'; };
  size_t at = 0;
  for (; at < records.size(); at += kRecordBytes) {
    const auto record = records.subspan(at, kRecordBytes);
    if (record[0] == '%' && std::ranges::all_of(record, is_text)) break;
  }
  return at / kRecordBytes;
}

/// The records of a file of events.
class DatBlocks final : public EventBlocks {
 public:
  DatBlocks(SourcePtr source, const Header& header)
      : source_(std::move(source)), header_bytes_(header.bytes), bits_(header.version == 1 ? kVersion1 : kVersion2) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    block.clear();
    begins_recording_ = false;
    E2LF_ASSIGN_OR_RETURN(const auto bytes,
                          source_->fetch(source_->seekable() ? kBlockRecords * kRecordBytes : kRecordBytes));
    size_t count = std::min(bytes.size() / kRecordBytes, kBlockRecords);
    byte_ = source_->position();
    if (count == 0 && !bytes.empty()) summary.add(Violation::kTruncated, byte_);
    const TimeUnwrapper<32> clock = unwrap_;
    size_t bad = append_events(bytes.first(count * kRecordBytes), bits_, unwrap_, block.events);
    if (const size_t text = bad > 0 ? find_text(bytes.first(count * kRecordBytes)) : count; text < count) {
      // A recording that was appended with its header.
      if (text == 0 && read_header(*source_)) {
        block.clear();
        unwrap_ = {};
        begins_recording_ = true;
        byte_ = source_->position();
        return true;
      }
      if (text > 0) {
        block.clear();
        unwrap_ = clock;
        count = text;
        bad = append_events(bytes.first(count * kRecordBytes), bits_, unwrap_, block.events);
      }
    }
    summary.add_dropped(Violation::kBadRecord, byte_, bad);
    source_->consume(count == 0 ? bytes.size() : count * kRecordBytes);
    return count > 0;
  }

  uint64_t block_byte() const override { return byte_; }
  bool begins_recording() const override { return begins_recording_; }
  size_t event_bytes() const override { return kRecordBytes; }

  /// Only a scan shows how often the clock has wrapped around.
  Result<void> seek_before(int64_t) override {
    unwrap_ = {};
    return source_->seek(header_bytes_);
  }

 private:
  /// Few enough to stay in the cache until they are used.
  static constexpr size_t kBlockRecords = size_t{1} << 15;

  SourcePtr source_;
  size_t header_bytes_;
  PlaceBits bits_;
  uint64_t byte_ = 0;
  bool begins_recording_ = false;
  TimeUnwrapper<32> unwrap_;
};

constexpr uint16_t kMaxCoordinate = 0x3FFF;
constexpr uint16_t kMaxTriggerId = 0x3F;

class DatWriter final : public RecordingWriter {
 public:
  /// If `trigger_file` is empty, triggers are dropped.
  DatWriter(SinkPtr sink, const RecordingInfo& info, std::filesystem::path trigger_file)
      : sink_(std::move(sink)),
        info_(info),
        trigger_file_(std::move(trigger_file)),
        check_(most_pixels(info.width), most_pixels(info.height), sink_->name()) {}

  bool holds_triggers() const override { return !trigger_file_.empty(); }

  Result<void> write(const EventBatch& batch) override {
    E2LF_RETURN_IF_ERROR(check_(batch));
    const EventColumns& events = batch.events;
    buffer_.resize(events.size() * kRecordBytes);
    for (size_t i = 0; i < events.size(); ++i) {
      E2LF_RETURN_IF_ERROR(check_time(events.t[i], unwrap_event_));
      const uint32_t place = static_cast<uint32_t>(events.p[i]) << 28 | static_cast<uint32_t>(events.y[i]) << 14 |
                             static_cast<uint32_t>(events.x[i]);
      store_le(&buffer_[i * kRecordBytes], static_cast<uint32_t>(events.t[i]));
      store_le(&buffer_[i * kRecordBytes + 4], place);
    }
    E2LF_RETURN_IF_ERROR(sink_->write(buffer_));
    return holds_triggers() ? write_triggers(batch.triggers) : Result<void>{};
  }

  Result<void> finish() override {
    if (trigger_sink_) E2LF_RETURN_IF_ERROR(trigger_sink_->commit());
    return sink_->commit();
  }

 private:
  /// Limits the sensor's size to the coordinates of the format; 0 = unknown.
  static size_t most_pixels(size_t size) {
    constexpr size_t kMost = kMaxCoordinate + size_t{1};
    return size == 0 ? kMost : std::min(size, kMost);
  }

  Result<void> write_triggers(const std::vector<Trigger>& triggers) {
    if (triggers.empty()) return {};
    if (!trigger_sink_) {
      E2LF_ASSIGN_OR_RETURN(trigger_sink_, open_file_sink(trigger_file_));
      E2LF_RETURN_IF_ERROR(trigger_sink_->write(as_bytes(make_header(info_, kTypeTrigger))));
    }
    buffer_.resize(triggers.size() * kRecordBytes);
    for (size_t i = 0; i < triggers.size(); ++i) {
      const Trigger& trigger = triggers[i];
      E2LF_RETURN_IF_ERROR(check_time(trigger.t, unwrap_trigger_));
      if (trigger.id > kMaxTriggerId) {
        return fail(ErrorCode::kInvalidValue, sink_->name(), "trigger id ", trigger.id,
                    " does not fit into DAT; write HDF5 instead");
      }
      store_le(&buffer_[i * kRecordBytes], static_cast<uint32_t>(trigger.t));
      store_le(&buffer_[i * kRecordBytes + 4], static_cast<uint32_t>(trigger.id) << 26 | trigger.p);
    }
    return trigger_sink_->write(buffer_);
  }

  /// Checks that a reader of the low 32 bits will obtain the same time.
  Result<void> check_time(int64_t t_us, TimeUnwrapper<32>& unwrap) const {
    if (unwrap(static_cast<uint32_t>(t_us)) == t_us) [[likely]] {
      return {};
    }
    return Error{ErrorCode::kInvalidValue,
                 cat("time ", t_us,
                     " us cannot be recovered from its low 32 bits; begin at zero or write another format, e.g. .hdf5"),
                 sink_->name(), "shift_time"};
  }

  SinkPtr sink_;
  RecordingInfo info_;
  std::filesystem::path trigger_file_;
  BatchCheck check_;
  SinkPtr trigger_sink_;
  std::vector<uint8_t> buffer_;
  TimeUnwrapper<32> unwrap_event_, unwrap_trigger_;
};

Result<WriterPtr> start(SinkPtr sink, const RecordingInfo& info, std::filesystem::path trigger_file) {
  E2LF_RETURN_IF_ERROR(sink->write(as_bytes(make_header(info, kTypeCd))));
  return WriterPtr(std::make_unique<DatWriter>(std::move(sink), info, std::move(trigger_file)));
}

}  // namespace

bool detect(std::span<const uint8_t> head) {
  auto lines = parse_percent_header(as_text(head), /*ended=*/true, DataBegin::kIsNoPercent);
  return lines && interpret(*std::move(lines), head);
}

std::filesystem::path trigger_path(const std::filesystem::path& path) {
  std::string stem = path.stem().string();
  if (stem.ends_with("_cd")) stem.resize(stem.size() - 3);
  return path.parent_path() / (stem + "_trigger" + path.extension().string());
}

bool is_trigger_file(const std::filesystem::path& path) {
  const auto source = open_file_source(path);
  if (!source) return false;
  const auto header = read_header(**source);
  return header && header->type == kTypeTrigger;
}

Result<ReaderPtr> open(SourcePtr source, const OpenOptions& options) {
  E2LF_ASSIGN_OR_RETURN(Header header, read_header(*source));
  E2LF_RETURN_IF_ERROR(apply_size_option(options, header.info, source->name()));
  if (header.type == kTypeTrigger) {
    return std::make_unique<RecordingReader>(nullptr, std::move(header.info), source->name(), options,
                                             std::make_unique<TriggerFile>(source, header.bytes));
  }
  BlocksPtr triggers;
  const auto beside = source->path().empty() ? std::filesystem::path() : path_beside(source->path(), trigger_path);
  if (is_present(beside)) {
    E2LF_ASSIGN_OR_RETURN(SourcePtr side, open_file_source(beside));
    E2LF_ASSIGN_OR_RETURN(const Header of_side, read_header(*side));
    if (of_side.type == kTypeTrigger) triggers = std::make_unique<TriggerFile>(std::move(side), of_side.bytes);
  }
  auto blocks = std::make_unique<DatBlocks>(source, header);
  return std::make_unique<RecordingReader>(std::move(blocks), std::move(header.info), source->name(), options,
                                           std::move(triggers));
}

Result<WriterPtr> create(SinkPtr sink, const RecordingInfo& info) {
  return start(std::move(sink), info, {});
}

Result<WriterPtr> create_file(const std::filesystem::path& path, const RecordingInfo& info) {
  E2LF_ASSIGN_OR_RETURN(auto sink, open_file_sink(path));
  return start(std::move(sink), info, trigger_path(path));
}

}  // namespace e2lf::formats::dat
