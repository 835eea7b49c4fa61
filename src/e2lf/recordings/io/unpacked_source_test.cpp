// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/files/file.h"
#include "e2lf/recordings/io/decompress.h"
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

TEST(Unpacked, RecordingsOfEveryFormatAreReadFromMemoryAndPipes) {
  const EventBatch events = random_stream({.events = 200'000, .width = 640, .height = 480});
  for (const Pack pack : packs()) {
    for (const char* format : {"evt3", "evt2", "dat", "csv", "npz"}) {
      const Bytes packed = pack(encoded(events, format));
      const Decoded plain = decoded(make_memory_source(std::span<const uint8_t>(packed)));
      EXPECT_EQ(plain.batch.events, events.events) << format;
      EXPECT_TRUE(losses(plain.summary).empty()) << format;
      EXPECT_EQ(decoded(chunked(packed, 1000)).batch.events, events.events) << format;
    }
  }
}

TEST(Unpacked, SeveralPartsAndPaddingAreReadToTheEnd) {
  const Bytes raw = encoded(random_stream({.events = 3000, .width = 640, .height = 480}), "csv");
  const auto middle = raw.begin() + static_cast<ptrdiff_t>(raw.size() / 2);
  for (const Pack pack : packs()) {
    Bytes packed = pack({raw.begin(), middle});
    const Bytes second = pack({middle, raw.end()});
    packed.insert(packed.end(), second.begin(), second.end());
    packed.resize(packed.size() + 512);
    const Decoded all = decoded(make_memory_source(std::span<const uint8_t>(packed)));
    EXPECT_EQ(all.batch.events.size(), 3000U);
    EXPECT_TRUE(losses(all.summary).empty());
  }
}

TEST(Unpacked, CutAndDamagedFilesAreReadAsFarAsTheyGoAndCounted) {
  const EventBatch events = random_stream({.events = 100'000, .width = 640, .height = 480});
  for (const Pack pack : packs()) {
    for (const char* format : {"dat", "evt3"}) {
      const Bytes whole = pack(encoded(events, format));
      Bytes cut(whole.begin(), whole.begin() + static_cast<ptrdiff_t>(whole.size() / 2));
      const Decoded part = decoded(make_memory_source(std::span<const uint8_t>(cut)));
      EXPECT_GT(part.batch.events.size(), 10'000U) << format;
      EXPECT_LT(part.batch.events.size(), 100'000U) << format;
      EXPECT_GE(part.summary.of(Violation::kTruncated).count, 1U) << format;
      Bytes damaged = whole;
      for (size_t i = 0; i < 64; ++i) damaged[whole.size() / 2 + i] ^= 0x5A;
      EXPECT_GE(decoded(make_memory_source(std::span<const uint8_t>(damaged))).summary.num_violations(), 1U) << format;
    }
  }
}

TEST(Unpacked, WhatStandsBeforeDamageIsTheSameFromAFileAndAPipe) {
  const EventBatch events = random_stream({.events = 100'000, .width = 640, .height = 480});
  for (const Pack pack : packs()) {
    Bytes damaged = pack(encoded(events, "dat"));
    for (size_t i = 0; i < 64; ++i) damaged[damaged.size() * 9 / 10 + i] ^= 0x5A;
    const Decoded file = decoded(make_memory_source(std::span<const uint8_t>(damaged)));
    EXPECT_GT(file.batch.events.size(), 60'000U);
    for (const size_t step : {1U, 1000U, 300'000U}) {
      const Decoded pipe = decoded(chunked(damaged, step));
      EXPECT_EQ(pipe.batch, file.batch) << step;
      EXPECT_EQ(pipe.summary.num_violations(), file.summary.num_violations()) << step;
    }
  }
}

TEST(Unpacked, TheNameInsideTellsTheFormatAndWhatLiesBeside) {
  TestFolder folder;
  const std::string text = "x,y,p,t\n1,2,1,5\n1,2,0,9\n", triggers = "p,id,t\n1,0,7\n";
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
