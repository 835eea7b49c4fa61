// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <string>
#include <vector>
#include <zlib.h>

#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/capture/measurement/recorded_setup.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"
#include "e2lf/files/zip.h"

namespace e2lf::capture {
namespace fs = std::filesystem;
namespace {

constexpr size_t kHeaderSize = 128;  ///< of the .npy member: its size is known first, its shape last

/// Returns the .npy header with its text padded to a fixed size, as numpy also pads it.
std::vector<uint8_t> npy_header(uint64_t cycles, const EventImages& shape) {
  NpyArray array;
  array.type = "i2";
  array.item_size = 2;
  array.shape = {cycles, shape.count, shape.height, shape.width};
  std::vector<uint8_t> bytes = npy_header_bytes(array);
  E2LF_REQUIRE(bytes.size() <= kHeaderSize && bytes[6] == 1, "an .npy header of version 1 must fit its place");
  bytes.back() = ' ';
  bytes.resize(kHeaderSize, ' ');
  bytes.back() = '\n';
  bytes[8] = kHeaderSize - 10;
  bytes[9] = 0;
  return bytes;
}

/// Returns the header as a separate uncompressed deflate block, so that it can be rewritten when the shape is known.
std::vector<uint8_t> stored_block(const std::vector<uint8_t>& header) {
  std::vector<uint8_t> bytes = {0};  // not the last block, stored
  for (const size_t word : {header.size(), ~header.size()}) {
    bytes.push_back(static_cast<uint8_t>(word));
    bytes.push_back(static_cast<uint8_t>(word >> 8U));
  }
  bytes.insert(bytes.end(), header.begin(), header.end());
  return bytes;
}

class NpzEventImageWriter final : public EventImageWriter {
 public:
  NpzEventImageWriter(AtomicFile file, std::FILE* stream) : file_(std::move(file)), stream_(stream) {}
  NpzEventImageWriter(const NpzEventImageWriter&) = delete;
  NpzEventImageWriter& operator=(const NpzEventImageWriter&) = delete;
  ~NpzEventImageWriter() override {
    if (stream_ != nullptr) std::fclose(stream_);
  }

  void keep(const RecordedSetup& setup) override {
    E2LF_REQUIRE(cycles_ == 0, "the setup must be stored before the first cycle");
    setup_to_arrays(setup, known_);
  }

  Result<void> add(const EventImages& images) override {
    if (cycles_ == 0) {
      shape_.count = images.count;
      shape_.height = images.height;
      shape_.width = images.width;
      E2LF_RETURN_IF_ERROR(begin());
    }
    E2LF_REQUIRE(images.count == shape_.count && images.height == shape_.height && images.width == shape_.width,
                 "all cycles of a file have one shape");
    ++cycles_;
    const auto* bytes = reinterpret_cast<const uint8_t*>(images.values.data());
    // Each cycle reaches the file at once, so that a full disk is found early.
    E2LF_RETURN_IF_ERROR(pack({bytes, images.values.size() * sizeof(int16_t)}, Z_SYNC_FLUSH));
    return std::fflush(stream_) == 0 ? Result<void>() : io_error();
  }

  [[nodiscard]] uint64_t cycles() const override { return cycles_; }

  Result<void> finish(const std::string& findings) override {
    if (cycles_ == 0) {
      return fail(ErrorCode::kInvalidValue, file_.target().string(),
                  "no complete pattern cycle was found; check the schedule and its source");
    }
    E2LF_RETURN_IF_ERROR(pack({}, Z_FINISH));
    const std::vector<uint8_t> header = npy_header(cycles_, shape_);
    const auto header_crc = crc32_z(0, header.data(), header.size());
    events_.crc = static_cast<uint32_t>(crc32_combine(header_crc, data_crc_, static_cast<z_off_t>(events_.size)));
    events_.size += header.size();
    events_.packed += stored_block(header).size();
    const uint64_t offset = archive_.add_written(events_);
    if (!findings.empty()) archive_.add("findings.npy", encode_npy(text_to_npy(findings)), /*compress=*/false);
    E2LF_RETURN_IF_ERROR(write(archive_.finish()));
    if (std::fseek(stream_, static_cast<long>(offset), SEEK_SET) != 0) return io_error();  // NOLINT: C's type
    E2LF_RETURN_IF_ERROR(write(zip::local_header(events_)));
    E2LF_RETURN_IF_ERROR(write(stored_block(header)));
    const int closed = std::fclose(std::exchange(stream_, nullptr));
    if (closed != 0) return io_error();
    return file_.commit();
  }

 private:
  /// Writes the setup and begins the member of the events.
  Result<void> begin() {
    for (const auto& [name, array] : known_) archive_.add(name + ".npy", encode_npy(array), /*compress=*/false);
    E2LF_RETURN_IF_ERROR(write(archive_.take()));
    E2LF_RETURN_IF_ERROR(write(zip::local_header(events_)));
    return write(stored_block(npy_header(0, shape_)));
  }

  Result<void> pack(std::span<const uint8_t> bytes, int flush) {
    // zlib would treat a null pointer as a request for the initial value.
    if (!bytes.empty()) data_crc_ = crc32_z(data_crc_, bytes.data(), bytes.size());
    events_.size += bytes.size();
    return deflater_.add(bytes, flush, [this](std::span<const uint8_t> packed) {
      events_.packed += packed.size();
      return write(packed);
    });
  }

  Result<void> write(std::span<const uint8_t> bytes) {
    // Without bytes, the pointer may be null, which fwrite does not accept.
    if (!bytes.empty() && std::fwrite(bytes.data(), 1, bytes.size(), stream_) != bytes.size()) return io_error();
    return {};
  }

  [[nodiscard]] Error io_error() const { return fail_to("write", file_.target(), errno); }

  AtomicFile file_;
  std::FILE* stream_;
  zip::Deflater deflater_{1};  ///< the fastest level: event images are mostly small numbers, and recordings are long
  EventImages shape_;          ///< without counts
  uint64_t cycles_ = 0;
  uLong data_crc_ = 0;
  zip::Member events_{.name = "events.npy", .method = zip::kDeflated};  ///< with sizes that grow
  NpzArrays known_;                                                     ///< the setup
  ZipWriter archive_;                                                   ///< without the events
};

}  // namespace

Result<std::unique_ptr<EventImageWriter>> EventImageWriter::create(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(AtomicFile file, AtomicFile::create(path));
  std::FILE* stream = std::fopen(file.path().c_str(), "wb");
  if (stream == nullptr) return fail_to("write", path, errno);
  return std::unique_ptr<EventImageWriter>(std::make_unique<NpzEventImageWriter>(std::move(file), stream));
}

Result<void> write_event_images(const fs::path& path, const EventImageFile& file) {
  E2LF_REQUIRE(!file.cycles.empty(), "writing event images needs at least one cycle");
  E2LF_ASSIGN_OR_RETURN(const auto writer, EventImageWriter::create(path));
  writer->keep(file.setup);
  for (const EventImages& cycle : file.cycles) E2LF_RETURN_IF_ERROR(writer->add(cycle));
  return writer->finish();
}

}  // namespace e2lf::capture
