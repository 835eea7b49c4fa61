// SPDX-License-Identifier: MIT
// Reads Metavision HDF5; declared in codecs.h.

#include <algorithm>
#include <atomic>
#include <cstring>
#include <tuple>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/codecs/codecs.h"
#include "e2lf/recordings/codecs/metavision_hdf5/ecf.h"
#include "e2lf/recordings/codecs/metavision_hdf5/metavision_layout.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::recordings::hdf5_events {
namespace {

constexpr uint64_t kBlockEvents = 8 * kChunkEvents;
constexpr size_t kMaxChunkBytes = size_t{1} << 26;

/// Copies records to the events [begin, begin + count) of `events`, which must be large enough.
void columns_from_records(const EventRecord* records, size_t count, EventColumns& events, size_t begin) {
  for (size_t i = 0; i < count; ++i) {
    const EventRecord& record = records[i];
    events.set(begin + i, {record.x, record.y, static_cast<uint8_t>(record.p > 0), record.t});
  }
}

bool has_vendor_layout(hid_t dataset) {
  const Handle stored(H5Dget_type(dataset), H5Tclose);
  return H5Tequal(stored.get(), event_type().get()) > 0;
}

/// Reads /CD/events in blocks. ECF chunks are fetched in their stored form and decoded here, several in parallel; all
/// others are decoded by the HDF5 library.
class EventChunks final : public EventBlocks {
 public:
  static Result<BlocksPtr> open(hid_t file, const std::string& location, int threads) {
    const LibraryLock lock;
    auto chunks = std::make_unique<EventChunks>();
    E2LF_ASSIGN_OR_RETURN(chunks->shape_, open_dataset(file, "CD/events", location));
    const DatasetShape& shape = chunks->shape_;
    chunks->num_missing_ = shape.claimed_length - shape.length;
    chunks->location_ = location + ": CD/events";
    chunks->threads_ = threads;
    const bool is_ecf = shape.storage.filters.size() == 1 && shape.storage.filters[0] == kEcfFilter;
    chunks->is_direct_ = is_ecf && shape.chunk_length != 0 && has_vendor_layout(shape.dataset.get());
    if (!chunks->is_direct_) E2LF_RETURN_IF_ERROR(e2lf::hdf5::check_filters(shape.storage, chunks->location_));
    return BlocksPtr(std::move(chunks));
  }

  /// Reads the next block. All events of a chunk that cannot be decoded are counted as kBadRecord, and those that are
  /// zeros as kZeros. In a damaged chunk, events that are later than the first time of the next chunk are dropped
  /// (kTimeJump).
  Result<bool> next(EventBatch& block, DecodeSummary& summary) override {
    const LibraryLock lock;
    block.clear();
    EventColumns& events = block.events;
    if (next_event_ >= shape_.length) summary.add_dropped(Violation::kTruncated, 0, std::exchange(num_missing_, 0));
    if (!is_direct_) return next_records(events);
    std::vector<Chunk> chunks = fetch_block();
    std::vector<size_t> begins = {0};
    for (const Chunk& chunk : chunks) begins.push_back(begins.back() + chunk.count);
    events.resize(begins.back());
    decode_block(chunks, begins, events);
    // From the last chunk to the first, so that the positions of earlier ones do not change.
    for (size_t i = chunks.size(); i-- > 0;) {
      const Chunk* const after = i + 1 < chunks.size() ? &chunks[i + 1] : ahead_ ? &*ahead_ : nullptr;
      keep_plausible(chunks[i], after, begins[i], begins[i + 1], events, summary);
    }
    return !chunks.empty();
  }

  /// Seeks to the last chunk whose first event is before t_us.
  Result<void> seek_before(int64_t t_us) override {
    const LibraryLock lock;
    ahead_.reset();
    next_event_ = 0;
    num_missing_ = shape_.claimed_length - shape_.length;
    if (!is_direct_ || shape_.length == 0) return {};
    uint64_t low = 0, high = (shape_.length - 1) / shape_.chunk_length;
    while (low < high) {
      const uint64_t middle = low + (high - low + 1) / 2;
      if (const Chunk chunk = fetch(middle); chunk.first_us && *chunk.first_us < t_us) {
        low = middle;
      } else {
        high = middle - 1;
      }
    }
    next_event_ = low * shape_.chunk_length;
    return {};
  }

