// SPDX-License-Identifier: MIT
// Reads events in .npy and .npz files and writes .npz; declared in codecs.h.
#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <string_view>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/memory.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/formats/table/table.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/side_triggers.h"

namespace e2lf::formats::numpy {
using table::Field;
using table::kSampledRows;
using table::NumberColumn;

namespace {

constexpr size_t kBlockEvents = size_t{1} << 17;
constexpr uint64_t kEventBytes = 13;  // of its columns x, y, p, t
constexpr const char* kReadRemedy =
    "arrays of numpy are read as a whole: store the events as .raw, .csv or .hdf5, or in parts";

/// Returns a column of the archive, after checking that it is one-dimensional and numeric.
Result<const NpyArray*> find_column(const NpzArrays& arrays, const std::string& key, const std::string& name) {
  const auto found = arrays.find(key);
  if (found == arrays.end()) {
    return fail(ErrorCode::kNotFound, name, "the archive has no array \"", key, "\"; store all columns");
  }
  const NpyArray& array = found->second;
  if (array.shape.size() == 1 && table::is_number_type(array.type)) return &array;
  return fail(ErrorCode::kShape, name, "array \"", key, "\" is not a column of numbers; store x, y, p, t");
}

/// Returns a one-dimensional array as a column.
NumberColumn column_of(const NpyArray& array) {
  return {array.bytes.data(), {array.type, 0, array.item_size}};
}

/// Returns the triggers, sorted. Their times are in `unit` if they are floating-point numbers. Adds the number of
/// unreadable ones to `num_bad`.
Result<std::vector<Trigger>> read_triggers(const NpzArrays& arrays, const std::string& name, TimeUnit unit,
                                           size_t& num_bad) {
  std::vector<Trigger> triggers;
  if (!arrays.contains("trigger_t")) return triggers;
  std::array<const NpyArray*, 3> columns{};
  for (size_t i = 0; i < columns.size(); ++i) {
    constexpr const char* kKeys[] = {"trigger_t", "trigger_p", "trigger_id"};
    E2LF_ASSIGN_OR_RETURN(columns[i], find_column(arrays, kKeys[i], name));
    if (columns[i]->shape == columns[0]->shape) continue;
    return fail(ErrorCode::kShape, name, "array \"", kKeys[i], "\" has a different length; store all of it");
  }
  const auto [t, p, id] = columns;
  const size_t count = t->shape[0];
  Column<uint8_t> bad(count, 0), polarities(count);
  Column<int64_t> times_us(count);
  Column<uint16_t> ids(count);
  if (t->type[0] != 'f' && unit == TimeUnit::kSeconds) unit = TimeUnit::kMicroseconds;
  table::to_times(column_of(*t), unit, count, times_us.data(), bad.data());
  table::to_column(column_of(*p), count, polarities.data(), bad.data());
  table::to_column(column_of(*id), count, ids.data(), bad.data());
  for (size_t i = 0; i < count; ++i) {
    if (bad[i] == 0 && is_time(times_us[i])) {
      triggers.push_back({times_us[i], ids[i], static_cast<uint8_t>(polarities[i] != 0)});
    } else {
      ++num_bad;
    }
  }
  std::ranges::stable_sort(triggers, {}, &Trigger::t);
  return triggers;
}

/// Fails if there is not enough memory for the events of an archive: its arrays, their columns, and these again if they
/// are sorted.
Result<void> check_memory(std::span<const uint8_t> archive, const std::string& name) {
  E2LF_ASSIGN_OR_RETURN(const NpzArrays arrays, peek_npz(archive, name));
  uint64_t bytes = 0, most_rows = 0;
  for (const auto& [key, array] : arrays) {
    bytes += static_cast<uint64_t>(array.num_elements()) * array.item_size;
    if (!array.shape.empty()) most_rows = std::max<uint64_t>(most_rows, array.shape[0]);
  }
  return require_memory(bytes + 2 * kEventBytes * most_rows, kReadRemedy, name);
}

/// A complete recording in memory, which is returned in blocks.
class MemoryBlocks final : public EventBlocks {
 public:
  MemoryBlocks(EventBatch all, size_t bad) : all_(std::move(all)), bad_(bad) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    block.clear();
    if (!std::exchange(has_begun_, true)) {
      block.triggers = all_.triggers;
      summary.add_dropped(Violation::kBadRecord, 0, bad_);
    }
    const size_t end = std::min(all_.events.size(), next_ + kBlockEvents);
    block.events.append(all_.events, next_, end);
    const bool more = next_ < end;
    next_ = end;
    return more;
  }

