// SPDX-License-Identifier: MIT
// Writes Metavision HDF5; declared in codecs.h.
#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/files/file.h"
#include "e2lf/hdf5/library.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/codecs/codecs.h"
#include "e2lf/recordings/codecs/metavision_hdf5/ecf.h"
#include "e2lf/recordings/codecs/metavision_hdf5/metavision_layout.h"

namespace e2lf::recordings::hdf5_events {
using e2lf::hdf5::CheckedFile;

namespace {

/// Number of chunks that are compressed in parallel, each by one thread.
constexpr size_t kBlockChunks = 16;

/// The longest time without an element, 19 hours, which needs half a gigabyte of index.
constexpr int64_t kMaxPauseUs = int64_t{1} << 36;

Error write_error(const std::string& name) {
  return fail(ErrorCode::kIo, name, "the HDF5 library could not write; check the disk's free space");
}

/// Writes a variable-length ASCII attribute, as Metavision does. Fails with kIo.
Result<void> write_text_attribute(hid_t object, const std::string& name, const std::string& text) {
  const LibraryLock lock;
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const char* value = text.c_str();
  if (!attribute.valid() || H5Awrite(attribute.get(), type.get(), &value) < 0) return write_error(name);
  return {};
}

/// A one-dimensional data set that grows at its end, uncompressed.
class GrowingDataset {
 public:
  /// Creates the data set. `filter` is 0 for none, or an optional filter that the caller applies (append_chunk).
  static Result<GrowingDataset> create(hid_t parent, const std::string& name, hid_t file_type,
                                       H5Z_filter_t filter = 0) {
    const LibraryLock lock;
    const hsize_t none = 0, unlimited = H5S_UNLIMITED, chunk = kChunkEvents;
    const Handle space(H5Screate_simple(1, &none, &unlimited), H5Sclose);
    const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_chunk(properties.get(), 1, &chunk);
    // Optional, so that the file can be created and inspected where the filter is not installed.
    if (filter != 0) H5Pset_filter(properties.get(), filter, H5Z_FLAG_OPTIONAL, 0, nullptr);
    GrowingDataset result;
    result.name_ = name;
    result.dataset_ = Handle(
        H5Dcreate2(parent, name.c_str(), file_type, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Dclose);
    if (!result.dataset_.valid()) return write_error(name);
    return result;
  }

  /// Appends elements of `memory_type`. Fails with kIo.
  Result<void> append(hid_t memory_type, const void* elements, uint64_t count) {
    if (count == 0) return {};
    const LibraryLock lock;
    const hsize_t start = length_, added = count;
    E2LF_RETURN_IF_ERROR(grow(count));
    const Handle file_space(H5Dget_space(dataset_.get()), H5Sclose);
    const Handle memory_space(H5Screate_simple(1, &added, nullptr), H5Sclose);
    if (H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, &start, nullptr, &added, nullptr) < 0 ||
        H5Dwrite(dataset_.get(), memory_type, memory_space.get(), file_space.get(), H5P_DEFAULT, elements) < 0) {
      return write_error(name_);
    }
    return {};
  }

  /// Appends a chunk of `count` elements in its stored form; only the last chunk may have fewer than kChunkEvents.
  Result<void> append_chunk(const std::vector<uint8_t>& bytes, size_t size, uint64_t count, bool is_filtered) {
    const LibraryLock lock;
    const hsize_t start = length_;
    E2LF_RETURN_IF_ERROR(grow(count));
    // A bit that is set means that this filter was not applied.
    const uint32_t filter_mask = is_filtered ? 0 : 1;
    if (H5Dwrite_chunk(dataset_.get(), H5P_DEFAULT, filter_mask, &start, size, bytes.data()) < 0) {
      return write_error(name_);
    }
    return {};
  }

  [[nodiscard]] hid_t id() const { return dataset_.get(); }

 private:
  Result<void> grow(uint64_t count) {
    length_ += count;
    return H5Dset_extent(dataset_.get(), &length_) < 0 ? write_error(name_) : Result<void>();
  }

  Handle dataset_;
  std::string name_;
  hsize_t length_ = 0;
};

/// An index data set, which contains for every 2 ms after the first element the number and time of the first element at
/// or after it.
class TimeIndex {
 public:
  static Result<TimeIndex> create(hid_t group) {
    TimeIndex index;
    E2LF_ASSIGN_OR_RETURN(index.dataset_, GrowingDataset::create(group, "indexes", index_type().get()));
    return index;
  }

