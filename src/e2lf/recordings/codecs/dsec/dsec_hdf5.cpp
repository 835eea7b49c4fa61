// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/dsec/dsec_hdf5.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "e2lf/base/text.h"
#include "e2lf/files/elements.h"
#include "e2lf/files/file.h"
#include "e2lf/hdf5/checked_file.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/codecs/dsec/event_places.h"
#include "e2lf/recordings/codecs/dsec/sensor_size.h"
#include "e2lf/recordings/stream_choice.h"
#include "e2lf/recordings/table/column_names.h"
#include "e2lf/recordings/table/number_columns.h"
#include "e2lf/recordings/table/wrapped_times.h"
#include "e2lf/recordings/time_search.h"

namespace e2lf::recordings::hdf5_events {
using e2lf::hdf5::CheckedFile;

namespace {

constexpr uint64_t kBlock = uint64_t{1} << 17;
constexpr uint64_t kColumnChunk = uint64_t{1} << 15;

/// One column of events: a data set that is read in its own numeric type.
struct NumberColumn {
  DatasetShape shape;
  std::string member = {};        ///< field of the records; empty = not records
  table::NumberField field = {};  ///< layout of the numbers in memory
};

struct KnownNumber {
  const char* type;  ///< numpy code
  H5T_class_t kind;
  H5T_sign_t sign;
  size_t bytes;
};
constexpr KnownNumber kNumbers[] = {{"u1", H5T_INTEGER, H5T_SGN_NONE, 1}, {"u2", H5T_INTEGER, H5T_SGN_NONE, 2},
                                    {"u4", H5T_INTEGER, H5T_SGN_NONE, 4}, {"u8", H5T_INTEGER, H5T_SGN_NONE, 8},
                                    {"i1", H5T_INTEGER, H5T_SGN_2, 1},    {"i2", H5T_INTEGER, H5T_SGN_2, 2},
                                    {"i4", H5T_INTEGER, H5T_SGN_2, 4},    {"i8", H5T_INTEGER, H5T_SGN_2, 8},
                                    {"f4", H5T_FLOAT, H5T_SGN_ERROR, 4},  {"f8", H5T_FLOAT, H5T_SGN_ERROR, 8}};

/// Returns the numpy code of a type that represents all values of an HDF5 type; empty if that is not numeric.
std::string number_code(hid_t type) {
  for (const KnownNumber& known : kNumbers) {
    const bool has_sign = known.kind != H5T_INTEGER || H5Tget_sign(type) == known.sign;
    if (H5Tget_class(type) == known.kind && H5Tget_size(type) == known.bytes && has_sign) return known.type;
  }
  if (H5Tget_class(type) == H5T_FLOAT && H5Tget_size(type) == 2) return "f4";
  return H5Tget_class(type) == H5T_ENUM ? "i1" : "";  // numpy's bool
}

/// Returns the same for the elements of a data set, or for a field of its records.
std::string number_type(hid_t dataset, const std::string& field = "") {
  const Handle type(H5Dget_type(dataset), H5Tclose);
  if (!type.valid()) return "";
  if (field.empty()) return number_code(type.get());
  const int member = H5Tget_member_index(type.get(), field.c_str());
  if (member < 0) return "";
  const Handle member_type(H5Tget_member_type(type.get(), static_cast<unsigned>(member)), H5Tclose);
  return number_code(member_type.get());
}

hid_t memory_type(const std::string& type) {
  if (type == "u1") return H5T_NATIVE_UINT8;
  if (type == "u2") return H5T_NATIVE_UINT16;
  if (type == "u4") return H5T_NATIVE_UINT32;
  if (type == "u8") return H5T_NATIVE_UINT64;
  if (type == "i1") return H5T_NATIVE_INT8;
  if (type == "i2") return H5T_NATIVE_INT16;
  if (type == "i4") return H5T_NATIVE_INT32;
  if (type == "i8") return H5T_NATIVE_INT64;
  return type == "f4" ? H5T_NATIVE_FLOAT : H5T_NATIVE_DOUBLE;
}

Error no_numbers(const std::string& name, const std::string& location) {
  return {ErrorCode::kUnsupported, cat("data set ", name, " does not hold numbers; store x, y, p and t as numbers"),
          location};
}

/// Returns the unit that an attribute of the times states.
TimeUnit unit_of_attribute(hid_t dataset) {
  for (const char* name : {"unit", "units"}) {
    const TimeUnit unit = table::parse_time_unit(read_text_attribute(dataset, name));
    if (unit != TimeUnit::kAuto) return unit;
  }
  return TimeUnit::kAuto;
}

/// Returns the offset of the times of a file in microseconds; 0 if there is no t_offset. Its unit is that of the times
/// if that was named or if both are integers, and seconds if it has a fraction.
Result<int64_t> read_offset(hid_t file, const OpenOptions& options, TimeUnit unit, const std::string& location) {
  const Handle offset(H5Dopen2(file, "t_offset", H5P_DEFAULT), H5Dclose);
  if (!offset.valid()) return 0;
  const std::string place = location + ": t_offset";
  E2LF_ASSIGN_OR_RETURN(const Storage storage, e2lf::hdf5::inspect_storage(offset.get(), place));
  const std::string type = number_type(offset.get());
  std::array<uint8_t, 8> bytes{};
  const Error damaged{ErrorCode::kFormat, "not one time; the file is damaged", place};
  if (type.empty() || storage.claimed_elements() != 1 || !e2lf::hdf5::chunks_are_whole(offset.get(), storage) ||
      H5Dread(offset.get(), memory_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0) {
    return damaged;
  }
  const table::NumberField field{type, 0, element_size(type)};
  const double value = table::to_doubles(bytes.data(), field, 1)[0];
  const bool is_whole = value == std::trunc(value);
  if (options.time_unit == TimeUnit::kAuto && unit == TimeUnit::kSeconds && is_whole && value != 0) {
    return Error{
        ErrorCode::kInvalidValue,
        cat("the times are seconds, and the offset ", value, " does not state its unit; give the unit of both"), place,
        Setting::kTimeUnit};
  }
  if (options.time_unit == TimeUnit::kAuto && !is_whole) unit = TimeUnit::kSeconds;
  int64_t offset_us = 0;
  uint8_t bad = 0;
  table::to_times(bytes.data(), field, unit, 1, &offset_us, &bad);
  if (bad != 0 || !is_time(offset_us)) return damaged;
  return offset_us;
}

/// Reads events by rows, from columns or from the rows of one data set.
class RowBlocks : public EventBlocks {
 public:
  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    const LibraryLock lock;
    block.clear();
    const uint64_t count = std::min(kBlock, length_ - next_);
    if (count == 0) {
      if (is_cut_) summary.add(Violation::kTruncated, 0);
      is_cut_ = false;
      return false;
    }
    Column<uint8_t> bad(count);
    std::fill(bad.begin(), bad.end(), uint8_t{0});
    block.events.resize(count);
    E2LF_RETURN_IF_ERROR(read_rows(next_, count, block.events, bad));
    for (size_t i = 0; i < count; ++i) {
      // An invalid time stays invalid, and EventGate drops it.
      int64_t& t_us = block.events.t[i];
      t_us = is_time(t_us) ? t_us + offset_us_ : INT64_MAX;
    }
    const size_t num_bad = table::remove_bad(block.events, 0, bad);
    summary.add(Violation::kBadRecord, 0, num_bad);
    summary.dropped_words += num_bad;
    next_ += count;
    return true;
  }

  Result<void> seek_before(int64_t t_us) override {
    const LibraryLock lock;
    const auto time_at = [&](uint64_t i) -> Result<int64_t> {
      const auto count = std::min<uint64_t>(kTimesPerProbe, length_ - i);
      Column<uint8_t> bad(count);
      std::vector<int64_t> times_us(count);
      E2LF_RETURN_IF_ERROR(read_times(i, count, times_us.data(), bad.data()));
      const int64_t since_us = median_time(std::move(times_us));
      return is_time(since_us) ? since_us + offset_us_ : since_us;
    };
    E2LF_ASSIGN_OR_RETURN(next_, find_place_before(length_, t_us, time_at));
    return {};
  }

 protected:
  /// Reads rows; sets `bad` for those that are not events.
  virtual Result<void> read_rows(uint64_t begin, uint64_t count, EventColumns& events, Column<uint8_t>& bad) = 0;
  virtual Result<void> read_times(uint64_t begin, uint64_t count, int64_t* times_us, uint8_t* bad) = 0;

  /// Reads rows, or only the field `member` of records, to numbers_.
  Result<const uint8_t*> read_numbers(const DatasetShape& shape, const std::string& type, uint64_t begin,
                                      uint64_t count, const std::string& member = "") {
    numbers_.resize(count * shape.columns * element_size(type));
    Handle record;
    if (!member.empty()) {
      record = Handle(H5Tcreate(H5T_COMPOUND, element_size(type)), H5Tclose);
      H5Tinsert(record.get(), member.c_str(), 0, memory_type(type));
    }
    const hid_t memory = member.empty() ? memory_type(type) : record.get();
    E2LF_RETURN_IF_ERROR(read_elements(shape, memory, begin, count, numbers_.data(), location_));
    return static_cast<const uint8_t*>(numbers_.data());
  }
  Result<const uint8_t*> read_numbers(const NumberColumn& column, uint64_t begin, uint64_t count) {
    return read_numbers(column.shape, column.field.type, begin, count, column.member);
  }

  /// Returns the first number after the sample for which is_wanted() is true.
  Result<std::optional<double>> find_further(const DatasetShape& shape, const table::NumberField& field,
                                             const table::TableSample::IsWanted& is_wanted,
                                             const std::string& member = "") {
    for (uint64_t begin = table::kSampledRows; begin < length_; begin += kBlock) {
      const uint64_t count = std::min(kBlock, length_ - begin);
      E2LF_ASSIGN_OR_RETURN(const uint8_t* numbers, read_numbers(shape, field.type, begin, count, member));
      const auto values = table::to_doubles(numbers, field, count);
      const auto wanted = std::find_if(values.begin(), values.end(), is_wanted);
      if (wanted != values.end()) return std::optional<double>(*wanted);
    }
    return std::optional<double>();
  }

 public:
  [[nodiscard]] TimeUnit unit() const { return unit_; }

 protected:
  std::string location_;
  TimeUnit unit_ = TimeUnit::kAuto;
  table::PolarityCode polarity_;
  int64_t offset_us_ = 0;
  uint64_t length_ = 0;
  bool is_cut_ = false;

 private:
  std::vector<uint8_t> numbers_;
  uint64_t next_ = 0;
};

class ColumnBlocks final : public RowBlocks {
 public:
  /// Opens the columns x, y, p and t: data sets, fields of a data set of records, or the rows of a data set [4,
  /// events].
  static Result<std::unique_ptr<ColumnBlocks>> open(hid_t file, const EventPlace& place, const OpenOptions& options,
                                                    const std::string& location, RecordingInfo& info) {
    auto blocks = std::make_unique<ColumnBlocks>();
    const bool are_records = !place.fields[0].empty(), are_rows = !place.rows.empty() && !are_records;
    blocks->location_ = cat(location, ": ", place.rows.empty() ? place.name : place.rows);
    std::array<std::string, 4> names;
    for (size_t i = 0; i < 4; ++i) {
      NumberColumn& column = blocks->columns_[i];
      const std::string& dataset = place.rows.empty() ? place.columns[i] : place.rows;
      if (are_rows) {
        E2LF_ASSIGN_OR_RETURN(column.shape, open_row(file, dataset, i, location));
      } else {
        E2LF_ASSIGN_OR_RETURN(column.shape, open_dataset(file, dataset, location));
      }
      if (are_records) column.member = place.fields[i];
      if (!are_rows) names[i] = are_records ? place.fields[i] : dataset.substr(dataset.rfind('/') + 1);
      const std::string type = number_type(column.shape.dataset.get(), column.member);
      column.field = {type, 0, element_size(type)};
      if (type.empty()) return no_numbers(are_records ? cat(dataset, ": ", names[i]) : dataset, location);
      blocks->is_cut_ |= column.shape.is_cut;
    }
    blocks->length_ = blocks->columns_[3].shape.length;
    for (const NumberColumn& column : blocks->columns_) {
      if (column.shape.length != blocks->length_) {
        return Error{ErrorCode::kShape, "the columns of events differ in length; the file is damaged", location};
      }
    }
    E2LF_RETURN_IF_ERROR(blocks->decide(names, are_rows, options, location, info));
    E2LF_ASSIGN_OR_RETURN(blocks->offset_us_, read_offset(file, options, blocks->unit_, location));
    return blocks;
  }