  Result<void> seek_before(int64_t) override {
    has_begun_ = false;
    next_ = 0;
    return {};
  }

 private:
  EventBatch all_;
  size_t bad_;
  bool has_begun_ = false;  ///< whether triggers and damage were returned
  size_t next_ = 0;
};

class NpzWriter final : public RecordingWriter {
 public:
  NpzWriter(SinkPtr sink, const RecordingInfo& info)
      : sink_(std::move(sink)), info_(info), check_(info.width, info.height, sink_->name()) {}

  bool holds_triggers() const override { return true; }

  Result<void> write(const EventBatch& batch) override {
    E2LF_RETURN_IF_ERROR(check_(batch));
    E2LF_RETURN_IF_ERROR(check_room(batch.events.size()));
    all_.append(batch);
    return {};
  }

  Result<void> finish() override {
    NpzArrays arrays;
    const auto put = [&arrays](const char* key, const auto& column) {
      arrays.emplace(key, make_npy({column.size()}, std::span(std::as_const(column))));
    };
    put("x", all_.events.x);
    put("y", all_.events.y);
    put("p", all_.events.p);
    put("t", all_.events.t);
    std::vector<int64_t> t;
    std::vector<uint8_t> p;
    std::vector<uint16_t> id;
    for (const Trigger& trigger : all_.triggers) {
      t.push_back(trigger.t);
      p.push_back(trigger.p);
      id.push_back(trigger.id);
    }
    put("trigger_t", t);
    put("trigger_p", p);
    put("trigger_id", id);
    put("size", std::vector<int64_t>{static_cast<int64_t>(info_.width), static_cast<int64_t>(info_.height)});
    // Uncompressed, because deflate takes longer than everything else together and saves little on such columns.
    E2LF_RETURN_IF_ERROR(sink_->write(encode_npz(arrays, /*compress=*/false)));
    return sink_->commit();
  }

 private:
  /// Checks before the columns double in size that there is memory for them beside the old ones, or for the archive at
  /// the end.
  Result<void> check_room(size_t more) {
    const size_t count = all_.events.size() + more;
    if (count <= room_) return {};
    room_ = std::max(2 * count, kBlockEvents);
    return require_memory(2 * kEventBytes * room_, "an .npz file is written as a whole: write .raw or .hdf5 instead",
                          sink_->name());
  }

  SinkPtr sink_;
  RecordingInfo info_;
  BatchCheck check_;
  EventBatch all_;
  size_t room_ = 0;  ///< number of events for which there is memory
};

/// The columns of the events of an archive, as separate arrays or as parts of rows.
struct NpzColumns {
  std::vector<std::string> names;
  std::vector<NumberColumn> columns;
  std::vector<size_t> lengths;

