// SPDX-License-Identifier: MIT
#include <algorithm>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/codecs/dat/dat.h"
#include "e2lf/recordings/codecs/dat/dat_seek.h"
#include "e2lf/recordings/event_gate.h"
#include "e2lf/recordings/io/unpacked_source.h"
#include "e2lf/recordings/trigger_feed.h"

namespace e2lf::recordings::dat {
namespace {

constexpr size_t kTriggerBlock = 4096;

/// Where a record's second word keeps x, y and p.
struct PlaceBits {
  uint32_t x_mask, y_shift, y_mask, p_shift, p_mask;
};
constexpr PlaceBits kVersion1 = {0x1FF, 9, 0xFF, 17, 0x1};
constexpr PlaceBits kVersion2 = {0x3FFF, 14, 0x3FFF, 28, 0xF};

/// Appends the records as events; one with p > 1 is dropped. Returns how many were dropped.
size_t append_events(std::span<const uint8_t> records, const PlaceBits& bits, TimeUnwrapper& unwrap,
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

Trigger trigger_of_record(const uint8_t* record, TimeUnwrapper& unwrap) {
  const auto word = load_le<uint32_t>(record + 4);
  return {unwrap(load_le<uint32_t>(record)), static_cast<uint16_t>(word >> 26 & 0x3F),
          static_cast<uint8_t>(word & 0xF ? 1 : 0)};
}

Result<Header> read_header(ByteSource& source) {
  E2LF_ASSIGN_OR_RETURN(const auto head, source.fetch(kDetectBytes));
  std::optional<Header> header = parse_header(head.first(std::min(head.size(), kDetectBytes)));
  if (!header) {
    return Error{ErrorCode::kFormat, "not a DAT recording; a header of % lines and 8-byte records are needed",
                 source.name()};
  }
  source.consume(header->bytes);
  return *std::move(header);
}

/// The records of a _trigger.dat file.
class TriggerFile final : public TriggerSource {
 public:
  /// `header_bytes` is where the records begin and the source stands.
  TriggerFile(std::unique_ptr<ByteSource> source, size_t header_bytes)
      : source_(std::move(source)), header_bytes_(header_bytes) {}

  Result<bool> next(std::vector<Trigger>& block, DecodeSummary& summary) override {
    E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(kRecordBytes));
    const size_t count = std::min(bytes.size() / kRecordBytes, kTriggerBlock);
    if (count == 0 && !bytes.empty()) summary.add(Violation::kTruncated, source_->position());
    for (size_t i = 0; i < count; ++i) block.push_back(trigger_of_record(&bytes[i * kRecordBytes], unwrap_));
    source_->consume(count * kRecordBytes);
    return count > 0;
  }

  Result<void> rewind() override {
    unwrap_ = {};
    return source_->seek(header_bytes_);
  }

 private:
  std::unique_ptr<ByteSource> source_;
  size_t header_bytes_;
  TimeUnwrapper unwrap_;
};

class DatReader final : public RecordingReader {
 public:
  DatReader(std::unique_ptr<ByteSource> source, Header header, TriggerFeed triggers, const OpenOptions& options)
      : RecordingReader(options),
        source_(std::move(source)),
        header_(std::move(header)),
        triggers_(std::move(triggers)),
        gate_(header_.info.width, header_.info.height, kRecordBytes) {
    info_ = header_.info;
    name_ = source_->name();
  }

 protected:
  Result<bool> read_next(EventBatch& batch, size_t max_events) override {
    const size_t begin = batch.events.size();
    gate_.release(batch.events);
    const size_t room = max_events - (batch.events.size() - begin);
    E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(source_->seekable() ? room * kRecordBytes : kRecordBytes));
    const size_t count = std::min(bytes.size() / kRecordBytes, room);
    const bool is_end = count == 0;
    const uint64_t byte = source_->position();
    if (is_end && !bytes.empty()) summary_.add(Violation::kTruncated, byte);

    const size_t bad = append_events(bytes.first(count * kRecordBytes), header_.version == 1 ? kVersion1 : kVersion2,
                                     unwrap_, batch.events);
    if (bad > 0) summary_.add(Violation::kBadRecord, byte, bad);
    summary_.dropped_words += bad;
    gate_.filter(batch.events, begin, is_end, byte, summary_);
    source_->consume(is_end ? bytes.size() : count * kRecordBytes);
    return triggers_.take_beside(batch, begin, !is_end, max_events, summary_);
  }

  Result<void> seek_before(int64_t t_us) override {
    E2LF_ASSIGN_OR_RETURN(const Place place, find_place_before(*source_, header_.bytes, t_us));
    E2LF_RETURN_IF_ERROR(source_->seek(header_.bytes + place.record * kRecordBytes));
    unwrap_ = place.clock;
    gate_.reset();
    return triggers_.rewind();
  }

 private:
  std::unique_ptr<ByteSource> source_;
  Header header_;
  TriggerFeed triggers_;
  EventGate gate_;
  TimeUnwrapper unwrap_;
};

/// A file of triggers opened as the recording itself.
class DatTriggerReader final : public RecordingReader {
 public:
  DatTriggerReader(std::unique_ptr<ByteSource> source, const Header& header, const OpenOptions& options)
      : RecordingReader(options) {
    info_ = header.info;
    name_ = source->name();
    triggers_ = TriggerFeed(std::make_unique<TriggerFile>(std::move(source), header.bytes));
  }

 protected:
  Result<bool> read_next(EventBatch& batch, size_t max_events) override {
    return triggers_.take(INT64_MAX, max_events, batch.triggers, summary_);
  }
  Result<void> seek_before(int64_t) override { return triggers_.rewind(); }

 private:
  TriggerFeed triggers_;
};

}  // namespace

bool detect(std::span<const uint8_t> head) {
  return parse_header(head).has_value();
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

Result<std::unique_ptr<RecordingReader>> open(std::unique_ptr<ByteSource> source, const OpenOptions& options) {
  E2LF_ASSIGN_OR_RETURN(Header header, read_header(*source));
  E2LF_RETURN_IF_ERROR(apply_size_option(options, header.info, source->name()));
  std::unique_ptr<RecordingReader> reader;
  if (header.type == kTypeTrigger) {
    reader = std::make_unique<DatTriggerReader>(std::move(source), header, options);
    return reader;
  }
  TriggerFeed triggers;
  std::unique_ptr<ByteSource> trigger_source;
  if (const std::filesystem::path path = source->logical_path(); !path.empty()) {
    E2LF_ASSIGN_OR_RETURN(trigger_source, open_file_beside(trigger_path(path)));
  }
  if (trigger_source != nullptr) {
    E2LF_ASSIGN_OR_RETURN(const Header trigger_header, read_header(*trigger_source));
    if (trigger_header.type == kTypeTrigger) {
      triggers = TriggerFeed(std::make_unique<TriggerFile>(std::move(trigger_source), trigger_header.bytes));
    }
  }
  reader = std::make_unique<DatReader>(std::move(source), std::move(header), std::move(triggers), options);
  return reader;
}

}  // namespace e2lf::recordings::dat
