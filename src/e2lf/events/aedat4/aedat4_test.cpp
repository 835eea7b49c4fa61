// SPDX-License-Identifier: MIT
#include <algorithm>
#include <gtest/gtest.h>
#include <lz4frame.h>
#include <random>

#include "e2lf/base/file.h"
#include "e2lf/base/text.h"
#include "e2lf/events/aedat4/aedat4_header.h"
#include "e2lf/events/little_endian.h"
#include "e2lf/events/recording.h"
#include "e2lf/events/test_streams.h"
#ifdef E2LF_HAVE_ZSTD
#include <zstd.h>
#endif

namespace e2lf::events::aedat4 {
namespace {

using Bytes = std::vector<uint8_t>;

template <typename T>
void put(Bytes& bytes, T value) {
  bytes.resize(bytes.size() + sizeof(T));
  store_le(bytes.data() + bytes.size() - sizeof(T), value);
}

void put_text(Bytes& bytes, std::string_view text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
}

/// Size prefix, root offset, identifier, vtable of one vector field, table, and the vector's count.
Bytes begin_packet(std::string_view id, uint32_t count) {
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

Bytes event_packet(const EventColumns& events) {
  Bytes bytes = begin_packet("EVTS", static_cast<uint32_t>(events.size()));
  for (size_t i = 0; i < events.size(); ++i) {
    put<int64_t>(bytes, events.t[i]);
    put<uint16_t>(bytes, events.x[i]);
    put<uint16_t>(bytes, events.y[i]);
    put<uint32_t>(bytes, events.p[i]);
  }
  return bytes;
}

/// Triggers as (type of the format, time).
Bytes trigger_packet(const std::vector<std::pair<int8_t, int64_t>>& triggers) {
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

Bytes pack(const Bytes& bytes, Compression compression) {
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

constexpr const char* kXml =
    R"(<dv version="2.0"><node name="outInfo" path="/mainloop/Recorder/outInfo/">
<node name="0" path="/mainloop/Recorder/outInfo/0/"><attr key="typeIdentifier" type="string">EVTS</attr>
<node name="info" path="/mainloop/Recorder/outInfo/0/info/"><attr key="sizeX" type="int">640</attr>
<attr key="sizeY" type="int">480</attr></node></node>
<node name="2" path="/mainloop/Recorder/outInfo/2/"><attr key="typeIdentifier" type="string">IMUS</attr></node>
<node name="3" path="/mainloop/Recorder/outInfo/3/"><attr key="typeIdentifier" type="string">TRIG</attr></node>
</node></dv>)";

Bytes make_file(const std::vector<std::pair<int32_t, Bytes>>& packets, Compression compression) {
  Bytes header;
  put<uint32_t>(header, 20);
  put_text(header, "IOHE");
  for (const uint16_t word : {0, 10, 20, 4, 8, 16}) put(header, word);  // padding; vtable of three fields at 10
  put<int32_t>(header, 10);                                             // table
  put<int32_t>(header, static_cast<int32_t>(compression));
  put<int64_t>(header, -1);
  put<uint32_t>(header, 4);
  put<uint32_t>(header, static_cast<uint32_t>(std::string_view(kXml).size()));
  put_text(header, kXml);

  Bytes file;
  put_text(file, kVersionLine);
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

/// A file of three event packets with triggers between them, and what it holds.
std::pair<Bytes, EventBatch> example(Compression compression) {
  EventBatch all = random_stream({.events = 300, .begin_us = 1'600'000'000'000'000});
  const auto part = [&](size_t begin) {
    EventColumns events;
    events.append(all.events, begin, begin + 100);
    return event_packet(events);
  };
  const int64_t t1 = all.events.t[50], t2 = all.events.t[150];
  all.triggers = {{t1, 0, 1}, {t2, 0, 0}, {t2 + 1, 1, 1}};
  return {make_file({{0, part(0)},
                     {3, trigger_packet({{0, t1 - 5}, {1, t1}, {2, t2}, {4, t2 + 1}, {8, t2 + 2}})},
                     {2, begin_packet("IMUS", 0)},
                     {0, part(100)},
                     {0, part(200)}},
                    compression),
          all};
}

Result<EventBatch> read(const Bytes& bytes, DecodeSummary* summary = nullptr) {
  OpenOptions options;
  options.policy = DecodePolicy::kSkip;
  E2LF_ASSIGN_OR_RETURN(auto reader, open_recording(make_memory_source(std::span<const uint8_t>(bytes)), options));
  E2LF_ASSIGN_OR_RETURN(EventBatch batch, read_all(*reader));
  if (summary != nullptr) *summary = reader->summary();
  return batch;
}

TEST(Aedat4, EventsAndExternalSignalsAreReadForEveryCompression) {
  std::vector<Compression> compressions = {Compression::kNone, Compression::kLz4};
#ifdef E2LF_HAVE_ZSTD
  compressions.push_back(Compression::kZstd);
#endif
  for (const Compression compression : compressions) {
    const auto [bytes, expected] = example(compression);
    DecodeSummary summary;
    auto batch = read(bytes, &summary);
    ASSERT_TRUE(batch.ok()) << batch.error().text();
    EXPECT_EQ(batch->events, expected.events);
    EXPECT_EQ(batch->triggers, expected.triggers);
    EXPECT_EQ(summary.num_violations(), 0u);
  }
}

TEST(Aedat4, UnknownCompressionIsRefused) {
  auto batch = read(make_file({}, static_cast<Compression>(9)));
  ASSERT_FALSE(batch.ok());
  EXPECT_EQ(batch.error().code, ErrorCode::kUnsupported);
}

TEST(Aedat4, EveryTruncationGivesTheEventsBeforeIt) {
  const auto [bytes, expected] = example(Compression::kNone);
  size_t opened = 0;
  for (size_t length = 0; length < bytes.size(); ++length) {
    auto batch = read({bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(length)});
    if (!batch.ok()) continue;
    ++opened;
    const size_t count = batch->events.size();
    EXPECT_EQ(count % 100, 0u) << length;
    EXPECT_TRUE(std::equal(batch->events.t.begin(), batch->events.t.end(), expected.events.t.begin()));
  }
  EXPECT_GT(opened, 4000u);
}

TEST(Aedat4, FlippedBitsNeverTurnTimeBack) {
  std::mt19937 random(5);
  for (const Compression compression : {Compression::kNone, Compression::kLz4}) {
    const Bytes good = example(compression).first;
    for (int trial = 0; trial < 2000; ++trial) {
      Bytes bytes = good;
      bytes[random() % bytes.size()] ^= static_cast<uint8_t>(1u << random() % 8);
      auto batch = read(bytes);
      if (!batch.ok()) continue;
      EXPECT_LE(batch->events.size(), 300u);
      EXPECT_TRUE(std::is_sorted(batch->events.t.begin(), batch->events.t.end()));
    }
  }
}

TEST(Aedat4, PacketThatClaimsTooMuchIsNotAllocated) {
  Bytes bytes = example(Compression::kNone).first;
  put<int32_t>(bytes, 0);
  put<int32_t>(bytes, INT32_MAX);
  DecodeSummary summary;
  auto batch = read(bytes, &summary);
  ASSERT_TRUE(batch.ok());
  EXPECT_EQ(batch->events.size(), 300u);
  EXPECT_EQ(summary.of(Violation::kMisaligned).count, 1u);
}

TEST(Aedat4, DamagedRealFilesAreSurvived) {
  const auto path = data_file("events/other/davis.aedat4");
  E2LF_SKIP_WITHOUT(path);
  auto good = read_file(path);
  ASSERT_TRUE(good.ok());
  std::mt19937 random(9);
  for (int trial = 0; trial < 60; ++trial) {
    Bytes bytes = *good;
    for (int i = 0; i < 20; ++i) bytes[4000 + random() % (bytes.size() - 4000)] ^= static_cast<uint8_t>(random());
    if (trial % 2 == 0) bytes.resize(random() % bytes.size());
    auto batch = read(bytes);
    if (!batch.ok()) continue;
    EXPECT_LE(batch->events.size(), 117667u);
    EXPECT_TRUE(std::is_sorted(batch->events.t.begin(), batch->events.t.end()));
  }
}

}  // namespace
}  // namespace e2lf::events::aedat4
