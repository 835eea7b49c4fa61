// SPDX-License-Identifier: MIT
#include "e2lf/recordings/io/unpacked_source.h"

#include <gtest/gtest.h>

#include "e2lf/files/file.h"
#include "e2lf/recordings/recording.h"
#include "testing/chunked_source.h"
#include "testing/test_gzip.h"
#include "testing/test_streams.h"
#ifdef E2LF_HAVE_ZSTD
#include <zstd.h>
#endif

namespace e2lf::recordings {
namespace {

using Bytes = std::vector<uint8_t>;

using Pack = Bytes (*)(const Bytes&);
std::vector<Pack> packs() {
  std::vector<Pack> all = {gzip};
#ifdef E2LF_HAVE_ZSTD
  all.push_back([](const Bytes& bytes) {
    Bytes packed(ZSTD_compressBound(bytes.size()));
    packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 3));
    return packed;
  });
#endif
  return all;
}

Bytes written(const EventBatch& events, const std::string& format) {
  Bytes bytes;
  auto writer =
      create_recording(make_memory_sink(bytes), format, {.format = format, .width = 640, .height = 480, .header = {}});
  EXPECT_TRUE((*writer)->write(events).ok());
  EXPECT_TRUE((*writer)->finish().ok());
  return bytes;
}

struct Read {
  EventBatch batch;
  DecodeSummary summary;
};

Read read(std::unique_ptr<ByteSource> source) {
  auto reader = open_recording(std::move(source), {.policy = DecodePolicy::kSkip});
  EXPECT_TRUE(reader.ok()) << reader.error().text();
  if (!reader) return {};
  auto batch = read_all(**reader);
  EXPECT_TRUE(batch.ok()) << batch.error().text();
  return {batch.ok() ? *batch : EventBatch(), (*reader)->summary()};
}

TEST(Unpacked, RecordingsOfEveryFormatAreReadFromMemoryAndPipes) {
  const EventBatch events = random_stream({.events = 200'000, .width = 640, .height = 480});
  for (const Pack pack : packs()) {
    for (const char* format : {"evt3", "evt2", "dat", "csv", "npz"}) {
      const Bytes packed = pack(written(events, format));
      const Read plain = read(make_memory_source(std::span<const uint8_t>(packed)));
      EXPECT_EQ(plain.batch.events, events.events) << format;
      EXPECT_TRUE(losses(plain.summary).empty()) << format;
      EXPECT_EQ(read(std::make_unique<ChunkedSource>(packed, std::vector<size_t>(), 1000)).batch.events, events.events)
          << format;
    }
  }
}

TEST(Unpacked, SeveralPartsAndPaddingAreReadToTheEnd) {
  const Bytes raw = written(random_stream({.events = 3000, .width = 640, .height = 480}), "csv");
  const auto middle = raw.begin() + static_cast<ptrdiff_t>(raw.size() / 2);
  for (const Pack pack : packs()) {
    Bytes packed = pack({raw.begin(), middle});
    const Bytes second = pack({middle, raw.end()});
    packed.insert(packed.end(), second.begin(), second.end());
    packed.resize(packed.size() + 512);
    const Read all = read(make_memory_source(std::span<const uint8_t>(packed)));
    EXPECT_EQ(all.batch.events.size(), 3000U);
    EXPECT_TRUE(losses(all.summary).empty());
  }
}

TEST(Unpacked, CutAndDamagedFilesAreReadAsFarAsTheyGoAndCounted) {
  const EventBatch events = random_stream({.events = 100'000, .width = 640, .height = 480});
  for (const Pack pack : packs()) {
    for (const char* format : {"dat", "evt3"}) {
      const Bytes whole = pack(written(events, format));
      Bytes cut(whole.begin(), whole.begin() + static_cast<ptrdiff_t>(whole.size() / 2));
      const Read part = read(make_memory_source(std::span<const uint8_t>(cut)));
      EXPECT_GT(part.batch.events.size(), 10'000U) << format;
      EXPECT_LT(part.batch.events.size(), 100'000U) << format;
      EXPECT_GE(part.summary.of(Violation::kTruncated).count, 1U) << format;
      Bytes damaged = whole;
      for (size_t i = 0; i < 64; ++i) damaged[whole.size() / 2 + i] ^= 0x5A;
      EXPECT_GE(read(make_memory_source(std::span<const uint8_t>(damaged))).summary.num_violations(), 1U) << format;
    }
  }
}

TEST(Unpacked, WhatStandsBeforeDamageIsTheSameFromAFileAndAPipe) {
  const EventBatch events = random_stream({.events = 100'000, .width = 640, .height = 480});
  for (const Pack pack : packs()) {
    Bytes damaged = pack(written(events, "dat"));
    for (size_t i = 0; i < 64; ++i) damaged[damaged.size() * 9 / 10 + i] ^= 0x5A;
    const Read file = read(make_memory_source(std::span<const uint8_t>(damaged)));
    EXPECT_GT(file.batch.events.size(), 60'000U);
    for (const size_t step : {1U, 1000U, 300'000U}) {
      const Read pipe = read(std::make_unique<ChunkedSource>(damaged, std::vector<size_t>(), step));
      EXPECT_EQ(pipe.batch, file.batch) << step;
      EXPECT_EQ(pipe.summary.num_violations(), file.summary.num_violations()) << step;
    }
  }
}

TEST(Unpacked, TheNameInsideTellsTheFormatAndWhatLiesBeside) {
  TestFolder folder;
  const std::string text = "1,2,1,5\n1,2,0,9\n", triggers = "p,id,t\n1,0,7\n";
  ASSERT_TRUE(write_file(folder / "a.csv.gz", gzip({text.begin(), text.end()})).ok());
  ASSERT_TRUE(write_file(folder / "a_triggers.csv", triggers).ok());
  auto reader = open_recording(folder / "a.csv.gz");
  ASSERT_TRUE(reader.ok()) << reader.error().text();
  EXPECT_EQ(read_all(**reader).value().triggers, (std::vector<Trigger>{{7, 0, 1}}));
}

TEST(Unpacked, WhatUnpacksToAGreatDealTakesLittleMemory) {
  auto source =
      make_unpacked_source(make_memory_source(gzip(Bytes(size_t{1} << 28))), std::make_shared<DecodeSummary>());
  uint64_t total = 0;
  for (;;) {
    const auto bytes = (*source)->fetch(1).value();
    if (bytes.empty()) break;
    EXPECT_LE(bytes.size(), size_t{1} << 20);
    total += bytes.size();
    (*source)->consume(bytes.size());
  }
  EXPECT_EQ(total, uint64_t{1} << 28);
}

}  // namespace
}  // namespace e2lf::recordings
