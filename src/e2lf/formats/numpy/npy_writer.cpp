// SPDX-License-Identifier: MIT
// Writes events to .npy files; declared in codecs.h.
#include <cstddef>
#include <fstream>

#include "e2lf/files/file.h"
#include "e2lf/files/npy_header.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/recordings/batch_check.h"

namespace e2lf::recordings::numpy {
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

}  // namespace e2lf::recordings::numpy
