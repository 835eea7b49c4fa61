// SPDX-License-Identifier: MIT
// Reads and writes .npz archives; declared in npy.h.
#include "e2lf/base/log.h"
#include "e2lf/base/memory.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"
#include "e2lf/files/zip.h"

namespace e2lf {
namespace {

constexpr std::string_view kSuffix = ".npy";

/// Rejects a member whose numpy header does not agree with the size in its directory entry, before it is unpacked.
Result<void> check_head(std::span<const uint8_t> head, uint64_t claimed, const std::string& location) {
  const Result<NpyHeader> header = parse_npy_header(head, location);
  if (!header) {
    const bool longer_header = header.error().code == ErrorCode::kTruncated && head.size() < claimed;
    return longer_header ? Result<void>() : Result<void>(header.error());
  }
  const uint64_t needed = header->data_size + header->data_offset;
  if (needed == claimed) return {};
  return Error{needed > claimed ? ErrorCode::kTruncated : ErrorCode::kFormat,
               cat("the numpy header needs ", needed, " bytes, the archive states ", claimed, "; write the file again"),
               location};
}

/// Collects every member that is an array, made by `read` from its entry and location. Text and objects beside other
/// arrays are passed over.
template <typename Read>
Result<NpzArrays> arrays_of(std::span<const uint8_t> bytes, const std::string& name, const Read& read) {
  E2LF_ASSIGN_OR_RETURN(const std::vector<ZipEntry> entries, read_zip_directory(bytes, name));
  NpzArrays arrays;
  Result<void> passed_over;
  for (const ZipEntry& entry : entries) {
    if (!entry.name.ends_with(kSuffix)) continue;
    Result<NpyArray> array = read(entry, cat(name, ": ", entry.name));
    if (!array && array.error().code != ErrorCode::kUnsupported) return array.error();
    if (!array) {
      if (passed_over) passed_over = array.error();
      continue;
    }
    arrays.emplace(entry.name.substr(0, entry.name.size() - kSuffix.size()), *std::move(array));
  }
  if (arrays.empty() && !passed_over) return passed_over.error();
  return arrays;
}

/// Decodes the complete items along the first axis of an array whose writer was interrupted.
Result<NpyArray> decode_unfinished(const ZipEntry& entry, const std::string& location) {
  E2LF_ASSIGN_OR_RETURN(std::vector<uint8_t> bytes, unpack_zip_entry(entry, location));
  E2LF_ASSIGN_OR_RETURN(NpyHeader header, parse_npy_header(bytes, location));
  NpyArray array = std::move(header.array);
  if (array.shape.empty()) return fail(ErrorCode::kTruncated, location, "the file is unfinished; write it again");
  array.shape[0] = 1;
  const size_t item = array.num_elements() * array.item_size, stored = bytes.size() - header.data_offset;
  array.shape[0] = item == 0 ? 0 : stored / item;
  if (array.shape[0] == 0) {
    return fail(ErrorCode::kTruncated, location,
                "the file is unfinished and contains no complete item; write it again");
  }
  const auto begin = bytes.begin() + static_cast<ptrdiff_t>(header.data_offset);
  array.bytes.assign(begin, begin + static_cast<ptrdiff_t>(array.shape[0] * item));
  log_warning(cat(location, ": the file is unfinished; the ", array.shape[0], " complete items in it are read"));
  return array;
}

Result<NpyArray> decode_member(const ZipEntry& entry, const std::string& location) {
  if (entry.is_unfinished) return decode_unfinished(entry, location);
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> head, unpack_zip_entry(entry, location, kNpyHeadBytes));
  E2LF_RETURN_IF_ERROR(check_head(head, entry.size, location));
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> member, unpack_zip_entry(entry, location));
  return decode_npy(member, location);
}

Result<NpyArray> peek_member(const ZipEntry& entry, const std::string& location) {
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> head, unpack_zip_entry(entry, location, kNpyHeadBytes));
  E2LF_ASSIGN_OR_RETURN(NpyHeader header, parse_npy_header(head, location));
  return std::move(header.array);
}

/// Reads a file if there is enough memory for it.
Result<std::vector<uint8_t>> read_archive(const std::filesystem::path& path) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);
  if (!error) {
    E2LF_RETURN_IF_ERROR(require_memory(
        bytes, "an .npz file is read as a whole: store the events as .npy, .csv or .hdf5, or in parts", path.string()));
  }
  return read_file(path);
}

}  // namespace

Result<NpzArrays> decode_npz(std::span<const uint8_t> bytes, const std::string& name) {
  return arrays_of(bytes, name, decode_member);
}

std::vector<uint8_t> encode_npz(const NpzArrays& arrays, bool compress) {
  ZipWriter writer;
  for (const auto& [name, array] : arrays) writer.add(name + std::string(kSuffix), encode_npy(array), compress);
  return writer.finish();
}

Result<NpzArrays> read_npz(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_archive(path));
  return decode_npz(bytes, path.string());
}

Result<NpzArrays> peek_npz(std::span<const uint8_t> bytes, const std::string& name) {
  return arrays_of(bytes, name, peek_member);
}

Result<NpzArrays> peek_npz(const std::filesystem::path& path) {
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_archive(path));
  return peek_npz(bytes, path.string());
}

Result<void> write_npz(const std::filesystem::path& path, const NpzArrays& arrays, bool compress) {
  return write_file(path, encode_npz(arrays, compress));
}

}  // namespace e2lf
