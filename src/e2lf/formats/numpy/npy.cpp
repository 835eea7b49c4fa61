// SPDX-License-Identifier: MIT
// Reads and writes events in .npy files; declared in codecs.h.
#include "e2lf/files/npy.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/formats/table/layout.h"
#include "e2lf/formats/table/table_reader.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/side_triggers.h"

namespace e2lf::formats::numpy {
using table::kSampledRows;
using table::NumberField;
using table::RecordFields;

namespace {

constexpr size_t kBlockBytes = size_t{1} << 20;
constexpr size_t kMaxRecordBytes = 4096;

/// Returns whether an array is [events, 4].
bool has_four_columns(const NpyArray& array) {
  return array.fields.empty() && array.shape.size() == 2 && array.shape[1] == 4 && table::is_number_type(array.type);
}

/// Returns whether records have fields that can be those of events.
bool has_event_fields(const NpyArray& array) {
  const auto names_time = [](const NpyField& field) {
    return table::parse_column_name(field.name).field == table::Field::kT;
  };
  return std::any_of(array.fields.begin(), array.fields.end(), names_time) && array.fields.size() >= 4;
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
  NpyBlocks(SourcePtr source, NpyHeader header, RecordFields fields)
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
      if (!std::exchange(is_cut_reported_, true)) summary.add(Violation::kTruncated, byte);
      return false;
    }
    const size_t bad = convert(bytes.first(count * item), count, block.events);
    summary.add_dropped(Violation::kBadRecord, byte, bad);
    source_->consume(count * item);
    next_ += count;
    return true;
  }

  Result<void> seek_before(int64_t t_us) override {
    const size_t item = header_.array.item_size;
    is_cut_reported_ = false;
    // Limited to the actual size, because the header may be wrong.
    const uint64_t stored = source_->size().value_or(0) / item;
    const uint64_t count = std::min<uint64_t>(header_.array.shape[0], stored);
    E2LF_ASSIGN_OR_RETURN(next_, find_place_before(count, t_us, [&](uint64_t i) { return time_at(i); }));
    return source_->seek(header_.data_offset + next_ * item);
  }

 private:
  /// Returns the time of record i; that of the end is later than any.
  Result<int64_t> time_at(uint64_t i) {
    const size_t item = header_.array.item_size;
    E2LF_RETURN_IF_ERROR(source_->seek(header_.data_offset + i * item));
    E2LF_ASSIGN_OR_RETURN(const auto bytes, source_->fetch(kTimesPerProbe * item));
    const size_t count = std::min(bytes.size() / item, kTimesPerProbe);
    if (count == 0) return INT64_MAX;
    EventColumns events;
    convert(bytes.first(count * item), count, events);
    if (events.empty()) return INT64_MAX;
    return median<int64_t>({events.t.begin(), events.t.end()});
  }

  /// Returns how many records are not events.
  size_t convert(std::span<const uint8_t> bytes, size_t count, EventColumns& events) {
    const uint8_t* records = bytes.data();
    if (!header_.big_endian.empty()) {
      reverse_big_endian(bytes, header_, little_);
      records = little_.data();
    }
    return to_events({records, records, records, records}, fields_, count, events);
  }

  SourcePtr source_;
  NpyHeader header_;
  RecordFields fields_;
  size_t next_ = 0;
  bool is_cut_reported_ = false;
  std::vector<uint8_t> little_;
};

Result<NpyHeader> read_header(std::span<const uint8_t> head, const std::string& name) {
  E2LF_ASSIGN_OR_RETURN(NpyHeader header, parse_npy_header(head, name));
  const bool are_records =
      header.array.shape.size() == 1 && !header.array.fields.empty() && header.array.item_size <= kMaxRecordBytes;
  if (are_records || (has_four_columns(header.array) && !header.fortran_order)) return header;
  return Error{
      ErrorCode::kShape,
      "this is neither a one-dimensional array of records with fields x, y, p, t nor an array [events, 4] in C "
      "order; store one of them, e.g. numpy.ascontiguousarray(events)",
      name};
}