 private:
  struct Chunk {
    uint64_t index = 0;
    uint64_t byte = 0;     ///< position in the file
    size_t count = 0;      ///< expected number of events
    size_t num_zeros = 0;  ///< events that were zeros in place of data
    bool is_stored_raw = false;
    std::vector<uint8_t> bytes;       ///< empty if the chunk is missing or cannot be read
    std::optional<int64_t> first_us;  ///< empty if the chunk is too short to have one
  };

  Result<bool> next_records(EventColumns& events) {
    const uint64_t count = std::min(kBlockEvents, shape_.length - next_event_);
    if (count == 0) return false;
    records_.resize(count);
    E2LF_RETURN_IF_ERROR(read_elements(shape_, event_type().get(), next_event_, count, records_.data(), location_));
    next_event_ += count;
    events.resize(count);
    columns_from_records(records_.data(), count, events, 0);
    return true;
  }

  Chunk fetch(uint64_t index) const {
    Chunk chunk;
    const hsize_t offset = index * shape_.chunk_length;
    chunk.index = index;
    chunk.count = std::min<uint64_t>(shape_.chunk_length, shape_.length - offset);
    hsize_t size = 0;
    haddr_t address = 0;
    uint32_t filter_mask = 0;
    const bool is_found =
        H5Dget_chunk_info_by_coord(shape_.dataset.get(), &offset, &filter_mask, &address, &size) >= 0 && size > 0;
    if (is_found) chunk.byte = address;
    if (!is_found || size > kMaxChunkBytes) return chunk;
    chunk.bytes.resize(size);
    if (H5Dread_chunk(shape_.dataset.get(), H5P_DEFAULT, &offset, &filter_mask, chunk.bytes.data()) < 0) {
      chunk.bytes.clear();
    }
    chunk.is_stored_raw = (filter_mask & 1) != 0;
    const size_t time_at = chunk.is_stored_raw ? offsetof(EventRecord, t) : 4;
    if (chunk.bytes.size() >= time_at + 8) chunk.first_us = load_le<int64_t>(&chunk.bytes[time_at]);
    return chunk;
  }

  /// Writes the events of a chunk from `begin` on, where there is room for chunk.count events, and sets chunk.count to
  /// their number.
  static void decode(Chunk& chunk, EventColumns& events, size_t begin) {
    const size_t wanted = std::exchange(chunk.count, 0);
    if (chunk.is_stored_raw) {
      const size_t count = std::min(wanted, chunk.bytes.size() / sizeof(EventRecord));
      std::vector<EventRecord> records(count);
      std::copy_n(chunk.bytes.data(), count * sizeof(EventRecord), reinterpret_cast<uint8_t*>(records.data()));
      columns_from_records(records.data(), count, events, begin);
      chunk.count = count;
      return;
    }
    const auto stored = ecf::event_count(chunk.bytes);
    if (!stored) return;
    const auto decode_into = [&](EventColumns& out, size_t at) {
      const auto part = [&](auto& column) { return std::span(column).subspan(at, *stored); };
      return ecf::decode(chunk.bytes, {part(out.x), part(out.y), part(out.p), part(out.t)}).ok();
    };
    const size_t count = std::min(*stored, wanted);
    if (*stored <= wanted) {
      if (!decode_into(events, begin)) return;
    } else {
      // The last chunk of a file may be stored at full length, with padding after its events.
      EventColumns full;
      full.resize(*stored);
      if (!decode_into(full, 0)) return;
      for (size_t i = 0; i < wanted; ++i) events.set(begin + i, full[i]);
    }
    const auto part = [&](auto& column) { return std::span(column).subspan(begin, count); };
    chunk.count = ecf::drop_zeros(chunk.bytes, {part(events.x), part(events.y), part(events.p), part(events.t)});
    chunk.num_zeros = count - chunk.count;
  }

