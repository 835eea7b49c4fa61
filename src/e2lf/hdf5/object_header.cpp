// SPDX-License-Identifier: MIT
#include "e2lf/hdf5/object_header.h"

#include <cstring>

namespace e2lf::hdf5 {
namespace {

using Bytes = std::span<const uint8_t>;

constexpr uint16_t kLayoutMessage = 8;
constexpr uint8_t kChunked = 2;

size_t u16(Bytes bytes, size_t at) {
  return static_cast<size_t>(bytes[at] | (bytes[at + 1] << 8));
}

bool layout_is_usable(Bytes layout) {
  if (layout.size() < 4) return true;
  switch (layout[0]) {
    case 1:
    case 2:
      return layout[2] != kChunked || layout[1] > 0;
    case 3:
      return layout[1] != kChunked || layout[2] > 0;
    case 4:
      return layout[1] != kChunked || layout[3] > 0;
    default:
      return true;
  }
}

/// Checks messages of version 1: type and size (2 bytes each), flags, three reserved bytes, then the data, in multiples
/// of eight bytes.
bool v1_layouts_are_usable(Bytes messages) {
  constexpr size_t kHead = 8;
  while (messages.size() >= kHead) {
    const size_t type = u16(messages, 0), size = u16(messages, 2);
    if (size % 8 != 0 || size > messages.size() - kHead) break;
    if (type == kLayoutMessage && !layout_is_usable(messages.subspan(kHead, size))) return false;
    messages = messages.subspan(kHead + size);
  }
  return true;
}

/// Checks messages of version 2: type, size (2 bytes), flags and, in some headers, 2 more bytes.
bool v2_layouts_are_usable(Bytes messages, size_t head) {
  while (messages.size() >= head) {
    const size_t type = messages[0], size = u16(messages, 1);
    if (size > messages.size() - head) break;
    if (type == kLayoutMessage && !layout_is_usable(messages.subspan(head, size))) return false;
    messages = messages.subspan(head + size);
  }
  return true;
}

bool begins_with(Bytes piece, const char (&signature)[5]) {
  return piece.size() >= 4 && std::memcmp(piece.data(), signature, 4) == 0;
}

/// Returns the offset of the messages in a version 2 header, after signature, version, flags, times, limits and size.
size_t v2_prefix(Bytes piece) {
  if (piece.size() < 6) return piece.size();
  const unsigned flags = piece[5];
  return 6 + ((flags & 0x20) != 0 ? 16 : 0) + ((flags & 0x10) != 0 ? 4 : 0) + (size_t{1} << (flags & 3));
}

Bytes after(Bytes piece, size_t count) {
  return count < piece.size() ? piece.subspan(count) : Bytes{};
}

}  // namespace

bool chunks_have_dimensions(Bytes piece) {
  if (begins_with(piece, "OHDR") || begins_with(piece, "OCHK")) {
    const auto messages = after(piece, piece[1] == 'H' ? v2_prefix(piece) : 4);
    // A continuation does not state how long the heads of its messages are, so both lengths are tried.
    return v2_layouts_are_usable(messages, 4) && v2_layouts_are_usable(messages, 6);
  }
  // A piece of version 1 does not state whether it begins with the prefix of 16 bytes, so both cases are tried.
  return v1_layouts_are_usable(piece) && v1_layouts_are_usable(after(piece, 16));
}

}  // namespace e2lf::hdf5