 private:
  Result<void> decide(const std::array<std::string, 4>& names, bool is_ordered, const OpenOptions& options,
                      const std::string& location, RecordingInfo& info) {
    table::TableSample sample;
    sample.is_ordered = is_ordered;
    const uint64_t count = std::min<uint64_t>(length_, table::kSampledRows);
    for (size_t i = 0; i < 4; ++i) {
      const NumberColumn& column = columns_[i];
      E2LF_ASSIGN_OR_RETURN(const uint8_t* numbers, read_numbers(column, 0, count));
      const bool has_own = column.member.empty() && !is_ordered;
      sample.columns.push_back({names[i], has_own ? unit_of_attribute(column.shape.dataset.get()) : TimeUnit::kAuto,
                                table::to_doubles(numbers, column.field, count),
                                table::is_integer_type(column.field.type), column.field.type == "f4"});
    }
    sample.find_further = [&](size_t i, const auto& is_wanted) {
      return find_further(columns_[i].shape, columns_[i].field, is_wanted, columns_[i].member);
    };
    E2LF_ASSIGN_OR_RETURN(const table::TableLayout layout, decide_layout(std::move(sample), options, location, info));
    unit_ = layout.unit;
    polarity_ = layout.polarity;
    if (!is_ordered) return {};
    const auto [x, y, p, t] = layout.columns;
    std::array<NumberColumn, 4> in_order;
    for (size_t i = 0; const size_t from : {x, y, p, t}) in_order[i++] = std::move(columns_[from]);
    columns_ = std::move(in_order);
    return {};
  }