  void add(std::string name, const NpyArray& array, table::NumberField field) {
    names.push_back(std::move(name));
    columns.push_back({array.bytes.data(), std::move(field)});
    lengths.push_back(array.shape[0]);
  }
};

/// Returns the columns of the rows of an array: its fields, or four without names.
NpzColumns columns_of_rows(const NpyArray& array) {
  NpzColumns columns;
  for (const NpyField& field : array.fields) {
    if (table::is_number_type(field.type)) columns.add(field.name, array, {field.type, field.offset, array.item_size});
  }
  for (size_t i = 0; array.fields.empty() && i < 4; ++i) {
    columns.add("", array, {array.type, i * array.item_size, 4 * array.item_size});
  }
  return columns;
}

/// Returns the arrays whose names denote the fields of an event. An array "xy" contains both coordinates.
Result<NpzColumns> named_columns(const NpzArrays& arrays, const std::string& name) {
  std::vector<std::string> keys;
  NpzColumns columns;
  for (const auto& [key, array] : arrays) {
    keys.push_back(key);
    if (table::parse_column_name(key).is_xy && columns.names.empty() && array.shape.size() == 2 &&
        array.shape[1] == 2 && table::is_number_type(array.type)) {
      columns.add("x", array, {array.type, 0, 2 * array.item_size});
      columns.add("y", array, {array.type, array.item_size, 2 * array.item_size});
    }
  }
  const table::KnownColumns known = table::find_fields(keys);
  for (size_t field = columns.names.size(); field < table::kNumFields; ++field) {
    if (!known[field]) {
      return fail(ErrorCode::kNotFound, name, "the names of the arrays (", join(keys),
                  ") do not state once each which are x, y, p and t; ",
                  "store the columns x, y, p, t, or events as [events, 4]");
    }
    const std::string& key = keys[*known[field]];
    E2LF_ASSIGN_OR_RETURN(const NpyArray* array, find_column(arrays, key, name));
    columns.add(key, *array, column_of(*array).field);
    if (columns.lengths.back() == columns.lengths.front()) continue;
    return fail(ErrorCode::kShape, name, "array \"", key, "\" has a different length; store all of it");
  }
  return columns;
}

bool are_rows_of_events(const NpyArray& array) {
  const bool are_rows =
      array.fields.empty() && array.shape.size() == 2 && array.shape[1] == 4 && table::is_number_type(array.type);
  const bool are_records = !array.fields.empty() && array.shape.size() == 1;
  return are_rows || are_records;
}

/// Returns the array [events, 4] or of records of an archive that is named events or is the only one, or null.
const NpyArray* find_rows(const NpzArrays& arrays) {
  const auto named = arrays.find("events");
  if (named != arrays.end() && are_rows_of_events(named->second)) return &named->second;
  const auto are_rows = [](const auto& entry) { return are_rows_of_events(entry.second); };
  const auto first = std::ranges::find_if(arrays, are_rows);
  return std::ranges::count_if(arrays, are_rows) == 1 ? &first->second : nullptr;
}

/// Creates a reader of decoded arrays; `info` contains format and size.
Result<ReaderPtr> open_arrays(NpzArrays arrays, RecordingInfo info, const std::string& name, const OpenOptions& options,
                              BlocksPtr side_triggers = {}) {
  E2LF_RETURN_IF_ERROR(apply_size_option(options, info, name));
  const NpyArray* const rows = find_rows(arrays);
  NpzColumns columns;
  if (rows != nullptr) {
    columns = columns_of_rows(*rows);
  } else {
    E2LF_ASSIGN_OR_RETURN(columns, named_columns(arrays, name));
  }
  const size_t count = columns.lengths.empty() ? 0 : columns.lengths[0];
  table::TableSample sample{.is_ordered = rows != nullptr};
  for (size_t i = 0; i < columns.columns.size(); ++i) {
    sample.columns.push_back(table::sample_of(columns.names[i], columns.columns[i], std::min(count, kSampledRows)));
  }
  E2LF_ASSIGN_OR_RETURN(const table::TableLayout layout, decide_layout(sample, options, name, info));
  EventBatch all;
  size_t num_bad = table::to_events(columns.columns, layout, count, all.events);
  E2LF_ASSIGN_OR_RETURN(all.triggers, read_triggers(arrays, name, layout.unit, num_bad));
  E2LF_RETURN_IF_ERROR(table::require_mostly_events(all.events.size(), num_bad, info, "", name));
  auto blocks = std::make_unique<MemoryBlocks>(std::move(all), num_bad);
  return std::make_unique<RecordingReader>(std::move(blocks), std::move(info), name, options, std::move(side_triggers));
}

}  // namespace

bool detect_npz(std::span<const uint8_t> head) {
  constexpr size_t kLocalHeader = 30;
  if (head.size() < kLocalHeader + 5 || load_le<uint32_t>(head.data()) != 0x04034B50) return false;
  const std::string_view first(reinterpret_cast<const char*>(&head[kLocalHeader]), 5);
  constexpr std::string_view kColumns[] = {"x.npy", "y.npy", "p.npy", "t.npy", "xs.np", "ys.np", "ps.np", "ts.np"};
  return std::ranges::find(kColumns, first) != std::end(kColumns);
}