  /// Adds elements with these times, in ascending order.
  Result<void> add(std::span<const int64_t> times_us) {
    if (times_us.empty()) return {};
    if (number_ == 0) {
      first_us_ = times_us.front();
      entries_.push_back({0, -1});
    }
    while (times_us.back() - first_us_ >= next_us_) {
      const auto at = std::lower_bound(times_us.begin(), times_us.end(), first_us_ + next_us_);
      const int64_t since_first_us = *at - first_us_;
      if (since_first_us - next_us_ > kMaxPauseUs) {
        return fail(ErrorCode::kInvalidValue, "indexes", "a pause of ", since_first_us - next_us_, " us up to ", *at,
                    " us would make the time index too large; split the recording or write npz");
      }
      entries_.push_back({number_ + static_cast<uint64_t>(at - times_us.begin()), since_first_us});
      next_us_ += kIndexPeriodUs;
      if (entries_.size() >= kChunkEvents) E2LF_RETURN_IF_ERROR(flush());
    }
    number_ += times_us.size();
    return {};
  }

  Result<void> finish() {
    E2LF_RETURN_IF_ERROR(flush());
    if (number_ == 0) return {};
    return write_text_attribute(dataset_.id(), "offset", std::to_string(-first_us_));
  }

 private:
  Result<void> flush() {
    E2LF_RETURN_IF_ERROR(dataset_.append(index_type().get(), entries_.data(), entries_.size()));
    entries_.clear();
    return {};
  }

  GrowingDataset dataset_;
  std::vector<IndexRecord> entries_;
  uint64_t number_ = 0;
  int64_t first_us_ = 0;
  int64_t next_us_ = 0;
};

Result<void> write_header(hid_t file, const RecordingInfo& info) {
  const auto is_ours = [](const std::string& key) { return key == "version" || key == "geometry" || key == "end"; };
  std::vector<std::string> written;
  for (const auto& [key, value] : info.header) {
    if (key.empty() || is_ours(key) || std::find(written.begin(), written.end(), key) != written.end()) continue;
    E2LF_RETURN_IF_ERROR(write_text_attribute(file, key, value));
    written.push_back(key);
  }
  if (info.width != 0 && info.height != 0) {
    E2LF_RETURN_IF_ERROR(write_text_attribute(file, "geometry", cat(info.width, "x", info.height)));
  }
  return write_text_attribute(file, "version", "1.0");
}

class MetavisionWriter final : public RecordingWriter {
 public:
  MetavisionWriter(AtomicFile file, const RecordingInfo& info)
      : file_(std::move(file)),
        check_(info.width, info.height, file_.target().string()),
        has_small_sensor_(info.width != 0 && info.width <= ecf::kMaxCoordinate + 1 && info.height != 0 &&
                          info.height <= ecf::kMaxCoordinate + 1) {}