  template <typename T>
  Result<void> read(const NumberColumn& column, uint64_t begin, uint64_t count, T* out, uint8_t* bad) {
    E2LF_ASSIGN_OR_RETURN(const uint8_t* numbers, read_numbers(column, begin, count));
    table::to_column(numbers, column.field, count, out, bad);
    return {};
  }

  Result<void> read_rows(uint64_t begin, uint64_t count, EventColumns& events, Column<uint8_t>& bad) override {
    E2LF_RETURN_IF_ERROR(read(columns_[0], begin, count, events.x.data(), bad.data()));
    E2LF_RETURN_IF_ERROR(read(columns_[1], begin, count, events.y.data(), bad.data()));
    const NumberColumn& polarities = columns_[2];
    E2LF_ASSIGN_OR_RETURN(const uint8_t* numbers, read_numbers(polarities, begin, count));
    table::to_polarities(numbers, polarities.field, polarity_, count, events.p.data(), bad.data());
    return read_times(begin, count, events.t.data(), bad.data());
  }

  Result<void> read_times(uint64_t begin, uint64_t count, int64_t* times_us, uint8_t* bad) override {
    const NumberColumn& column = columns_[3];
    E2LF_ASSIGN_OR_RETURN(const uint8_t* numbers, read_numbers(column, begin, count));
    table::to_times(numbers, column.field, unit_, count, times_us, bad);
    return {};
  }

