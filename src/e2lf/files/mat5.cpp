// SPDX-License-Identifier: MIT
#include "e2lf/files/mat5.h"

#include <algorithm>
#include <zlib.h>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"

namespace e2lf {
namespace {

constexpr size_t kHeaderBytes = 128;
constexpr size_t kByteOrderAt = 126;
constexpr size_t kTagBytes = 8;
constexpr uint32_t kMatrix = 14;
constexpr uint32_t kCompressed = 15;
// This is enough of a variable for its type, its extents and a name of 63 letters.
constexpr size_t kPreviewBytes = 1024;
// The limit keeps the list of the variables of a huge file short.
constexpr size_t kMostOthers = 1000;

/// A data element: a tag (type and size) and the data that it describes.
struct Element {
  uint32_t type = 0;
  size_t size = 0;                ///< as the tag states
  std::span<const uint8_t> data;  ///< shorter than `size` if the bytes end early
};

/// Removes the next element from the front of `rest`, or returns nothing if not even a tag is left. A small element
/// keeps its data, up to four bytes, in its tag ("Small Data Element Format"). All elements except compressed ones are
/// padded to eight bytes.
std::optional<Element> take_element(std::span<const uint8_t>& rest) {
  if (rest.size() < kTagBytes) return std::nullopt;
  const uint32_t word = load_le<uint32_t>(rest.data());
  if (word >> 16 != 0) {
    const size_t size = word >> 16;
    const Element element{word & 0xFFFF, size, rest.subspan(4, std::min<size_t>(size, 4))};
    rest = rest.subspan(kTagBytes);
    return element;
  }
  Element element{word, load_le<uint32_t>(rest.data() + 4), {}};
  rest = rest.subspan(kTagBytes);
  element.data = rest.first(std::min(element.size, rest.size()));
  const size_t padded = word == kCompressed ? element.size : (element.size + 7) / 8 * 8;
  rest = rest.subspan(std::min(padded, rest.size()));
  return element;
}

bool is_whole(const std::optional<Element>& element) {
  return element && element->data.size() == element->size;
}

/// Inflates up to out.size() bytes, whose number is returned in `size`. Returns what zlib does: Z_OK for a stream that
/// ends there and has the right checksum, and Z_BUF_ERROR for a longer one.
int inflate_some(std::span<const uint8_t> in, std::span<uint8_t> out, uLongf& size) {
  size = out.size();
  return uncompress(out.data(), &size, in.data(), in.size());
}

/// Returns the content of an element, of which a compressed one only has the first bytes, inflated into `preview`. It
/// is empty if that is damaged.
std::span<const uint8_t> content_of(const Element& element, std::vector<uint8_t>& preview) {
  if (element.type != kCompressed) return element.data;
  preview.resize(kPreviewBytes);
  uLongf size = 0;
  const int status = inflate_some(element.data, preview, size);
  preview.resize(status == Z_OK || status == Z_BUF_ERROR ? size : 0);
  return std::span(preview).subspan(std::min(preview.size(), kTagBytes));
}

/// The numpy codes of numbers by their type and by their class, and "" for other types and classes.
constexpr const char* kTypeCodes[] = {"", "i1", "u1", "i2", "u2", "i4", "u4", "f4", "", "f8"};
constexpr const char* kClassCodes[] = {"", "", "", "", "", "", "f8", "f4", "i1", "u1", "i2", "u2", "i4", "u4"};

std::string code_of(std::span<const char* const> codes, uint32_t number) {
  return number < codes.size() ? codes[number] : "";
}

/// Reads the parts of a matrix element that precede its samples, and leaves `rest` at those. Returns nothing if they
/// are damaged.
std::optional<MatArray> take_head(std::span<const uint8_t>& rest) {
  MatArray head;
  const auto flags = take_element(rest);
  if (!is_whole(flags) || flags->data.size() < 4) return std::nullopt;
  const uint32_t word = load_le<uint32_t>(flags->data.data());
  head.class_type = code_of(kClassCodes, word & 0xFF);
  head.complex = (word & 0x800) != 0;
  head.logical = (word & 0x200) != 0;
  const auto extents = take_element(rest);
  if (!is_whole(extents) || extents->size % 4 != 0) return std::nullopt;
  for (size_t i = 0; i < extents->size; i += 4) head.extents.push_back(load_le<uint32_t>(extents->data.data() + i));
  const auto name = take_element(rest);
  if (!is_whole(name)) return std::nullopt;
  head.name.assign(name->data.begin(), name->data.end());
  return head;
}

Error truncated(const std::string& location) {
  return fail(ErrorCode::kTruncated, location, "the MATLAB file ends before its data does; copy it again");
}

Error damaged(const std::string& location) {
  return fail(ErrorCode::kFormat, location, "the MATLAB file is damaged; copy or save it again");
}

/// Inflates a whole variable, whose length is stated by the tag at the front of `preview`.
Result<std::vector<uint8_t>> inflate_variable(const Element& element, std::span<const uint8_t> preview,
                                              uint64_t max_bytes, const std::string& location) {
  const uint64_t size = kTagBytes + uint64_t{load_le<uint32_t>(preview.data() + 4)};
  // Deflate cannot compress by more than a factor of 1032.
  if (size / 1032 > element.size) return damaged(location);
  // The limit leaves some room for the head around the samples, whose size the caller checks as well. zlib counts in 32
  // bits.
  if (size > max_bytes + kPreviewBytes || size > UINT32_MAX) {
    return fail(ErrorCode::kUnsupported, location, "inflates to ", size,
                " bytes, more than the limit; raise the limit");
  }
  std::vector<uint8_t> bytes(size);
  uLongf inflated = 0;
  if (inflate_some(element.data, bytes, inflated) != Z_OK || inflated != size) return damaged(location);
  return bytes;
}

/// Reads the samples of the matrix, which follow its head.
Result<MatArray> finish_array(MatArray array, std::span<const uint8_t> rest, const std::string& location) {
  const auto samples = take_element(rest);
  if (!is_whole(samples)) return truncated(location);
  array.type = code_of(kTypeCodes, samples->type);
  array.data = samples->data;
  return array;
}

Result<MatArray> open_compressed(const Element& element, std::span<const uint8_t> preview, uint64_t max_bytes,
                                 const std::string& location) {
  E2LF_ASSIGN_OR_RETURN(std::vector<uint8_t> inflated, inflate_variable(element, preview, max_bytes, location));
  std::span<const uint8_t> rest = std::span(inflated).subspan(kTagBytes);
  auto head = take_head(rest);
  if (!head) return damaged(location);
  E2LF_ASSIGN_OR_RETURN(MatArray array, finish_array(*std::move(head), rest, location));
  array.inflated = std::move(inflated);
  return array;
}

}  // namespace

Result<MatArray> find_mat_array(std::span<const uint8_t> bytes, const std::string& name, uint64_t max_bytes,
                                const std::string& location, std::vector<std::string>& others) {
  if (bytes.size() < kHeaderBytes) return truncated(location);
  if (bytes[kByteOrderAt] != 'I') {
    return fail(ErrorCode::kUnsupported, location, "a big-endian MATLAB file; save it on a little-endian machine");
  }
  std::span<const uint8_t> rest = bytes.subspan(kHeaderBytes);
  while (!rest.empty()) {
    const auto element = take_element(rest);
    if (!is_whole(element)) return truncated(location);
    if (element->type != kMatrix && element->type != kCompressed) continue;
    std::vector<uint8_t> preview;
    std::span<const uint8_t> inside = content_of(*element, preview);
    auto head = take_head(inside);
    if (!head) return damaged(location);
    if (head->name != name) {
      if (others.size() < kMostOthers) others.push_back(head->name);
      continue;
    }
    if (element->type == kCompressed) return open_compressed(*element, preview, max_bytes, location);
    return finish_array(*std::move(head), inside, location);
  }
  return fail(ErrorCode::kNotFound, location, "the MATLAB file has no variable ", name,
              "; save the array under that name");
}

}  // namespace e2lf
