// SPDX-License-Identifier: MIT
#pragma once

#include <lz4frame.h>
#include <string_view>
#include <utility>
#include <vector>

#include "e2lf/base/little_endian.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/recordings/io/decompress.h"
#ifdef E2LF_HAVE_ZSTD
#include <zstd.h>
#endif

/// Builds AEDAT 4 files, for tests and fuzzing.
namespace e2lf::formats::aedat4 {

using recordings::Compression;
using Bytes = std::vector<uint8_t>;

template <typename T>
void put(Bytes& bytes, T value) {
  bytes.resize(bytes.size() + sizeof(T));
  store_le(bytes.data() + bytes.size() - sizeof(T), value);
}

inline void put_text(Bytes& bytes, std::string_view text) {
  // A loop, because GCC 12 misreads an insert.
  for (const char character : text) bytes.push_back(static_cast<uint8_t>(character));
}

/// Writes the size prefix, root offset, identifier, vtable of one vector field, table, and the count of the vector.
inline Bytes begin_packet(std::string_view id, uint32_t count) {
  Bytes bytes;
  put<uint32_t>(bytes, 0);
  put<uint32_t>(bytes, 16);
  put_text(bytes, id);
  for (const uint16_t word : {0, 6, 8, 4}) put(bytes, word);
  put<int32_t>(bytes, 6);
  put<uint32_t>(bytes, 4);
  put(bytes, count);
  return bytes;
}

inline Bytes event_packet(const EventColumns& events) {
  Bytes bytes = begin_packet("EVTS", static_cast<uint32_t>(events.size()));
  for (size_t i = 0; i < events.size(); ++i) {
    put<int64_t>(bytes, events.t[i]);
    put<uint16_t>(bytes, events.x[i]);
    put<uint16_t>(bytes, events.y[i]);
    put<uint32_t>(bytes, events.p[i]);
  }
  return bytes;
}

/// Makes a packet of triggers, given as (type of the format, time).
inline Bytes trigger_packet(const std::vector<std::pair<int8_t, int64_t>>& triggers) {
  Bytes bytes = begin_packet("TRIG", static_cast<uint32_t>(triggers.size()));
  const size_t vector = bytes.size();
  bytes.resize(vector + 4 * triggers.size());
  for (size_t i = 0; i < triggers.size(); ++i) {
    for (const uint16_t word : {8, 16, 8, 7}) put(bytes, word);  // vtable: time at 8, type at 7
    const size_t table = bytes.size();
    put<int32_t>(bytes, 8);
    put<uint32_t>(bytes, static_cast<uint32_t>(static_cast<uint8_t>(triggers[i].first)) << 24);
    put<int64_t>(bytes, triggers[i].second);
    store_le(&bytes[vector + 4 * i], static_cast<uint32_t>(table - (vector + 4 * i)));
  }
  return bytes;
}

inline Bytes pack(const Bytes& bytes, Compression compression) {
  Bytes packed = bytes;
  if (compression == Compression::kLz4) {
    packed.resize(LZ4F_compressFrameBound(bytes.size(), nullptr));
    packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr));
  }
#ifdef E2LF_HAVE_ZSTD
  if (compression == Compression::kZstd) {
    packed.resize(ZSTD_compressBound(bytes.size()));
    packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 3));
  }
#endif
  return packed;
}

inline constexpr const char* kXml =
    R"(<dv version="2.0"><node name="outInfo" path="/mainloop/Recorder/outInfo/">
<node name="0" path="/mainloop/Recorder/outInfo/0/"><attr key="typeIdentifier" type="string">EVTS</attr>
<node name="info" path="/mainloop/Recorder/outInfo/0/info/"><attr key="sizeX" type="int">640</attr>
<attr key="sizeY" type="int">480</attr></node></node>
<node name="2" path="/mainloop/Recorder/outInfo/2/"><attr key="typeIdentifier" type="string">IMUS</attr></node>
<node name="3" path="/mainloop/Recorder/outInfo/3/"><attr key="typeIdentifier" type="string">TRIG</attr></node>
</node></dv>)";

/// Describes events 0 and triggers 3 of one camera, and events 4 and triggers 5 of another.
inline constexpr const char* kTwoCameras =
    R"(<dv version="2.0"><node name="outInfo" path="/mainloop/Recorder/outInfo/">
<node name="0" path="/mainloop/Recorder/outInfo/0/"><attr key="typeIdentifier" type="string">EVTS</attr>
<attr key="originalOutputName" type="string">events</attr>
<node name="info" path="/mainloop/Recorder/outInfo/0/info/"><attr key="sizeX" type="int">346</attr>
<attr key="sizeY" type="int">260</attr><attr key="source" type="string">DAVIS346_1</attr></node></node>
<node name="3" path="/mainloop/Recorder/outInfo/3/"><attr key="typeIdentifier" type="string">TRIG</attr>
<node name="info" path="/mainloop/Recorder/outInfo/3/info/"><attr key="source" type="string">DAVIS346_1</attr></node></node>
<node name="4" path="/mainloop/Recorder/outInfo/4/"><attr key="typeIdentifier" type="string">EVTS</attr>
<attr key="originalOutputName" type="string">events</attr>
<node name="info" path="/mainloop/Recorder/outInfo/4/info/"><attr key="sizeX" type="int">640</attr>
<attr key="sizeY" type="int">480</attr><attr key="source" type="string">DVXplorer_2</attr></node></node>
<node name="5" path="/mainloop/Recorder/outInfo/5/"><attr key="typeIdentifier" type="string">TRIG</attr>
<node name="info" path="/mainloop/Recorder/outInfo/5/info/"><attr key="source" type="string">DVXplorer_2</attr></node></node>
</node></dv>)";

inline Bytes make_file(const std::vector<std::pair<int32_t, Bytes>>& packets, Compression compression,
                       std::string_view xml = kXml) {
  Bytes header;
  put<uint32_t>(header, 20);
  put_text(header, "IOHE");
  for (const uint16_t word : {0, 10, 20, 4, 8, 16}) put(header, word);  // padding; vtable of three fields at 10
  put<int32_t>(header, 10);                                             // table
  put<int32_t>(header, static_cast<int32_t>(compression));
  put<int64_t>(header, -1);
  put<uint32_t>(header, 4);
  put<uint32_t>(header, static_cast<uint32_t>(xml.size()));
  put_text(header, xml);

  Bytes file;
  put_text(file, "#!AER-DAT4.0\r\n");
  put<uint32_t>(file, static_cast<uint32_t>(header.size()));
  file.insert(file.end(), header.begin(), header.end());
  for (const auto& [id, contents] : packets) {
    const Bytes packed = pack(contents, compression);
    put(file, id);
    put<int32_t>(file, static_cast<int32_t>(packed.size()));
    file.insert(file.end(), packed.begin(), packed.end());
  }
  return file;
}

}  // namespace e2lf::formats::aedat4