  std::array<NumberColumn, 4> columns_;  ///< x, y, p, t
};

class MatrixBlocks final : public RowBlocks {
 public:
  static Result<std::unique_ptr<MatrixBlocks>> open(hid_t file, const std::string& rows, const OpenOptions& options,
                                                    const std::string& location, RecordingInfo& info) {
    auto blocks = std::make_unique<MatrixBlocks>();
    blocks->location_ = cat(location, ": ", rows);
    E2LF_ASSIGN_OR_RETURN(blocks->shape_, open_matrix(file, rows, location));
    blocks->type_ = number_type(blocks->shape_.dataset.get());
    if (blocks->type_.empty()) return no_numbers(rows, location);
    if (blocks->shape_.columns != 4) {
      return Error{ErrorCode::kShape, cat("the data set has ", blocks->shape_.columns, " columns; store t, x, y, p"),
                   blocks->location_};
    }
    blocks->length_ = blocks->shape_.length;
    blocks->is_cut_ = blocks->shape_.is_cut;
    const uint64_t count = std::min<uint64_t>(blocks->length_, table::kSampledRows);
    E2LF_ASSIGN_OR_RETURN(const uint8_t* numbers, blocks->read_numbers(blocks->shape_, blocks->type_, 0, count));
    const size_t item = element_size(blocks->type_);
    const auto field_of = [&](size_t i) { return table::NumberField{blocks->type_, i * item, 4 * item}; };
    table::TableSample sample;
    for (size_t i = 0; i < 4; ++i) {
      sample.columns.push_back({"", TimeUnit::kAuto, table::to_doubles(numbers, field_of(i), count),
                                table::is_integer_type(blocks->type_), blocks->type_ == "f4"});
    }
    sample.find_further = [&](size_t i, const auto& is_wanted) {
      return blocks->find_further(blocks->shape_, field_of(i), is_wanted);
    };
    E2LF_ASSIGN_OR_RETURN(const table::TableLayout layout, decide_layout(std::move(sample), options, location, info));
    const auto [x, y, p, t] = layout.columns;
    blocks->fields_ = {field_of(x), field_of(y), field_of(p), field_of(t), layout.unit, layout.polarity};
    blocks->unit_ = layout.unit;
    return blocks;
  }

