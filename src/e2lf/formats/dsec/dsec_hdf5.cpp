// SPDX-License-Identifier: MIT
// Reads HDF5 files with columns of events; declared in codecs.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "e2lf/base/median.h"
#include "e2lf/base/text.h"
#include "e2lf/files/npy.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/formats/table/table.h"
#include "e2lf/hdf5/library.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/side_triggers.h"

namespace e2lf::formats::dsec {
using namespace e2lf::hdf5;
using table::Field;

namespace {

/// The location of a table of events in an HDF5 file.
struct EventPlace {
  std::string name;  ///< name of the group or data set, for messages and --stream
  std::array<std::string, table::kNumFields> columns = {};  ///< data sets of x, y, p and t; empty = `name` is a matrix
  [[nodiscard]] bool is_matrix() const { return columns[0].empty(); }
};

constexpr int kDeepest = 8;
constexpr size_t kMostObjects = 10'000;

std::string path_in(const std::string& group, const std::string& name) {
  return group.empty() ? name : cat(group, "/", name);
}

/// Adds the tables of events in a group ("" = the root) and its groups: the data sets x, y, p and t, or a matrix events
/// [events, 4]. Those in the usual places, the root and `events`, come first. Links to other files are not followed.
void add_event_places(hid_t file, const std::string& group, int depth, size_t& num_left,
                      std::vector<EventPlace>& places) {
  const Handle opened(H5Gopen2(file, group.empty() ? "/" : group.c_str(), H5P_DEFAULT), H5Gclose);
  H5G_info_t about{};
  if (!opened.valid() || H5Gget_info(opened.get(), &about) < 0) return;
  std::vector<std::string> datasets, groups;
  for (hsize_t i = 0; i < about.nlinks && num_left > 0; ++i, --num_left) {
    std::array<char, 256> name{};
    H5L_info_t link{};
    H5O_info_t object{};
    if (H5Lget_name_by_idx(opened.get(), ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT) <=
            0 ||
        H5Lget_info(opened.get(), name.data(), &link, H5P_DEFAULT) < 0 || link.type == H5L_TYPE_EXTERNAL ||
        H5Oget_info_by_name2(opened.get(), name.data(), &object, H5O_INFO_BASIC, H5P_DEFAULT) < 0) {
      continue;
    }
    if (object.type == H5O_TYPE_GROUP) groups.emplace_back(name.data());
    if (object.type == H5O_TYPE_DATASET) datasets.emplace_back(name.data());
  }
  const auto add = [&](EventPlace place) {
    const bool is_usual = group.empty() || group == "events";
    places.insert(is_usual ? places.begin() : places.end(), std::move(place));
  };
  if (const table::KnownColumns known = table::find_fields(datasets); table::are_complete(known)) {
    EventPlace place{group.empty() ? "/" : group};
    for (size_t i = 0; i < table::kNumFields; ++i) place.columns[i] = path_in(group, datasets[*known[i]]);
    add(std::move(place));
  } else if (std::find(datasets.begin(), datasets.end(), "events") != datasets.end()) {
    add({path_in(group, "events")});
  }
  for (const std::string& inner : groups) {
    if (depth < kDeepest) add_event_places(file, path_in(group, inner), depth + 1, num_left, places);
  }
}

/// Returns the one or two numbers of an attribute, or none if it does not exist.
std::vector<double> read_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return {};
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Handle space(H5Aget_space(attribute.get()), H5Sclose), type(H5Aget_type(attribute.get()), H5Tclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space.get());
  const H5T_class_t kind = H5Tget_class(type.get());
  if (count < 1 || count > 2 || (kind != H5T_INTEGER && kind != H5T_FLOAT)) return {};
  std::vector<double> numbers(static_cast<size_t>(count));
  if (H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, numbers.data()) < 0) return {};
  return numbers;
}

/// Reads the size of the sensor from attributes of the group of the events or of the root.
void read_size(hid_t file, const std::string& group, RecordingInfo& info) {
  for (const std::string& place : {group, std::string("/")}) {
    const Handle opened(H5Oopen(file, place.c_str(), H5P_DEFAULT), H5Oclose);
    const auto numbers = [&opened](const char* name) { return read_attribute(opened.get(), name); };
    if (opened.valid() && table::read_sensor_size(numbers, info)) return;
  }
}