Result<ReaderPtr> open_npz(SourcePtr source, const OpenOptions& options) {
  const std::string name = source->name();
  E2LF_RETURN_IF_ERROR(require_memory(source->size().value_or(0), kReadRemedy, name));
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_rest(*source));
  E2LF_RETURN_IF_ERROR(check_memory(bytes, name));
  E2LF_ASSIGN_OR_RETURN(NpzArrays arrays, decode_npz(bytes, name));
  RecordingInfo info{.format = "npz"};
  const auto numbers = [&arrays](const char* key) {
    const auto found = arrays.find(key);
    const bool are_few = found != arrays.end() && found->second.num_elements() <= 2;
    if (!are_few || !table::is_number_type(found->second.type)) return std::vector<double>();
    return table::to_doubles(column_of(found->second), found->second.num_elements());
  };
  if (options.width == 0 || options.height == 0) table::read_sensor_size(numbers, info);
  return open_arrays(std::move(arrays), std::move(info), name, options);
}

bool detect_npy(std::span<const uint8_t> head) {
  const auto header = parse_npy_header(head, "");
  if (!header || !are_rows_of_events(header->array)) return false;
  const std::vector<NpyField>& fields = header->array.fields;
  const auto names_time = [](const NpyField& field) { return table::parse_column_name(field.name).field == Field::kT; };
  return fields.empty() || (fields.size() >= table::kNumFields && std::ranges::any_of(fields, names_time));
}

Result<ReaderPtr> open_npy(SourcePtr source, const OpenOptions& options) {
  const std::string name = source->name();
  E2LF_RETURN_IF_ERROR(require_memory(3 * source->size().value_or(0), kReadRemedy, name));
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_rest(*source));
  NpzArrays arrays;
  E2LF_ASSIGN_OR_RETURN(arrays["events"], decode_npy(bytes, name));
  if (!are_rows_of_events(arrays["events"])) {
    return fail(ErrorCode::kShape, name,
                "this is neither a one-dimensional array of records with fields x, y, p, t nor an array [events, 4]; "
                "store one of them");
  }
  E2LF_ASSIGN_OR_RETURN(BlocksPtr triggers, open_side_triggers(source->path()));
  return open_arrays(std::move(arrays), {.format = "npy"}, name, options, std::move(triggers));
}

namespace {

/// Returns the .npy files in a folder whose names state columns of events, by these names, if they are all columns;
/// otherwise none.
std::map<std::string, std::filesystem::path> column_files(const std::filesystem::path& folder) {
  std::map<std::string, std::filesystem::path> files;
  std::vector<std::string> names;
  bool has_xy = false;
  for (const std::filesystem::path& path : paths_in(folder)) {
    const std::string name = path.stem().string();
    const table::ColumnName column = table::parse_column_name(name);
    if (path.extension() != ".npy" || (!column.field && !column.is_xy)) continue;
    files.emplace(name, path);
    has_xy = has_xy || column.is_xy;
    names.push_back(name);
  }
  table::KnownColumns known = table::find_fields(names);
  if (has_xy) known[of(Field::kX)] = known[of(Field::kY)] = 0;
  return table::are_complete(known) ? files : decltype(files)();
}

}  // namespace

bool is_column_folder(const std::filesystem::path& path) {
  return !column_files(path).empty();
}

Result<ReaderPtr> open_column_folder(const std::filesystem::path& path, const OpenOptions& options) {
  const auto files = column_files(path);
  uint64_t bytes = 0;
  for (const auto& [name, file] : files) {
    std::error_code error;
    const uint64_t size = std::filesystem::file_size(file, error);
    if (!error) bytes += size;
  }
  E2LF_RETURN_IF_ERROR(require_memory(3 * bytes, kReadRemedy, path.string()));
  NpzArrays arrays;
  for (const auto& [name, file] : files) {
    E2LF_ASSIGN_OR_RETURN(arrays[name], read_npy(file));
  }
  return open_arrays(std::move(arrays), {.format = "npy"}, path.string(), options);
}

Result<WriterPtr> create_npz(SinkPtr sink, const RecordingInfo& info) {
  return WriterPtr(std::make_unique<NpzWriter>(std::move(sink), info));
}

}  // namespace e2lf::formats::numpy
