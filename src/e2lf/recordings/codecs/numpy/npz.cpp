// SPDX-License-Identifier: MIT
#include <algorithm>
#include <string_view>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/memory.h"
#include "e2lf/base/text.h"
#include "e2lf/files/npy.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/codecs/numpy/column_convert.h"
#include "e2lf/recordings/codecs/numpy/numpy.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/time_search.h"
#include "e2lf/recordings/time_sort.h"

namespace e2lf::recordings::numpy {
namespace {

constexpr size_t kBlockEvents = size_t{1} << 17;
constexpr uint64_t kEventBytes = 13;  // of its columns x, y, p, t
constexpr const char* kReadRemedy = "an .npz is read whole: store the events as .npy, .csv or .hdf5, or in parts";

using Names = std::initializer_list<const char*>;

/// A column of the archive under one of its names, checked to be one-dimensional and of numbers.
Result<const NpyArray*> find_column(const NpzArrays& arrays, Names names, const std::string& name) {
  for (const char* key : names) {
    const auto found = arrays.find(key);
    if (found == arrays.end()) continue;
    const NpyArray& array = found->second;
    if (array.shape.size() != 1 || !is_number_type(array.type)) {
      return Error{ErrorCode::kShape, cat("array \"", key, "\" is not a column of numbers; store x, y, p, t"), name};
    }
    return &array;
  }
  std::vector<std::string> held;
  for (const auto& [key, array] : arrays) held.push_back(key);
  return Error{ErrorCode::kNotFound,
               cat("the archive has no array \"", *names.begin(), "\", but ", join(held),
                   "; store the columns x, y, p, t, or events as [events, 4]"),
               name};
}

Result<const NpyArray*> find_column(const NpzArrays& arrays, Names names, const std::string& name, size_t count) {
  E2LF_ASSIGN_OR_RETURN(const NpyArray* array, find_column(arrays, names, name));
  if (count == array->shape[0]) return array;
  return Error{ErrorCode::kShape, cat("array \"", *names.begin(), "\" differs in length; store it whole"), name};
}

/// Reads a column of `count` rows; those that do not fit T set their place in `bad`.
template <typename T>
Result<Column<T>> read_column(const NpzArrays& arrays, Names names, const std::string& name, size_t count,
                              Column<uint8_t>& bad) {
  E2LF_ASSIGN_OR_RETURN(const NpyArray* array, find_column(arrays, names, name, count));
  Column<T> column(count);
  to_column(array->bytes.data(), {array->type, 0, array->item_size}, count, column.data(), bad.data());
  return column;
}

/// Reads a column of times, in microseconds then.
Result<Column<int64_t>> read_times(const NpzArrays& arrays, Names names, const std::string& name, size_t count,
                                   TimeUnit unit, Column<uint8_t>& bad) {
  E2LF_ASSIGN_OR_RETURN(const NpyArray* array, find_column(arrays, names, name, count));
  Column<int64_t> column(count);
  to_times(array->bytes.data(), {array->type, 0, array->item_size}, unit, count, column.data(), bad.data());
  return column;
}

/// The triggers, sorted, their times in `unit` where they are floating-point numbers; those that cannot be read are
/// added to `num_bad`.
Result<std::vector<Trigger>> read_triggers(const NpzArrays& arrays, const std::string& name, TimeUnit unit,
                                           size_t& num_bad) {
  std::vector<Trigger> triggers;
  if (arrays.count("trigger_t") == 0) return triggers;
  E2LF_ASSIGN_OR_RETURN(const NpyArray* times, find_column(arrays, {"trigger_t"}, name));
  const size_t count = times->shape[0];
  Column<uint8_t> bad(count, 0);
  if (times->type[0] != 'f' && unit == TimeUnit::kSeconds) unit = TimeUnit::kMicroseconds;
  E2LF_ASSIGN_OR_RETURN(const auto t, read_times(arrays, {"trigger_t"}, name, count, unit, bad));
  E2LF_ASSIGN_OR_RETURN(const auto p, read_column<uint8_t>(arrays, {"trigger_p"}, name, count, bad));
  E2LF_ASSIGN_OR_RETURN(const auto id, read_column<uint16_t>(arrays, {"trigger_id"}, name, count, bad));
  for (size_t i = 0; i < count; ++i) {
    if (bad[i] == 0 && is_time(t[i]))
      triggers.push_back({t[i], id[i], static_cast<uint8_t>(p[i] != 0)});
    else
      ++num_bad;
  }
  std::stable_sort(triggers.begin(), triggers.end(), [](const Trigger& a, const Trigger& b) { return a.t < b.t; });
  return triggers;
}

/// Refuses an archive whose events have no room: its arrays, their columns, and these once more where they are sorted.
Result<void> check_memory(std::span<const uint8_t> archive, const std::string& name) {
  E2LF_ASSIGN_OR_RETURN(const NpzArrays arrays, peek_npz(archive, name));
  uint64_t bytes = 0, most_rows = 0;
  for (const auto& [key, array] : arrays) {
    bytes += static_cast<uint64_t>(array.num_elements()) * array.item_size;
    if (!array.shape.empty()) most_rows = std::max<uint64_t>(most_rows, array.shape[0]);
  }
  return require_memory(bytes + 2 * kEventBytes * most_rows, kReadRemedy, name);
}

/// A whole recording in memory, handed out block by block.
class MemoryBlocks final : public EventBlocks {
 public:
  MemoryBlocks(EventBatch all, size_t bad) : all_(std::move(all)), bad_(bad) {}

  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    block.clear();
    if (!std::exchange(has_begun_, true)) {
      block.triggers = all_.triggers;
      if (bad_ > 0) summary.add(Violation::kBadRecord, 0, bad_);
      summary.dropped_words += bad_;
    }
    const size_t end = std::min(all_.events.size(), next_ + kBlockEvents);
    block.events.append(all_.events, next_, end);
    const bool more = next_ < end;
    next_ = end;
    return more;
  }