 private:
  Result<void> read_rows(uint64_t begin, uint64_t count, EventColumns& events, Column<uint8_t>& bad) override {
    E2LF_ASSIGN_OR_RETURN(const uint8_t* numbers, read_numbers(shape_, type_, begin, count));
    table::to_column(numbers, fields_.x, count, events.x.data(), bad.data());
    table::to_column(numbers, fields_.y, count, events.y.data(), bad.data());
    table::to_polarities(numbers, fields_.p, fields_.polarity, count, events.p.data(), bad.data());
    table::to_times(numbers, fields_.t, unit_, count, events.t.data(), bad.data());
    return {};
  }

  Result<void> read_times(uint64_t begin, uint64_t count, int64_t* times_us, uint8_t* bad) override {
    E2LF_ASSIGN_OR_RETURN(const uint8_t* numbers, read_numbers(shape_, type_, begin, count));
    table::to_times(numbers, fields_.t, unit_, count, times_us, bad);
    return {};
  }

  DatasetShape shape_;
  std::string type_;
  table::RecordFields fields_;
};

template <typename Blocks>
Result<std::unique_ptr<EventBlocks>> unwrapped(Result<std::unique_ptr<Blocks>> opened) {
  E2LF_ASSIGN_OR_RETURN(std::unique_ptr<Blocks> blocks, std::move(opened));
  const TimeUnit unit = blocks->unit();
  return table::make_unwrapped(std::move(blocks), unit);
}

Result<std::unique_ptr<EventBlocks>> open_place(hid_t file, const EventPlace& place, const OpenOptions& options,
                                                const std::string& location, RecordingInfo& info) {
  const bool is_matrix = !place.rows.empty() && place.fields[0].empty();
  if (!is_matrix) return unwrapped(ColumnBlocks::open(file, place, options, location, info));
  E2LF_ASSIGN_OR_RETURN(const DatasetShape shape, open_matrix(file, place.rows, location));
  const bool is_flat = shape.storage.extents[0] == 4 && shape.columns != 4;
  return is_flat ? unwrapped(ColumnBlocks::open(file, place, options, location, info))
                 : unwrapped(MatrixBlocks::open(file, place.rows, options, location, info));
}

class DsecWriter final : public RecordingWriter {
 public:
  DsecWriter(AtomicFile file, const RecordingInfo& info)
      : file_(std::move(file)), name_(file_.target().string()), check_(info.width, info.height, name_) {}