/// Returns the columns of records, or of the rows of an array [events, 4], which become records.
std::vector<NpyField> columns_of(NpyHeader& header) {
  if (!has_four_columns(header.array)) return header.array.fields;
  const size_t number_bytes = header.array.item_size;
  const bool is_big_endian = !header.big_endian.empty();
  std::vector<NpyField> columns;
  for (size_t i = 0; i < 4; ++i) {
    columns.push_back({"", header.array.type, i * number_bytes});
    if (i > 0 && is_big_endian) header.big_endian.push_back({i * number_bytes, number_bytes});
  }
  header.array.item_size = 4 * number_bytes;
  return columns;
}

/// Returns the first records, little-endian; the source is positioned at the first.
Result<std::vector<uint8_t>> first_records(ByteSource& source, const NpyHeader& header) {
  const size_t record_bytes = header.array.item_size;
  E2LF_ASSIGN_OR_RETURN(const auto bytes, source.fetch(kSampledRows * record_bytes));
  const size_t count = std::min({bytes.size() / record_bytes, kSampledRows, header.array.shape[0]});
  std::vector<uint8_t> records;
  reverse_big_endian(bytes.first(count * record_bytes), header, records);
  return records;
}

/// Determines the positions of the fields of an event and how to read them; the source is positioned at the first
/// record.
Result<RecordFields> decide_fields(ByteSource& source, const OpenOptions& options, NpyHeader& header,
                                   RecordingInfo& info) {
  const std::string name = source.name();
  table::TableSample sample;
  const std::vector<NpyField> columns = columns_of(header);
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> records, first_records(source, header));
  const size_t item = header.array.item_size;
  std::vector<NumberField> fields;
  for (const NpyField& column : columns) {
    if (!table::is_number_type(column.type)) {
      return Error{ErrorCode::kUnsupported,
                   cat("field \"", column.name, "\" is of type ", column.type, "; store numbers, as u2 and i8"), name};
    }
    fields.push_back({column.type, column.offset, item});
    sample.columns.push_back(table::sample_of(column.name, records.data(), fields.back(), records.size() / item));
  }
  E2LF_ASSIGN_OR_RETURN(const table::TableLayout layout, decide_layout(sample, options, name, info));
  const auto [x, y, p, t] = layout.columns;
  return RecordFields{fields[x], fields[y], fields[p], fields[t], layout.unit, layout.polarity};
}

/// Fails if a file contains more events than its header counts: it was never finished, or its header is wrong.
Result<void> check_count(const NpyHeader& header, const ByteSource& source) {
  const uint64_t bytes = source.size().value_or(0);
  const uint64_t stored = bytes < header.data_offset ? 0 : (bytes - header.data_offset) / header.array.item_size;
  if (stored <= header.array.shape[0]) return {};
  return Error{ErrorCode::kFormat,
               cat("the header states ", header.array.shape[0], " events, but the file contains ", stored,
                   ": writing was not finished; write it again, or correct the shape in its header"),
               source.name()};
}

}  // namespace

bool detect_npy(std::span<const uint8_t> head) {
  const auto header = read_header(head, "");
  return header.ok() && (has_four_columns(header->array) || has_event_fields(header->array));
}

Result<ReaderPtr> open_npy(SourcePtr source, const OpenOptions& options) {
  const std::string name = source->name();
  E2LF_ASSIGN_OR_RETURN(const auto head, source->fetch(kDetectBytes));
  E2LF_ASSIGN_OR_RETURN(NpyHeader header, read_header(head.first(std::min(head.size(), kDetectBytes)), name));
  RecordingInfo info{.format = "npy"};
  E2LF_RETURN_IF_ERROR(apply_size_option(options, info, name));
  source->consume(header.data_offset);
  E2LF_ASSIGN_OR_RETURN(RecordFields fields, decide_fields(*source, options, header, info));
  E2LF_RETURN_IF_ERROR(check_count(header, *source));
  E2LF_ASSIGN_OR_RETURN(TriggersPtr triggers, open_side_triggers(source->logical_path()));
  auto records = std::make_unique<NpyBlocks>(std::move(source), std::move(header), std::move(fields));
  return make_block_reader(std::move(records), std::move(info), name, options, std::move(triggers));
}

