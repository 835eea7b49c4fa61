// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "e2lf/base/little_endian.h"
#include "e2lf/recordings/event.h"

/// Builds AEDAT 2 and 3 files, for tests and fuzzing.
namespace e2lf::recordings::aedat {

using Bytes = std::vector<uint8_t>;

template <typename T>
void put(Bytes& bytes, T value) {
  bytes.resize(bytes.size() + sizeof(T));
  store_le(bytes.data() + bytes.size() - sizeof(T), value);
}

inline void put_text(Bytes& bytes, std::string_view text) {
  for (const char character : text) bytes.push_back(static_cast<uint8_t>(character));
}

/// Makes a file from records of an address and a time.
inline Bytes aedat2_file(std::string_view header, const std::vector<std::pair<uint32_t, uint32_t>>& records) {
  Bytes bytes;
  put_text(bytes, "#!AER-DAT2.0\r\n# This is a raw AE data file - do not edit\r\n");
  put_text(bytes, header);
  for (const auto& [address, t_us] : records) {
    put(bytes, __builtin_bswap32(address));
    put(bytes, __builtin_bswap32(t_us));
  }
  return bytes;
}

inline Bytes packet_header(int16_t type, int16_t source, int32_t overflow, size_t count) {
  Bytes bytes;
  put(bytes, type);
  put(bytes, source);
  const auto number = static_cast<int32_t>(count);
  for (const int32_t word : {8, 4, overflow, number, number, number}) put(bytes, word);
  return bytes;
}

/// Makes a packet of events, whose times are stored as their lower 31 bits.
inline Bytes polarity_packet(int16_t source, int32_t overflow, const std::vector<Event>& events) {
  Bytes bytes = packet_header(1, source, overflow, events.size());
  for (const Event& event : events) {
    put<uint32_t>(bytes, uint32_t{event.x} << 17 | uint32_t{event.y} << 2 | uint32_t{event.p} << 1 | 1U);
    put<int32_t>(bytes, static_cast<int32_t>(event.t));
  }
  return bytes;
}

/// Makes a packet of special events, given as (type, time).
inline Bytes special_packet(int16_t source, int32_t overflow, const std::vector<std::pair<uint32_t, int32_t>>& events) {
  Bytes bytes = packet_header(0, source, overflow, events.size());
  for (const auto& [type, t_us] : events) {
    put<uint32_t>(bytes, type << 1 | 1U);
    put(bytes, t_us);
  }
  return bytes;
}

inline Bytes aedat3_file(std::string_view sources, const std::vector<Bytes>& packets) {
  Bytes bytes;
  put_text(bytes, "#!AER-DAT3.1\r\n#Format: RAW\r\n");
  put_text(bytes, sources);
  put_text(bytes, "#Start-Time: 2016-05-03 12:00:00 (TZ+0200)\r\n#!END-HEADER\r\n");
  for (const Bytes& packet : packets) bytes.insert(bytes.end(), packet.begin(), packet.end());
  return bytes;
}

}  // namespace e2lf::recordings::aedat