  Result<void> begin(const RecordingInfo& info) {
    const LibraryLock lock;
    E2LF_ASSIGN_OR_RETURN(hdf5_file_, CheckedFile::create(file_.path(), name_));
    const hid_t file = hdf5_file_.get();
    if (info.width != 0 && info.height != 0) {
      E2LF_RETURN_IF_ERROR(write_text_attribute(file, "geometry", cat(info.width, "x", info.height)));
    }
    const Handle group(H5Gcreate2(file, "events", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    E2LF_ASSIGN_OR_RETURN(x_, GrowingDataset::create(group.get(), "x", H5T_STD_U16LE, kColumnChunk));
    E2LF_ASSIGN_OR_RETURN(y_, GrowingDataset::create(group.get(), "y", H5T_STD_U16LE, kColumnChunk));
    E2LF_ASSIGN_OR_RETURN(p_, GrowingDataset::create(group.get(), "p", H5T_STD_U8LE, kColumnChunk));
    E2LF_ASSIGN_OR_RETURN(t_, GrowingDataset::create(group.get(), "t", H5T_STD_U32LE, kColumnChunk));
    E2LF_ASSIGN_OR_RETURN(ms_to_idx_, GrowingDataset::create(file, "ms_to_idx", H5T_STD_U64LE, kColumnChunk));
    return {};
  }

  bool holds_triggers() const override { return false; }

  Result<void> write(const EventBatch& batch) override {
    E2LF_RETURN_IF_ERROR(check_(batch));
    const EventColumns& events = batch.events;
    const size_t count = events.size();
    if (count == 0) return {};
    if (t_.length() == 0) {
      offset_us_ = events.t.front();
      E2LF_RETURN_IF_ERROR(write_offset());
    }
    if (events.t.back() - offset_us_ > UINT32_MAX) {
      return Error{ErrorCode::kInvalidValue,
                   "the recording is longer than the 71 minutes that this layout holds; write HDF5 with ECF", name_};
    }
    std::vector<uint32_t> times(count);
    std::vector<uint64_t> milliseconds;
    for (size_t i = 0; i < count; ++i) {
      times[i] = static_cast<uint32_t>(events.t[i] - offset_us_);
      while (next_ms_ * 1000 <= times[i]) {
        milliseconds.push_back(t_.length() + i);
        ++next_ms_;
      }
    }
    const LibraryLock lock;
    E2LF_RETURN_IF_ERROR(ms_to_idx_.append(H5T_NATIVE_UINT64, milliseconds.data(), milliseconds.size()));
    E2LF_RETURN_IF_ERROR(x_.append(H5T_NATIVE_UINT16, events.x.data(), count));
    E2LF_RETURN_IF_ERROR(y_.append(H5T_NATIVE_UINT16, events.y.data(), count));
    E2LF_RETURN_IF_ERROR(p_.append(H5T_NATIVE_UINT8, events.p.data(), count));
    E2LF_RETURN_IF_ERROR(t_.append(H5T_NATIVE_UINT32, times.data(), count));
    if (hdf5_file_.is_behind()) hdf5_file_.keep_up();
    return hdf5_file_.check();
  }

  Result<void> finish() override {
    const LibraryLock lock;
    // One more entry after the last event, so that every event has a following millisecond.
    const uint64_t end = t_.length();
    E2LF_RETURN_IF_ERROR(ms_to_idx_.append(H5T_NATIVE_UINT64, &end, 1));
    if (end == 0) E2LF_RETURN_IF_ERROR(write_offset());
    for (GrowingDataset* column : {&x_, &y_, &p_, &t_, &ms_to_idx_}) *column = {};
    E2LF_RETURN_IF_ERROR(hdf5_file_.close());
    return file_.commit();
  }

 private:
  Result<void> write_offset() {
    const LibraryLock lock;
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle offset(
        H5Dcreate2(hdf5_file_.get(), "t_offset", H5T_STD_I64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose);
    if (!offset.valid() || H5Dwrite(offset.get(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &offset_us_) < 0) {
      return Error{ErrorCode::kIo, "the HDF5 library could not write t_offset; check the disk's free space", name_};
    }
    return {};
  }

  AtomicFile file_;
  std::string name_;
  BatchCheck check_;
  CheckedFile hdf5_file_;
  GrowingDataset x_, y_, p_, t_, ms_to_idx_;
  int64_t offset_us_ = 0;
  uint64_t next_ms_ = 0;
};

}  // namespace

Result<std::unique_ptr<EventBlocks>> open_columns(hid_t file, const OpenOptions& options, const std::string& location,
                                                  RecordingInfo& info) {
  const LibraryLock lock;
  const std::vector<EventPlace> places = find_event_places(file);
  if (!places.empty()) {
    std::vector<NamedStream> streams;
    for (const EventPlace& place : places) streams.push_back({cat(streams.size()), place.name, ""});
    size_t chosen = 0;
    if (places.size() > 1) {
      E2LF_ASSIGN_OR_RETURN(chosen, choose_stream(streams, options, location, info));
    }
    if (info.width == 0) read_sensor_size(file, places[chosen].name, info);
    return open_place(file, places[chosen], options, location, info);
  }
  return Error{
      ErrorCode::kNotFound,
      "the file has no events: neither CD/events (Metavision), nor a group with the columns x, y, p, t or xs, ys, ps, "
      "ts, nor records with such fields, nor a data set events [events, 4]; if it is a recording, write it as one of "
      "them",
      location};
}

Result<std::unique_ptr<RecordingWriter>> create_dsec_file(const std::filesystem::path& path,
                                                          const RecordingInfo& info) {
  E2LF_ASSIGN_OR_RETURN(AtomicFile file, AtomicFile::create(path));
  auto writer = std::make_unique<DsecWriter>(std::move(file), info);
  E2LF_RETURN_IF_ERROR(writer->begin(info));
  std::unique_ptr<RecordingWriter> result = std::move(writer);
  return result;
}

}  // namespace e2lf::recordings::hdf5_events
