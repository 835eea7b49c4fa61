// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>

#include "e2lf/base/text.h"
#include "e2lf/files/npy_header.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/codecs/numpy/column_convert.h"
#include "e2lf/recordings/codecs/numpy/numpy.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/side_triggers.h"
#include "e2lf/recordings/time_search.h"
#include "e2lf/recordings/time_sort.h"

namespace e2lf::recordings::numpy {
namespace {

constexpr size_t kBlockBytes = size_t{1} << 20;
constexpr size_t kMaxRecordBytes = 4096;
constexpr size_t kSampledRows = 4096;  // of an array [events, 4], to tell its columns

/// The field of a record that has one of the names.
Result<NumberField> find_field(const NpyArray& array, std::initializer_list<const char*> names,
                               const std::string& location) {
  for (const NpyField& field : array.fields) {
    if (std::find(names.begin(), names.end(), field.name) == names.end()) continue;
    if (!is_number_type(field.type)) {
      return Error{ErrorCode::kUnsupported,
                   cat("field \"", field.name, "\" is of type ", field.type, "; store numbers, as u2 and i8"),
                   location};
    }
    return NumberField{field.type, field.offset, array.item_size};
  }
  return Error{ErrorCode::kFormat, cat("the records have no field \"", *names.begin(), "\"; are they events?"),
               location};
}

/// Whether an array is [events, 4].
bool has_four_columns(const NpyArray& array) {
  return array.fields.empty() && array.shape.size() == 2 && array.shape[1] == 4 && is_number_type(array.type);
}

Result<RecordFields> find_fields(const NpyArray& array, const std::string& location) {
  RecordFields fields;
  E2LF_ASSIGN_OR_RETURN(fields.x, find_field(array, {"x"}, location));
  E2LF_ASSIGN_OR_RETURN(fields.y, find_field(array, {"y"}, location));
  E2LF_ASSIGN_OR_RETURN(fields.p, find_field(array, {"p", "polarity", "on"}, location));
  E2LF_ASSIGN_OR_RETURN(fields.t, find_field(array, {"t", "ts", "timestamp"}, location));
  return fields;
}

/// Copies records of big-endian numbers as little-endian ones.
void reverse_big_endian(std::span<const uint8_t> bytes, const NpyHeader& header, std::vector<uint8_t>& little) {
  little.assign(bytes.begin(), bytes.end());
  for (size_t item = 0; item < little.size(); item += header.array.item_size) {
    for (const NpyHeader::Number& number : header.big_endian) {
      const auto begin = little.begin() + static_cast<ptrdiff_t>(item + number.offset);
      std::reverse(begin, begin + static_cast<ptrdiff_t>(number.size));
    }
  }
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
    if (!header_.big_endian.empty()) {
      reverse_big_endian(bytes, header_, little_);
      records = little_.data();
    }
    return to_events(records, fields_, count, events);
  }