  Result<void> begin(const RecordingInfo& info) {
    const LibraryLock lock;
    E2LF_ASSIGN_OR_RETURN(hdf5_file_, CheckedFile::create(file_.path(), file_.target().string()));
    E2LF_RETURN_IF_ERROR(write_header(hdf5_file_.get(), info));
    const auto make_group = [&](const char* name) {
      return Handle(H5Gcreate2(hdf5_file_.get(), name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    };
    const Handle cd = make_group("CD"), trigger = make_group("EXT_TRIGGER");
    E2LF_ASSIGN_OR_RETURN(events_, GrowingDataset::create(cd.get(), "events", event_type().get(), kEcfFilter));
    E2LF_ASSIGN_OR_RETURN(triggers_, GrowingDataset::create(trigger.get(), "events", trigger_type().get()));
    E2LF_ASSIGN_OR_RETURN(event_index_, TimeIndex::create(cd.get()));
    E2LF_ASSIGN_OR_RETURN(trigger_index_, TimeIndex::create(trigger.get()));
    return {};
  }

  bool holds_triggers() const override { return true; }

  Result<void> write(const EventBatch& batch) override {
    E2LF_RETURN_IF_ERROR(check_(batch));
    E2LF_RETURN_IF_ERROR(event_index_.add(batch.events.t));
    pending_.append(batch.events);
    if (pending_.size() >= kBlockChunks * kChunkEvents || hdf5_file_.is_behind())
      E2LF_RETURN_IF_ERROR(write_chunks(/*is_last=*/false));

    std::vector<TriggerRecord> records;
    std::vector<int64_t> times_us;
    for (const Trigger& trigger : batch.triggers) {
      times_us.push_back(trigger.t);
      records.push_back({static_cast<int16_t>(trigger.p), trigger.t, static_cast<int16_t>(trigger.id)});
    }
    E2LF_RETURN_IF_ERROR(trigger_index_.add(times_us));
    E2LF_RETURN_IF_ERROR(triggers_.append(trigger_type().get(), records.data(), records.size()));
    const LibraryLock lock;
    if (hdf5_file_.is_behind()) hdf5_file_.keep_up();
    return hdf5_file_.check();
  }

  Result<void> finish() override {
    const LibraryLock lock;
    E2LF_RETURN_IF_ERROR(write_chunks(/*is_last=*/true));
    E2LF_RETURN_IF_ERROR(event_index_.finish());
    E2LF_RETURN_IF_ERROR(trigger_index_.finish());
    // The file is written when the last of its objects is closed.
    events_ = {};
    triggers_ = {};
    event_index_ = {};
    trigger_index_ = {};
    E2LF_RETURN_IF_ERROR(hdf5_file_.close());
    return file_.commit();
  }

 private:
  struct EncodedChunk {
    std::vector<uint8_t> bytes;
    size_t size = 0;
    bool is_filtered = false;
  };

  /// Returns the same as ecf::can_encode() without repeating the checks of the batch.
  bool can_encode(const ecf::ChunkColumns& columns) const {
    if (!has_small_sensor_) return ecf::can_encode(columns);
    return columns.t.front() >= 0 && columns.t.back() < static_cast<int64_t>(ecf::kEndOfTime);
  }

  void encode(const EventColumns& events, size_t begin, size_t end, EncodedChunk& out) const {
    const size_t count = end - begin;
    const auto part = [&](const auto& column) { return std::span(column).subspan(begin, count); };
    const ecf::ChunkColumns columns = {part(events.x), part(events.y), part(events.p), part(events.t)};
    out.is_filtered = can_encode(columns);
    if (out.is_filtered) {
      out.bytes.resize(ecf::max_encoded_size(kChunkEvents));
      out.size = ecf::encode(columns, out.bytes);
      return;
    }
    // Without the filter, a chunk has its full length.
    std::vector<EventRecord> records(kChunkEvents);
    for (size_t i = 0; i < count; ++i) {
      records[i] = {columns.x[i], columns.y[i], static_cast<int16_t>(columns.p[i]), columns.t[i]};
    }
    out.size = records.size() * sizeof(EventRecord);
    const auto* bytes = reinterpret_cast<const uint8_t*>(records.data());
    out.bytes.assign(bytes, bytes + out.size);
  }

  Result<void> write_chunks(bool is_last) {
    const size_t events = is_last ? pending_.size() : pending_.size() / kChunkEvents * kChunkEvents;
    const size_t chunks = (events + kChunkEvents - 1) / kChunkEvents;
    encoded_.resize(std::max(encoded_.size(), chunks));
    const auto end_of = [&](size_t i) { return std::min(events, (i + 1) * kChunkEvents); };
    parallel_for(chunks, 1, [&](size_t from, size_t to) {
      for (size_t i = from; i < to; ++i) encode(pending_, i * kChunkEvents, end_of(i), encoded_[i]);
    });
    for (size_t i = 0; i < chunks; ++i) {
      const EncodedChunk& chunk = encoded_[i];
      E2LF_RETURN_IF_ERROR(
          events_.append_chunk(chunk.bytes, chunk.size, end_of(i) - i * kChunkEvents, chunk.is_filtered));
    }
    // In place, because allocating new columns costs more than encoding.
    pending_.erase(0, events);
    return {};
  }

  AtomicFile file_;
  BatchCheck check_;
  bool has_small_sensor_;
  CheckedFile hdf5_file_;
  GrowingDataset events_, triggers_;
  TimeIndex event_index_, trigger_index_;
  EventColumns pending_;
  std::vector<EncodedChunk> encoded_;
};

}  // namespace

Result<WriterPtr> create_file(const std::filesystem::path& path, const RecordingInfo& info) {
  E2LF_ASSIGN_OR_RETURN(AtomicFile file, AtomicFile::create(path));
  auto writer = std::make_unique<MetavisionWriter>(std::move(file), info);
  E2LF_RETURN_IF_ERROR(writer->begin(info));
  return WriterPtr(std::move(writer));
}

}  // namespace e2lf::recordings::hdf5_events