constexpr uint64_t kBlock = uint64_t{1} << 17;

/// The type of the numbers in a data set, as which they are read into memory.
struct NumberType {
  std::string code;  ///< that of numpy; empty if these are not numbers
  Handle memory;
};

NumberType number_type(hid_t dataset) {
  const Handle stored(H5Dget_type(dataset), H5Tclose);
  if (!stored.valid()) return {};
  const H5T_class_t kind = H5Tget_class(stored.get());
  if (kind != H5T_INTEGER && kind != H5T_FLOAT && kind != H5T_ENUM) return {};
  NumberType type{"", Handle(H5Tget_native_type(stored.get(), H5T_DIR_ASCEND), H5Tclose)};
  if (!type.memory.valid()) return {};
  const char letter = kind == H5T_FLOAT                                                       ? 'f'
                      : kind == H5T_INTEGER && H5Tget_sign(type.memory.get()) == H5T_SGN_NONE ? 'u'
                                                                                              : 'i';  // numpy's bool
  type.code = cat(letter, H5Tget_size(type.memory.get()));
  return table::is_number_type(type.code) ? std::move(type) : NumberType();
}

/// Returns the unit in an attribute unit or units of the times; kAuto if there is none. Fails with kInvalidValue for
/// one in which times are not read.
Result<TimeUnit> unit_of_attributes(hid_t times, const OpenOptions& options, const std::string& location) {
  for (const auto& [name, text] : read_text_attributes(times)) {
    if ((name != "unit" && name != "units") || options.time_unit != TimeUnit::kAuto) continue;
    const TimeUnit unit = table::parse_time_unit(lower_case(text));
    if (unit != TimeUnit::kAuto) return unit;
    return Error{ErrorCode::kInvalidValue,
                 cat("the times are in \"", printable(text), "\"; convert them, or state their unit"), location,
                 "time_unit"};
  }
  return TimeUnit::kAuto;
}

