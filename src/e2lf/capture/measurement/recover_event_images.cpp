// SPDX-License-Identifier: MIT
// Recovers the complete cycles of an unfinished file; declared in event_image_writer.h.
#include <algorithm>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>
#include <zlib.h>

#include "e2lf/base/little_endian.h"
#include "e2lf/capture/measurement/event_image_writer.h"
#include "e2lf/files/npy_header.h"
#include "e2lf/files/zip_format.h"

namespace e2lf::capture {
namespace fs = std::filesystem;
namespace {

constexpr uint64_t kMostKnownBytes = uint64_t{1} << 24;
constexpr uint64_t kMostCycleBytes = uint64_t{1} << 32;  ///< of a cycle; a larger value is damage

/// Reads a file of event images from its start, without its directory.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(const fs::path& path) : file_(path, std::ios::binary) {}
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;
  ~UnfinishedFile() { inflateEnd(&inflate_); }

  /// Reads codes, camera and views, if there are any, and the shape of the events. Returns false if the file ends
  /// before.
  bool open() {
    Member member = begin_member();
    for (; is_known(member.name); member = begin_member()) {
      if (!read_known(member)) return false;
    }
    if (member.name != "events.npy" || inflateInit2(&inflate_, -MAX_WBITS) != Z_OK) return false;
    // The header contains its length.
    std::vector<uint8_t> head(10);
    if (!unpack(head)) return false;
    std::vector<uint8_t> rest(load_le<uint16_t>(&head[8]));
    if (!unpack(rest)) return false;
    head.insert(head.end(), rest.begin(), rest.end());
    const auto header = parse_npy_header(head, "events.npy");
    if (!header || header->array.shape.size() != 4) return false;
    const auto& shape = header->array.shape;
    if (shape[1] == 0 || shape[2] == 0 || shape[3] == 0 || shape[1] > 64 || shape[2] > 65535 || shape[3] > 65535 ||
        2 * shape[1] * shape[2] * shape[3] > kMostCycleBytes) {
      return false;
    }
    images_ = EventImages(shape[1], shape[2], shape[3]);
    return true;
  }

  [[nodiscard]] const NpzArrays& known() const { return known_; }

  /// Returns the next complete cycle, or null.
  const EventImages* next() {
    std::vector<uint8_t> bytes(images_.values.size() * sizeof(int16_t));
    if (!unpack(bytes)) return nullptr;
    std::memcpy(images_.values.data(), bytes.data(), bytes.size());
    return &images_;
  }

 private:
  struct Member {
    std::string name;   ///< empty = no member begins here
    uint64_t size = 0;  ///< 0 = unknown
  };

  static bool is_known(const std::string& name) {
    return name == "codes.npy" || name == "camera.npy" || name == "views.npy";
  }

  bool read_known(const Member& member) {
    std::vector<uint8_t> bytes(std::min(member.size, kMostKnownBytes));
    if (!read(bytes)) return false;
    auto array = decode_npy(bytes, member.name);
    if (!array) return false;
    known_[fs::path(member.name).stem().string()] = *std::move(array);
    return true;
  }

  bool read(std::vector<uint8_t>& bytes) {
    return static_cast<bool>(
        file_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size())));
  }

  /// Reads the header of the member that begins here.
  Member begin_member() {
    std::vector<uint8_t> head(zip::kLocalHeaderSize);
    if (!read(head) || load_le<uint32_t>(head.data()) != zip::kLocalHeader) return {};
    std::vector<uint8_t> name(load_le<uint16_t>(&head[26])), extra(load_le<uint16_t>(&head[28]));
    if (!read(name) || !read(extra)) return {};
    const bool has_size = extra.size() >= 12 && load_le<uint16_t>(extra.data()) == zip::kExtra64;
    return {{name.begin(), name.end()}, has_size ? load_le<uint64_t>(&extra[4]) : 0};
  }

  /// Fills `bytes` from the compressed member; returns false if it ends before.
  bool unpack(std::vector<uint8_t>& bytes) {
    inflate_.next_out = bytes.data();
    inflate_.avail_out = static_cast<uInt>(bytes.size());
    while (inflate_.avail_out > 0) {
      if (inflate_.avail_in == 0) {
        input_.resize(size_t{1} << 18);
        file_.read(reinterpret_cast<char*>(input_.data()), static_cast<std::streamsize>(input_.size()));
        inflate_.next_in = input_.data();
        inflate_.avail_in = static_cast<uInt>(file_.gcount());
        if (inflate_.avail_in == 0) return false;
      }
      const int status = inflate(&inflate_, Z_NO_FLUSH);
      if (status == Z_STREAM_END) return inflate_.avail_out == 0;
      if (status != Z_OK && status != Z_BUF_ERROR) return false;
    }
    return true;
  }

  std::ifstream file_;
  z_stream inflate_{};
  std::vector<uint8_t> input_;
  NpzArrays known_;
  EventImages images_;
};

}  // namespace

Result<uint64_t> recover_event_images(const fs::path& unfinished, const fs::path& path) {
  UnfinishedFile file(unfinished);
  if (!file.open()) {
    return Error{ErrorCode::kFormat, "the file contains no cycles of event images; nothing can be recovered",
                 unfinished.string()};
  }
  E2LF_ASSIGN_OR_RETURN(EventImageWriter writer, EventImageWriter::create(path));
  E2LF_ASSIGN_OR_RETURN(const RecordedSetup setup, setup_from_arrays(file.known(), unfinished.string()));
  writer.keep(setup);
  while (const EventImages* images = file.next()) E2LF_RETURN_IF_ERROR(writer.add(*images));
  const uint64_t cycles = writer.cycles();
  if (cycles > 0) E2LF_RETURN_IF_ERROR(writer.finish());
  return cycles;
}

}  // namespace e2lf::capture
