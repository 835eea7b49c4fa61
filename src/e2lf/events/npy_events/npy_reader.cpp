// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>

#include "e2lf/base/npy_header.h"
#include "e2lf/base/text.h"
#include "e2lf/events/batch_check.h"
#include "e2lf/events/event_blocks.h"
#include "e2lf/events/npy_events/column_convert.h"
#include "e2lf/events/npy_events/npy_events.h"
#include "e2lf/events/registry.h"
#include "e2lf/events/side_triggers.h"
#include "e2lf/events/time_search.h"

namespace e2lf::events::npy_events {
namespace {

constexpr size_t kBlockBytes = size_t{1} << 20;
constexpr size_t kMaxRecordBytes = 4096;

struct RecordFields {
  NumberField x, y, p, t;
};

/// The field of a record that has one of the names.
Result<NumberField> find_field(const NpyArray& array, std::initializer_list<const char*> names,
                               const std::string& location) {
  for (const NpyField& field : array.fields) {
    if (std::find(names.begin(), names.end(), field.name) == names.end()) continue;
    if (!is_integer_type(field.type)) {
      return Error{ErrorCode::kUnsupported,
                   cat("field \"", field.name, "\" is of type ", field.type, "; store whole numbers, times in us"),
                   location};
    }
    return NumberField{field.type, field.offset, array.item_size};
  }
  return Error{ErrorCode::kFormat, cat("the records have no field \"", *names.begin(), "\"; are they events?"),
               location};
}

Result<RecordFields> find_fields(const NpyArray& array, const std::string& location) {
  RecordFields fields;
  E2LF_ASSIGN_OR_RETURN(fields.x, find_field(array, {"x"}, location));
  E2LF_ASSIGN_OR_RETURN(fields.y, find_field(array, {"y"}, location));
  E2LF_ASSIGN_OR_RETURN(fields.p, find_field(array, {"p", "polarity", "on"}, location));
  E2LF_ASSIGN_OR_RETURN(fields.t, find_field(array, {"t", "ts", "timestamp"}, location));
  return fields;
}

class NpyBlocks final : public EventBlocks {
 public:
  NpyBlocks(std::unique_ptr<ByteSource> source, NpyHeader header, RecordFields fields)
      : source_(std::move(source)), header_(std::move(header)), fields_(std::move(fields)) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    block.clear();
    const size_t item = header_.array.item_size;
    const size_t left = header_.array.shape[0] - next_;
    if (left == 0) return false;
    const size_t wanted = std::min(left, kBlockBytes / item);
    E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(source_->seekable() ? wanted * item : item));
    const size_t count = std::min(wanted, bytes.size() / item);
    const uint64_t byte = source_->position();
    if (count == 0) {
      if (!std::exchange(is_cut_told_, true)) summary.add(Violation::kTruncated, byte);
      return false;
    }
    const size_t bad = convert(bytes.first(count * item), count, block.events);
    if (bad > 0) summary.add(Violation::kBadRecord, byte, bad);
    summary.dropped_words += bad;
    source_->consume(count * item);
    next_ += count;
    return true;
  }

  Result<void> seek_before(int64_t t_us) override {
    const size_t item = header_.array.item_size;
    is_cut_told_ = false;
    // No more than there is: the header alone is not believed.
    const uint64_t stored = source_->size().value_or(0) / item;
    const uint64_t count = std::min<uint64_t>(header_.array.shape[0], stored);
    E2LF_ASSIGN_OR_RETURN(next_, find_place_before(count, t_us, [&](uint64_t i) { return time_at(i); }));
    return source_->seek(header_.data_offset + next_ * item);
  }

 private:
  /// The time at record i; that of the end is later than any.
  Result<int64_t> time_at(uint64_t i) {
    const size_t item = header_.array.item_size;
    E2LF_RETURN_IF_ERROR(source_->seek(header_.data_offset + i * item));
    E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(kTimesPerProbe * item));
    const size_t count = std::min(bytes.size() / item, kTimesPerProbe);
    if (count == 0) return INT64_MAX;
    EventColumns events;
    convert(bytes.first(count * item), count, events);
    if (events.empty()) return INT64_MAX;
    return median_time({events.t.begin(), events.t.end()});
  }

  /// Returns how many records are not events.
  size_t convert(std::span<const uint8_t> bytes, size_t count, EventColumns& events) {
    const uint8_t* records = bytes.data();
    if (!header_.big_endian.empty()) records = reverse_big_endian(bytes);
    events.resize(count);
    bad_.assign(count, 0);
    to_column(records, fields_.x, count, events.x.data(), bad_.data());
    to_column(records, fields_.y, count, events.y.data(), bad_.data());
    to_column(records, fields_.p, count, events.p.data(), bad_.data());
    to_column(records, fields_.t, count, events.t.data(), bad_.data());
    for (size_t i = 0; i < count; ++i) bad_[i] |= events.p[i] > 1;
    if (std::find_if(bad_.begin(), bad_.end(), [](uint8_t b) { return b != 0; }) == bad_.end()) return 0;
    return remove_bad(events, 0, bad_);
  }

  const uint8_t* reverse_big_endian(std::span<const uint8_t> bytes) {
    little_.assign(bytes.begin(), bytes.end());
    for (size_t item = 0; item < little_.size(); item += header_.array.item_size) {
      for (const NpyHeader::Number& number : header_.big_endian) {
        const auto begin = little_.begin() + static_cast<ptrdiff_t>(item + number.offset);
        std::reverse(begin, begin + static_cast<ptrdiff_t>(number.size));
      }
    }
    return little_.data();
  }

  std::unique_ptr<ByteSource> source_;
  NpyHeader header_;
  RecordFields fields_;
  size_t next_ = 0;
  bool is_cut_told_ = false;
  Column<uint8_t> bad_;
  std::vector<uint8_t> little_;
};

Result<NpyHeader> read_header(std::span<const uint8_t> head, const std::string& name) {
  E2LF_ASSIGN_OR_RETURN(NpyHeader header, parse_npy_header(head, name));
  if (header.array.shape.size() != 1 || header.array.fields.empty() || header.array.item_size > kMaxRecordBytes) {
    return Error{ErrorCode::kShape, "not a one-dimensional array of records; store events with fields x, y, p, t",
                 name};
  }
  return header;
}

}  // namespace

bool detect_npy(std::span<const uint8_t> head) {
  const auto header = read_header(head, "");
  return header.ok() && find_fields(header->array, "").ok();
}

Result<std::unique_ptr<RecordingReader>> open_npy(std::unique_ptr<ByteSource> source, const OpenOptions& options) {
  const std::string name = source->name();
  E2LF_ASSIGN_OR_RETURN(const auto head, source->fetch(kDetectBytes));
  E2LF_ASSIGN_OR_RETURN(NpyHeader header, read_header(head.first(std::min(head.size(), kDetectBytes)), name));
  E2LF_ASSIGN_OR_RETURN(RecordFields fields, find_fields(header.array, name));
  RecordingInfo info;
  info.format = "npy";
  E2LF_RETURN_IF_ERROR(apply_size_option(options, info, name));
  source->consume(header.data_offset);
  E2LF_ASSIGN_OR_RETURN(TriggerFeed triggers, open_side_triggers(source->path()));
  return make_block_reader(std::make_unique<NpyBlocks>(std::move(source), std::move(header), std::move(fields)),
                           std::move(info), name, options, std::move(triggers));
}

}  // namespace e2lf::events::npy_events