/// Returns the offset of the times of a file in microseconds; 0 if there is no t_offset. Its unit is that of the times
/// if that was named or if both are integers, and seconds if it has a fraction.
Result<int64_t> read_offset(hid_t file, const OpenOptions& options, TimeUnit unit, const std::string& location) {
  const Handle offset(H5Dopen2(file, "t_offset", H5P_DEFAULT), H5Dclose);
  if (!offset.valid()) return 0;
  const std::string place = location + ": t_offset";
  E2LF_ASSIGN_OR_RETURN(const Storage storage, inspect_storage(offset.get(), place));
  const NumberType type = number_type(offset.get());
  std::array<uint8_t, 8> bytes{};
  const Error damaged{ErrorCode::kFormat, "not one time; the file is damaged", place};
  if (type.code.empty() || storage.claimed_elements() != 1 || !chunks_are_whole(offset.get(), storage) ||
      H5Dread(offset.get(), type.memory.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0) {
    return damaged;
  }
  const table::NumberColumn column{bytes.data(), {type.code, 0, element_size(type.code)}};
  const double value = table::to_doubles(column, 1)[0];
  const bool is_whole = value == std::trunc(value);
  if (options.time_unit == TimeUnit::kAuto && unit == TimeUnit::kSeconds && is_whole && value != 0) {
    return Error{
        ErrorCode::kInvalidValue,
        cat("the times are seconds, and the offset ", value, " does not state its unit; give the unit of both"), place,
        "time_unit"};
  }
  if (options.time_unit == TimeUnit::kAuto && !is_whole) unit = TimeUnit::kSeconds;
  int64_t offset_us = 0;
  uint8_t bad = 0;
  table::to_times(column, unit, 1, &offset_us, &bad);
  if (bad != 0 || !is_time(offset_us)) return damaged;
  return offset_us;
}

/// Number of neighbouring times that are inspected for one, so that a single damaged time does not mislead the search.
constexpr size_t kTimesPerProbe = 5;

/// Number of evenly spaced positions that show whether times rise from one to the next.
constexpr uint64_t kRiseProbes = 64;

/// Finds a position in [0, count) after which no event at or after t_us is missed, near the first of them, by bisecting
/// positions with time_at(position), which returns a Result<int64_t>, or INT64_MAX for a position without a time. If
/// the clock starts again between some of kRiseProbes positions, only the first part could be bisected, and the result
/// is 0. Meant for positions that are looked up one by one in a file.
template <typename TimeAt>
Result<uint64_t> find_place_before(uint64_t count, int64_t t_us, const TimeAt& time_at) {
  int64_t last_us = INT64_MIN;
  for (uint64_t i = 0; i < kRiseProbes && count > kRiseProbes; ++i) {
    E2LF_ASSIGN_OR_RETURN(const int64_t probe_us, time_at(i * (count - 1) / (kRiseProbes - 1)));
    if (probe_us < last_us && last_us - probe_us > kDisorderUs) return 0;
    if (probe_us != INT64_MAX) last_us = probe_us;
  }
  uint64_t low = 0, high = count;  // time_at(low) < t_us or low = 0; time_at(high) >= t_us or high = count
  while (high - low > 1) {
    const uint64_t middle = low + (high - low) / 2;
    E2LF_ASSIGN_OR_RETURN(const int64_t middle_us, time_at(middle));
    (middle_us < t_us ? low : high) = middle;
  }
  // A median also inspects positions after its own.
  return low - std::min<uint64_t>(low, kTimesPerProbe);
}

/// Events in data sets x, y, p and t, or in a data set [events, 4]. Numbers are read in their own type.
class ColumnBlocks final : public EventBlocks {
 public:
  Result<void> open(hid_t file, const EventPlace& place, const OpenOptions& options, const std::string& name,
                    RecordingInfo& info) {
    table::TableSample sample;
    sample.is_ordered = place.is_matrix();
    location_ = cat(name, ": ", place.name);
    for (size_t i = 0; columns_.size() < table::kNumFields; ++i) {
      const std::string& dataset = place.is_matrix() ? place.name : place.columns[i];
      E2LF_ASSIGN_OR_RETURN(DatasetShape shape,
                            open_dataset(file, dataset, name, place.is_matrix() ? table::kNumFields : 1));
      E2LF_RETURN_IF_ERROR(add_part(std::move(shape), cat(name, ": ", dataset)));
    }
    length_ = parts_[0].shape.length;
    for (const Part& part : parts_) {
      num_missing_ = std::max(num_missing_, part.shape.claimed_length - part.shape.length);
      if (part.shape.length == length_) continue;
      return fail(ErrorCode::kShape, name, "the columns of events differ in length; the file is damaged");
    }
    const uint64_t count = std::min<uint64_t>(length_, table::kSampledRows);
    E2LF_RETURN_IF_ERROR(read(0, count));
    for (size_t i = 0; i < columns_.size(); ++i) {
      const std::string& dataset = place.columns[i];  // empty for a matrix
      sample.columns.push_back(table::sample_of(dataset.substr(dataset.rfind('/') + 1), columns_[i], count));
    }
    if (!place.is_matrix()) {
      const hid_t times = parts_.back().shape.dataset.get();
      E2LF_ASSIGN_OR_RETURN(sample.columns.back().unit, unit_of_attributes(times, options, name));
    }
    E2LF_ASSIGN_OR_RETURN(layout_, decide_layout(sample, options, name, info));
    E2LF_ASSIGN_OR_RETURN(offset_us_, read_offset(file, options, layout_.unit, name));
    return {};
  }

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    const LibraryLock lock;
    block.clear();
    const uint64_t count = std::min(kBlock, length_ - next_);
    if (count == 0) {
      summary.add_dropped(Violation::kTruncated, 0, std::exchange(num_missing_, 0));
      return false;
    }
    E2LF_RETURN_IF_ERROR(read(next_, count));
    const size_t num_bad = table::to_events(columns_, layout_, count, block.events);
    for (int64_t& t_us : block.events.t) {
      // An invalid time stays invalid, and Timeline drops it.
      t_us = is_time(t_us) ? t_us + offset_us_ : INT64_MAX;
    }
    summary.add_dropped(Violation::kBadRecord, 0, num_bad);
    next_ += count;
    return true;
  }

  Result<void> seek_before(int64_t t_us) override {
    const LibraryLock lock;
    const auto time_at = [&](uint64_t i) -> Result<int64_t> {
      const auto count = std::min<uint64_t>(kTimesPerProbe, length_ - i);
      Column<uint8_t> bad(count);
      std::vector<int64_t> times_us(count);
      const size_t times = layout_.columns[of(Field::kT)];
      E2LF_RETURN_IF_ERROR(read(parts_.size() == 1 ? 0 : times, i, count));
      table::to_times(columns_[times], layout_.unit, count, times_us.data(), bad.data());
      const int64_t since_us = median(std::move(times_us));
      return is_time(since_us) ? since_us + offset_us_ : since_us;
    };
    E2LF_ASSIGN_OR_RETURN(next_, find_place_before(length_, t_us, time_at));
    return {};
  }

 private:
  /// A data set, which is read at once: one column, or all of them.
  struct Part {
    DatasetShape shape;
    NumberType type = {};
    std::vector<uint8_t> numbers = {};  ///< the rows that were read last
  };

  Result<void> add_part(DatasetShape shape, const std::string& place) {
    NumberType type = number_type(shape.dataset.get());
    if (type.code.empty()) {
      return fail(ErrorCode::kUnsupported, place, "these are not numbers; store x, y, p and t as numbers");
    }
    const size_t item = element_size(type.code), columns = shape.columns;
    for (size_t i = 0; i < columns; ++i) columns_.push_back({nullptr, {type.code, i * item, columns * item}});
    parts_.push_back({std::move(shape), std::move(type)});
    return {};
  }

  /// Reads rows of a part, to which its columns then point.
  Result<void> read(size_t number, uint64_t begin, uint64_t count) {
    Part& part = parts_[number];
    part.numbers.resize(count * part.shape.columns * element_size(part.type.code));
    for (size_t i = 0; i < part.shape.columns; ++i) columns_[number + i].records = part.numbers.data();
    return read_elements(part.shape, part.type.memory.get(), begin, count, part.numbers.data(), location_);
  }
  Result<void> read(uint64_t begin, uint64_t count) {
    for (size_t i = 0; i < parts_.size(); ++i) E2LF_RETURN_IF_ERROR(read(i, begin, count));
    return {};
  }

  std::string location_;
  std::vector<Part> parts_;
  std::vector<table::NumberColumn> columns_;
  table::TableLayout layout_;
  int64_t offset_us_ = 0;
  uint64_t length_ = 0, next_ = 0;
  uint64_t num_missing_ = 0;  ///< events that the file states but does not contain
};

}  // namespace