  std::vector<Chunk> fetch_block() {
    std::vector<Chunk> chunks;
    const uint64_t chunks_per_block = std::max<uint64_t>(1, kBlockEvents / shape_.chunk_length);
    while (next_event_ < shape_.length && chunks.size() < chunks_per_block) {
      const uint64_t index = next_event_ / shape_.chunk_length;
      const bool is_fetched = ahead_ && ahead_->index == index;
      chunks.push_back(is_fetched ? *std::exchange(ahead_, std::nullopt) : fetch(index));
      next_event_ = (index + 1) * shape_.chunk_length;
    }
    if (next_event_ < shape_.length) ahead_ = fetch(next_event_ / shape_.chunk_length);
    return chunks;
  }

  void decode_block(std::vector<Chunk>& chunks, const std::vector<size_t>& begins, EventColumns& events) const {
    const auto decode_range = [&](size_t from, size_t to) {
      for (size_t i = from; i < to; ++i) decode(chunks[i], events, begins[i]);
    };
    if (threads_ == 1) {
      decode_range(0, chunks.size());
    } else {
      parallel_for(chunks.size(), 1, decode_range);
    }
  }

  /// Reduces [begin, end), the room of a chunk, to the events that were decoded and are plausible.
  void keep_plausible(const Chunk& chunk, const Chunk* after, size_t begin, size_t end, EventColumns& events,
                      DecodeSummary& summary) const {
    size_t kept = chunk.count;
    summary.add(Violation::kZeros, chunk.byte, chunk.num_zeros);
    summary.add(Violation::kBadRecord, chunk.byte, end - begin - kept - chunk.num_zeros);
    if (kept > 0 && after != nullptr && after->first_us && *after->first_us >= events.t[begin]) {
      const auto from = events.t.begin() + static_cast<ptrdiff_t>(begin);
      const auto is_late = [&](int64_t t) { return t > *after->first_us; };
      kept = static_cast<size_t>(std::find_if(from, from + static_cast<ptrdiff_t>(kept), is_late) - from);
      summary.add(Violation::kTimeJump, chunk.byte, chunk.count - kept);
    }
    if (begin + kept == end) return;
    summary.dropped_words += end - begin - kept;
    events.erase(begin + kept, end);
  }

  DatasetShape shape_;
  std::string location_;
  int threads_ = 1;
  bool is_direct_ = false;    ///< whether chunks are ECF or uncompressed records
  uint64_t num_missing_ = 0;  ///< events that the file states but does not contain, until they are counted
  uint64_t next_event_ = 0;
  std::optional<Chunk> ahead_;  ///< fetched in advance for its first time
  std::vector<EventRecord> records_;
};

struct Field {
  const char* name;
  size_t offset;
  hid_t type;
};

Handle compound_type(size_t bytes, std::initializer_list<Field> fields) {
  Handle type(H5Tcreate(H5T_COMPOUND, bytes), H5Tclose);
  for (const Field& field : fields) H5Tinsert(type.get(), field.name, field.offset, field.type);
  return type;
}

constexpr uint64_t kTriggerBlock = 4096;

class TriggerDataset final : public EventBlocks {
 public:
  TriggerDataset(DatasetShape shape, std::string location) : shape_(std::move(shape)), location_(std::move(location)) {}

  Result<bool> next(EventBatch& block, DecodeSummary&) override {
    block.clear();
    const uint64_t count = std::min(kTriggerBlock, shape_.length - next_);
    if (count == 0) return false;
    records_.resize(count);
    E2LF_RETURN_IF_ERROR(read_elements(shape_, trigger_type().get(), next_, count, records_.data(), location_));
    for (const TriggerRecord& record : records_) {
      block.triggers.push_back({record.t, static_cast<uint16_t>(record.id), static_cast<uint8_t>(record.p > 0)});
    }
    next_ += count;
    return true;
  }

  Result<void> seek_before(int64_t) override {
    next_ = 0;
    return {};
  }