  Result<void> seek_before(int64_t t_us) override {
    const auto time_at = [&](uint64_t i) -> Result<int64_t> {
      const auto begin = all_.events.t.begin() + static_cast<ptrdiff_t>(i);
      const size_t count = std::min<size_t>(kTimesPerProbe, all_.events.size() - i);
      return median_time({begin, begin + static_cast<ptrdiff_t>(count)});
    };
    E2LF_ASSIGN_OR_RETURN(next_, find_place_before(all_.events.size(), t_us, time_at));
    has_begun_ = false;
    return {};
  }

 private:
  EventBatch all_;
  size_t bad_;
  bool has_begun_ = false;  ///< triggers and damage have been handed out
  size_t next_ = 0;
};

class NpzWriter final : public RecordingWriter {
 public:
  NpzWriter(std::unique_ptr<ByteSink> sink, const RecordingInfo& info)
      : sink_(std::move(sink)), info_(info), check_(info.width, info.height, sink_->name()) {}

  bool holds_triggers() const override { return true; }

  Result<void> write(const EventBatch& batch) override {
    E2LF_RETURN_IF_ERROR(check_(batch));
    E2LF_RETURN_IF_ERROR(check_room(batch.events.size()));
    all_.events.append(batch.events);
    all_.triggers.insert(all_.triggers.end(), batch.triggers.begin(), batch.triggers.end());
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
    // Stored: deflate takes longer than everything else together and wins little on such columns.
    E2LF_RETURN_IF_ERROR(sink_->write(encode_npz(arrays, /*compress=*/false)));
    return sink_->commit();
  }

 private:
  /// Where the columns grow to twice their size: room for these beside the old ones, or for the archive at the end.
  Result<void> check_room(size_t more) {
    const size_t count = all_.events.size() + more;
    if (count <= room_) return {};
    room_ = std::max(2 * count, kBlockEvents);
    return require_memory(2 * kEventBytes * room_, "an .npz is written whole: write .raw, .npy or .hdf5 instead",
                          sink_->name());
  }

