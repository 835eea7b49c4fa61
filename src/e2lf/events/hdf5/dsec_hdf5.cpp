// SPDX-License-Identifier: MIT
#include "e2lf/events/hdf5/dsec_hdf5.h"

#include <algorithm>

#include "e2lf/base/file.h"
#include "e2lf/base/text.h"
#include "e2lf/events/batch_check.h"
#include "e2lf/events/time_search.h"
#include "e2lf/hdf5/checked_file.h"

namespace e2lf::events::hdf5 {
using e2lf::hdf5::CheckedFile;

namespace {

constexpr uint64_t kBlock = uint64_t{1} << 17;
constexpr uint64_t kColumnChunk = uint64_t{1} << 15;

class DsecColumns final : public EventBlocks {
 public:
  static Result<std::unique_ptr<EventBlocks>> open(hid_t file, const std::string& location) {
    auto columns = std::make_unique<DsecColumns>();
    columns->location_ = location + ": events";
    E2LF_ASSIGN_OR_RETURN(columns->x_, open_dataset(file, "events/x", location));
    E2LF_ASSIGN_OR_RETURN(columns->y_, open_dataset(file, "events/y", location));
    E2LF_ASSIGN_OR_RETURN(columns->p_, open_dataset(file, "events/p", location));
    E2LF_ASSIGN_OR_RETURN(columns->t_, open_dataset(file, "events/t", location));
    const uint64_t length = columns->t_.length;
    if (columns->x_.length != length || columns->y_.length != length || columns->p_.length != length) {
      return Error{ErrorCode::kShape, "the columns of events differ in length; the file is damaged", location};
    }
    E2LF_RETURN_IF_ERROR(read_offset(file, location, columns->offset_us_));
    std::unique_ptr<EventBlocks> blocks = std::move(columns);
    return blocks;
  }

  /// A file without t_offset begins at 0.
  static Result<void> read_offset(hid_t file, const std::string& location, int64_t& offset_us) {
    const Handle offset(H5Dopen2(file, "t_offset", H5P_DEFAULT), H5Dclose);
    if (!offset.valid()) return {};
    const std::string place = location + ": t_offset";
    E2LF_ASSIGN_OR_RETURN(const Storage storage, e2lf::hdf5::inspect_storage(offset.get(), place));
    if (storage.claimed_elements() != 1 || !e2lf::hdf5::chunks_are_whole(offset.get(), storage) ||
        H5Dread(offset.get(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &offset_us) < 0 || !is_time(offset_us)) {
      return Error{ErrorCode::kFormat, "not one time in microseconds; the file is damaged", place};
    }
    return {};
  }

  Result<bool> next(EventBatch& block, DecodeSummary&) override {
    const LibraryLock lock;
    block.clear();
    EventColumns& events = block.events;
    const uint64_t count = std::min(kBlock, t_.length - next_);
    events.resize(count);
    if (count == 0) return false;
    const auto read = [&](const DatasetShape& column, hid_t type, void* out) {
      return read_elements(column, type, next_, count, out, location_);
    };
    E2LF_RETURN_IF_ERROR(read(x_, H5T_NATIVE_UINT16, events.x.data()));
    E2LF_RETURN_IF_ERROR(read(y_, H5T_NATIVE_UINT16, events.y.data()));
    E2LF_RETURN_IF_ERROR(read(p_, H5T_NATIVE_UINT8, events.p.data()));
    E2LF_RETURN_IF_ERROR(read(t_, H5T_NATIVE_INT64, events.t.data()));
    for (uint8_t& p : events.p) p = p != 0;
    // A time that is none stays one; the gate drops it.
    for (int64_t& t_us : events.t) t_us = is_time(t_us) ? t_us + offset_us_ : INT64_MAX;
    next_ += count;
    return true;
  }

  Result<void> seek_before(int64_t t_us) override {
    const LibraryLock lock;
    const auto time_at = [&](uint64_t i) -> Result<int64_t> {
      std::vector<int64_t> times_us(std::min<uint64_t>(kTimesPerProbe, t_.length - i));
      E2LF_RETURN_IF_ERROR(read_elements(t_, H5T_NATIVE_INT64, i, times_us.size(), times_us.data(), location_));
      const int64_t since_us = median_time(std::move(times_us));
      return is_time(since_us) ? since_us + offset_us_ : since_us;
    };
    E2LF_ASSIGN_OR_RETURN(next_, find_place_before(t_.length, t_us, time_at));
    return {};
  }

 private:
  DatasetShape x_, y_, p_, t_;
  std::string location_;
  int64_t offset_us_ = 0;
  uint64_t next_ = 0;
};

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
    if (t_.length() == 0) offset_us_ = events.t.front();
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
    return hdf5_file_.check();
  }

  Result<void> finish() override {
    const LibraryLock lock;
    // One more entry, behind the last event, so that every event has a millisecond after it.
    const uint64_t end = t_.length();
    E2LF_RETURN_IF_ERROR(ms_to_idx_.append(H5T_NATIVE_UINT64, &end, 1));
    E2LF_RETURN_IF_ERROR(write_offset());
    for (GrowingDataset* column : {&x_, &y_, &p_, &t_, &ms_to_idx_}) *column = {};
    E2LF_RETURN_IF_ERROR(hdf5_file_.close());
    return file_.commit();
  }

 private:
  Result<void> write_offset() {
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

Result<std::unique_ptr<EventBlocks>> open_dsec(hid_t file, const std::string& location) {
  const LibraryLock lock;
  return DsecColumns::open(file, location);
}

Result<std::unique_ptr<RecordingWriter>> create_dsec_file(const std::filesystem::path& path,
                                                          const RecordingInfo& info) {
  E2LF_ASSIGN_OR_RETURN(AtomicFile file, AtomicFile::create(path));
  auto writer = std::make_unique<DsecWriter>(std::move(file), info);
  E2LF_RETURN_IF_ERROR(writer->begin(info));
  std::unique_ptr<RecordingWriter> result = std::move(writer);
  return result;
}

}  // namespace e2lf::events::hdf5