 private:
  DatasetShape shape_;
  std::string location_;
  uint64_t next_ = 0;
  std::vector<TriggerRecord> records_;
};

/// Opens the file of a source; a source without a file is read into memory first. Fails with kFormat and kIo.
Result<Handle> open_source(ByteSource& source) {
  const LibraryLock lock;
  Handle file;
  if (!source.path().empty()) {
    file = e2lf::hdf5::open_file(source.path());
  } else {
    E2LF_ASSIGN_OR_RETURN(std::vector<uint8_t> bytes, read_rest(source));
    file = e2lf::hdf5::open_bytes(std::move(bytes));
  }
  if (!file.valid()) {
    return fail(ErrorCode::kFormat, source.name(),
                "the HDF5 library cannot open this file, which is damaged or incomplete; copy it again");
  }
  return file;
}

RecordingInfo read_info(hid_t file) {
  RecordingInfo info{.format = "hdf5"};
  for (const auto& [name, text] : e2lf::hdf5::read_text_attributes(file)) {
    info.header.emplace_back(name, header_text(text));
  }
  constexpr size_t kMostSide = 65536;
  const auto geometry = parse_geometry(info.find("geometry").value_or(""), kMostSide);
  if (geometry) std::tie(info.width, info.height) = *geometry;
  return info;
}

std::atomic<OpenLayout>& other_layout() {
  static std::atomic<OpenLayout> layout = nullptr;
  return layout;
}

}  // namespace

Handle event_type() {
  const LibraryLock lock;
  return compound_type(sizeof(EventRecord), {{"x", offsetof(EventRecord, x), H5T_STD_U16LE},
                                             {"y", offsetof(EventRecord, y), H5T_STD_U16LE},
                                             {"p", offsetof(EventRecord, p), H5T_STD_I16LE},
                                             {"t", offsetof(EventRecord, t), H5T_STD_I64LE}});
}

Handle trigger_type() {
  const LibraryLock lock;
  return compound_type(sizeof(TriggerRecord), {{"p", offsetof(TriggerRecord, p), H5T_STD_I16LE},
                                               {"t", offsetof(TriggerRecord, t), H5T_STD_I64LE},
                                               {"id", offsetof(TriggerRecord, id), H5T_STD_I16LE}});
}

Handle index_type() {
  const LibraryLock lock;
  return compound_type(sizeof(IndexRecord), {{"id", offsetof(IndexRecord, id), H5T_STD_U64LE},
                                             {"ts", offsetof(IndexRecord, ts), H5T_STD_I64LE}});
}

void add_layout(OpenLayout open) {
  other_layout() = open;
}

bool detect(std::span<const uint8_t> head) {
  constexpr uint8_t kMagic[] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1A, '\n'};
  // MATLAB files begin with another text.
  for (const size_t begin : {size_t{0}, size_t{512}, size_t{1024}, size_t{2048}}) {
    const bool has_room = head.size() >= begin + sizeof(kMagic);
    if (has_room && std::memcmp(head.data() + begin, kMagic, sizeof(kMagic)) == 0) return true;
  }
  return false;
}

Result<ReaderPtr> open(SourcePtr source, const OpenOptions& options) {
  const LibraryLock lock;
  const std::string name = source->name();
  // The data sets keep the file open.
  E2LF_ASSIGN_OR_RETURN(const Handle file, open_source(*source));
  RecordingInfo info = read_info(file.get());
  E2LF_RETURN_IF_ERROR(apply_size_option(options, info, name));

  if (H5Lexists(file.get(), "CD", H5P_DEFAULT) <= 0) {
    if (const OpenLayout open_other = other_layout()) return open_other(file.get(), std::move(info), *source, options);
    return fail(ErrorCode::kNotFound, name, "the file has no events in CD/events (Metavision); check what it contains");
  }
  E2LF_RETURN_IF_ERROR(refuse_table_options(options, "hdf5", name));
  E2LF_ASSIGN_OR_RETURN(BlocksPtr blocks, EventChunks::open(file.get(), name, options.threads));
  BlocksPtr triggers;
  if (auto shape = open_dataset(file.get(), "EXT_TRIGGER/events", name)) {
    triggers = std::make_unique<TriggerDataset>(*std::move(shape), name + ": EXT_TRIGGER/events");
  }
  return std::make_unique<RecordingReader>(std::move(blocks), std::move(info), name, options, std::move(triggers));
}

}  // namespace e2lf::recordings::hdf5_events