Result<ReaderPtr> open_columns(hid_t file, RecordingInfo info, const ByteSource& source, const OpenOptions& options) {
  const LibraryLock lock;
  const std::string name = source.name();
  info.format = "dsec";
  std::vector<EventPlace> places;
  size_t num_left = kMostObjects;
  add_event_places(file, "", 0, num_left, places);
  if (places.empty()) {
    return fail(
        ErrorCode::kNotFound, name,
        "the file has no events: neither CD/events (Metavision), nor a group with the columns x, y, p, t or xs, ys, "
        "ps, ts, nor a data set events [events, 4]; if it is a recording, write it as one of them");
  }
  std::vector<NamedStream> streams;
  for (const EventPlace& place : places) streams.push_back({cat(streams.size()), place.name, ""});
  size_t chosen = 0;
  if (places.size() > 1) {
    E2LF_ASSIGN_OR_RETURN(chosen, choose_stream(streams, options, name, info));
  }
  if (info.width == 0) read_size(file, places[chosen].name, info);
  auto columns = std::make_unique<ColumnBlocks>();
  E2LF_RETURN_IF_ERROR(columns->open(file, places[chosen], options, name, info));
  E2LF_ASSIGN_OR_RETURN(BlocksPtr triggers, open_side_triggers(source.path()));
  return std::make_unique<RecordingReader>(std::move(columns), std::move(info), name, options, std::move(triggers));
}

}  // namespace e2lf::formats::dsec