namespace {

/// OpenEB's event.
struct Record {
  uint16_t x = 0, y = 0;
  int16_t p = 0;
  uint16_t padding = 0;
  int64_t t = 0;
};
static_assert(sizeof(Record) == 16);

/// Fixed length of the header, before and after the number of events is known.
constexpr size_t kHeaderBytes = 256;
constexpr size_t kPlainHeaderBytes = 10;  // magic, version, length

std::vector<uint8_t> header_bytes(size_t events) {
  NpyArray array;
  array.fields = {{"x", "u2", offsetof(Record, x)},
                  {"y", "u2", offsetof(Record, y)},
                  {"p", "i2", offsetof(Record, p)},
                  {"t", "i8", offsetof(Record, t)}};
  array.item_size = sizeof(Record);
  array.shape = {events};
  std::vector<uint8_t> bytes = npy_header_bytes(array);
  E2LF_REQUIRE(bytes.size() <= kHeaderBytes, "the header is longer than its place");
  bytes.insert(bytes.end() - 1, kHeaderBytes - bytes.size(), ' ');
  bytes[8] = kHeaderBytes - kPlainHeaderBytes;
  bytes[9] = 0;
  return bytes;
}

class NpyWriter final : public RecordingWriter {
 public:
  NpyWriter(AtomicFile file, const RecordingInfo& info)
      : file_(std::move(file)),
        out_(file_.path(), std::ios::binary),
        check_(info.width, info.height, file_.target().string()) {}

  Result<void> begin() { return put_header(); }
  bool holds_triggers() const override { return false; }

  Result<void> write(const EventBatch& batch) override {
    E2LF_RETURN_IF_ERROR(check_(batch));
    const EventColumns& events = batch.events;
    records_.resize(events.size());
    for (size_t i = 0; i < events.size(); ++i) {
      records_[i] = {events.x[i], events.y[i], static_cast<int16_t>(events.p[i]), 0, events.t[i]};
    }
    out_.write(reinterpret_cast<const char*>(records_.data()),
               static_cast<std::streamsize>(records_.size() * sizeof(Record)));
    events_ += events.size();
    out_.flush();  // for recover_npy()
    return check_stream();
  }

  Result<void> finish() override {
    out_.seekp(0);
    E2LF_RETURN_IF_ERROR(put_header());
    out_.close();
    E2LF_RETURN_IF_ERROR(check_stream());
    return file_.commit();
  }

 private:
  Result<void> put_header() {
    const std::vector<uint8_t> bytes = header_bytes(events_);
    out_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return check_stream();
  }

  Result<void> check_stream() const {
    if (out_) return {};
    return Error{ErrorCode::kIo, "cannot write; check the folder's permissions and the disk's free space",
                 file_.target().string()};
  }

  AtomicFile file_;
  std::ofstream out_;
  BatchCheck check_;
  std::vector<Record> records_;
  size_t events_ = 0;
};

}  // namespace

Result<void> recover_npy(const std::filesystem::path& path) {
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  std::vector<uint8_t> head(kHeaderBytes);
  const auto size_of = [](const std::vector<uint8_t>& bytes) { return static_cast<std::streamsize>(bytes.size()); };
  std::error_code error;
  const uintmax_t bytes = std::filesystem::file_size(path, error);
  const uintmax_t events = error || bytes < kHeaderBytes ? 0 : (bytes - kHeaderBytes) / sizeof(Record);
  const bool is_read = static_cast<bool>(file.read(reinterpret_cast<char*>(head.data()), size_of(head)));
  if (is_read && head == header_bytes(events)) return {};
  if (!is_read || head != header_bytes(0)) {
    return Error{ErrorCode::kFormat, "this is not an unfinished array of events; record to .raw", path.string()};
  }
  head = header_bytes(events);
  file.seekp(0);
  file.write(reinterpret_cast<const char*>(head.data()), size_of(head));
  file.close();
  if (file && !error) std::filesystem::resize_file(path, kHeaderBytes + events * sizeof(Record), error);
  if (file && !error) return {};
  return Error{ErrorCode::kIo, "cannot write the number of events; check the disk", path.string()};
}

Result<WriterPtr> create_npy_file(const std::filesystem::path& path, const RecordingInfo& info) {
  E2LF_ASSIGN_OR_RETURN(AtomicFile file, AtomicFile::create(path));
  auto writer = std::make_unique<NpyWriter>(std::move(file), info);
  E2LF_RETURN_IF_ERROR(writer->begin());
  return WriterPtr(std::move(writer));
}

}  // namespace e2lf::formats::numpy