  std::unique_ptr<ByteSource> source_;
  NpyHeader header_;
  RecordFields fields_;
  size_t next_ = 0;
  bool is_cut_told_ = false;
  std::vector<uint8_t> little_;
};

Result<NpyHeader> read_header(std::span<const uint8_t> head, const std::string& name) {
  E2LF_ASSIGN_OR_RETURN(NpyHeader header, parse_npy_header(head, name));
  if (has_four_columns(header.array) && !header.fortran_order) return header;
  if (header.array.shape.size() != 1 || header.array.fields.empty() || header.array.item_size > kMaxRecordBytes) {
    return Error{
        ErrorCode::kShape,
        "neither a one-dimensional array of records with fields x, y, p, t nor an array [events, 4] in C order; "
        "store one of them",
        name};
  }
  return header;
}

/// Makes the rows of an array [events, 4] records, and says where the numbers of an event are in them.
Result<RecordFields> find_columns(std::span<const uint8_t> bytes, const std::string& order, const std::string& name,
                                  NpyHeader& header, RecordingInfo& info) {
  const size_t number_bytes = header.array.item_size;
  if (!header.big_endian.empty()) {
    for (size_t i = 1; i < 4; ++i) header.big_endian.push_back({i * number_bytes, number_bytes});
  }
  header.array.item_size = 4 * number_bytes;
  const size_t count = std::min({bytes.size() / header.array.item_size, kSampledRows, header.array.shape[0]});
  bytes = bytes.first(count * header.array.item_size);
  std::vector<uint8_t> little;
  if (!header.big_endian.empty()) {
    reverse_big_endian(bytes, header, little);
    bytes = little;
  }
  const auto rows = sample_rows(bytes.data(), header.array.type, number_bytes, count);
  E2LF_ASSIGN_OR_RETURN(const std::string found, find_column_order(rows, order, name));
  if (order.empty()) info.assumptions.push_back(column_assumption(found));
  return fields_of_rows(found, header.array.type, number_bytes);
}

/// Where the numbers of an event are; the source stands at the first record.
Result<RecordFields> fields_of(ByteSource& source, const std::string& order, NpyHeader& header, RecordingInfo& info) {
  const std::string name = source.name();
  if (!has_four_columns(header.array)) return find_fields(header.array, name);
  E2LF_ASSIGN_OR_RETURN(const auto bytes, source.fetch(kSampledRows * 4 * header.array.item_size));
  return find_columns(bytes, order, name, header, info);
}

/// The unit of the times; the source stands at the first record.
Result<TimeUnit> unit_of(ByteSource& source, TimeUnit named, const NpyHeader& header, const NumberField& times,
                         RecordingInfo& info) {
  const size_t record_bytes = header.array.item_size;
  E2LF_ASSIGN_OR_RETURN(auto bytes, source.fetch(kSampledRows * record_bytes));
  const size_t count = std::min({bytes.size() / record_bytes, kSampledRows, header.array.shape[0]});
  bytes = bytes.first(count * record_bytes);
  std::vector<uint8_t> little;
  if (!header.big_endian.empty()) {
    reverse_big_endian(bytes, header, little);
    bytes = little;
  }
  return find_time_unit(named, bytes.data(), times, count, info.assumptions);
}

/// Fails where a file goes on behind the events that its header counts: it was never finished, or its header is wrong.
Result<void> check_count(const NpyHeader& header, const ByteSource& source) {
  const uint64_t bytes = source.size().value_or(0);
  const uint64_t stored = bytes < header.data_offset ? 0 : (bytes - header.data_offset) / header.array.item_size;
  if (stored <= header.array.shape[0]) return {};
  return Error{ErrorCode::kFormat,
               cat("the header says ", header.array.shape[0], " events, and the file holds ", stored,
                   ": it was not finished; write it again, or correct the shape in its header"),
               source.name()};
}

}  // namespace

bool detect_npy(std::span<const uint8_t> head) {
  const auto header = read_header(head, "");
  return header.ok() && (has_four_columns(header->array) || find_fields(header->array, "").ok());
}

Result<std::unique_ptr<RecordingReader>> open_npy(std::unique_ptr<ByteSource> source, const OpenOptions& options) {
  const std::string name = source->name();
  E2LF_ASSIGN_OR_RETURN(const auto head, source->fetch(kDetectBytes));
  E2LF_ASSIGN_OR_RETURN(NpyHeader header, read_header(head.first(std::min(head.size(), kDetectBytes)), name));
  RecordingInfo info;
  info.format = "npy";
  E2LF_RETURN_IF_ERROR(apply_size_option(options, info, name));
  source->consume(header.data_offset);
  E2LF_ASSIGN_OR_RETURN(RecordFields fields, fields_of(*source, options.columns, header, info));
  E2LF_RETURN_IF_ERROR(check_count(header, *source));
  E2LF_ASSIGN_OR_RETURN(fields.unit, unit_of(*source, options.time_unit, header, fields.t, info));
  E2LF_ASSIGN_OR_RETURN(TriggerFeed triggers, open_side_triggers(source->logical_path()));
  const bool is_seekable = source->seekable();
  auto records = std::make_unique<NpyBlocks>(std::move(source), std::move(header), std::move(fields));
  return make_block_reader(make_time_sorted(std::move(records), is_seekable, name), std::move(info), name, options,
                           std::move(triggers));
}

}  // namespace e2lf::recordings::numpy