  std::unique_ptr<ByteSink> sink_;
  RecordingInfo info_;
  BatchCheck check_;
  EventBatch all_;
  size_t room_ = 0;  ///< events for which there was memory
};

void read_size(const NpzArrays& arrays, RecordingInfo& info) {
  const auto found = arrays.find("size");
  if (found == arrays.end()) return;
  const auto size = found->second.to_int32("size");
  if (!size || size->size() != 2 || (*size)[0] < 0 || (*size)[1] < 0) return;
  info.width = static_cast<size_t>((*size)[0]);
  info.height = static_cast<size_t>((*size)[1]);
}

/// So many tell columns and units.
constexpr size_t kSampledRows = 4096;

struct NpzEvents {
  EventColumns columns;
  TimeUnit unit = TimeUnit::kAuto;
  size_t num_bad = 0;
};

/// The events of an array [events, 4].
Result<NpzEvents> read_rows(const NpyArray& array, const OpenOptions& options, const std::string& name,
                            RecordingInfo& info) {
  const auto rows =
      sample_rows(array.bytes.data(), array.type, array.item_size, std::min(array.shape[0], kSampledRows));
  E2LF_ASSIGN_OR_RETURN(const std::string order, find_column_order(rows, options.columns, name));
  if (options.columns.empty()) info.assumptions.push_back(column_assumption(order));
  RecordFields fields = fields_of_rows(order, array.type, array.item_size);
  fields.unit = find_time_unit(options.time_unit, array.bytes.data(), fields.t, rows.size(), info.assumptions);
  NpzEvents events;
  events.unit = fields.unit;
  events.num_bad = to_events(array.bytes.data(), fields, array.shape[0], events.columns);
  return events;
}

/// The events of four arrays, a column each.
Result<NpzEvents> read_columns(const NpzArrays& arrays, const OpenOptions& options, const std::string& name,
                               RecordingInfo& info) {
  const Names times = {"t", "ts", "timestamp", "timestamps"};
  E2LF_ASSIGN_OR_RETURN(const NpyArray* time_column, find_column(arrays, times, name));
  const size_t count = time_column->shape[0];
  NpzEvents events;
  events.unit =
      find_time_unit(options.time_unit, time_column->bytes.data(), {time_column->type, 0, time_column->item_size},
                     std::min(count, kSampledRows), info.assumptions);
  Column<uint8_t> bad(count);
  std::fill(bad.begin(), bad.end(), uint8_t{0});
  EventColumns& columns = events.columns;
  E2LF_ASSIGN_OR_RETURN(columns.x, read_column<uint16_t>(arrays, {"x", "xs"}, name, count, bad));
  E2LF_ASSIGN_OR_RETURN(columns.y, read_column<uint16_t>(arrays, {"y", "ys"}, name, count, bad));
  E2LF_ASSIGN_OR_RETURN(columns.p, read_column<uint8_t>(arrays, {"p", "ps", "pol", "polarity"}, name, count, bad));
  E2LF_ASSIGN_OR_RETURN(columns.t, read_times(arrays, times, name, count, events.unit, bad));
  for (size_t i = 0; i < count; ++i) bad[i] |= columns.p[i] > 1;
  events.num_bad = remove_bad(columns, 0, bad);
  return events;
}

/// The array [events, 4] of an archive, or null.
const NpyArray* find_rows(const NpzArrays& arrays) {
  const auto named = arrays.find("events");
  const NpyArray* const array = named != arrays.end() ? &named->second
                                : arrays.size() == 1  ? &arrays.begin()->second
                                                      : nullptr;
  const bool fits = array != nullptr && array->fields.empty() && array->shape.size() == 2 && array->shape[1] == 4 &&
                    is_number_type(array->type);
  return fits ? array : nullptr;
}

}  // namespace

bool detect_npz(std::span<const uint8_t> head) {
  constexpr size_t kLocalHeader = 30;
  if (head.size() < kLocalHeader + 5 || load_le<uint32_t>(head.data()) != 0x04034B50) return false;
  const std::string_view first(reinterpret_cast<const char*>(&head[kLocalHeader]), 5);
  constexpr std::string_view kColumns[] = {"x.npy", "y.npy", "p.npy", "t.npy", "xs.np", "ys.np", "ps.np", "ts.np"};
  return std::find(std::begin(kColumns), std::end(kColumns), first) != std::end(kColumns);
}

Result<std::unique_ptr<RecordingReader>> open_npz(std::unique_ptr<ByteSource> source, const OpenOptions& options) {
  const std::string name = source->name();
  E2LF_RETURN_IF_ERROR(require_memory(source->size().value_or(0), kReadRemedy, name));
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_rest(*source));
  E2LF_RETURN_IF_ERROR(check_memory(bytes, name));
  E2LF_ASSIGN_OR_RETURN(const NpzArrays arrays, decode_npz(bytes, name));
  RecordingInfo info;
  info.format = "npz";
  read_size(arrays, info);
  E2LF_RETURN_IF_ERROR(apply_size_option(options, info, name));

  const NpyArray* const rows = find_rows(arrays);
  E2LF_ASSIGN_OR_RETURN(NpzEvents events, rows != nullptr ? read_rows(*rows, options, name, info)
                                                          : read_columns(arrays, options, name, info));
  size_t num_bad = events.num_bad;
  EventBatch all;
  all.events = std::move(events.columns);
  E2LF_ASSIGN_OR_RETURN(all.triggers, read_triggers(arrays, name, events.unit, num_bad));
  auto columns = std::make_unique<MemoryBlocks>(std::move(all), num_bad);
  return make_block_reader(make_time_sorted(std::move(columns), /*is_seekable=*/true, name), std::move(info), name,
                           options);
}

Result<std::unique_ptr<RecordingWriter>> create_npz(std::unique_ptr<ByteSink> sink, const RecordingInfo& info) {
  std::unique_ptr<RecordingWriter> writer = std::make_unique<NpzWriter>(std::move(sink), info);
  return writer;
}

}  // namespace e2lf::recordings::numpy
