// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/base/isa.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_header.h"
#include "testing/chunked_source.h"
#include "testing/test_streams.h"

namespace e2lf::recordings {
namespace {

std::vector<uint8_t> bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

/// "08 80 05 60" as bytes.
std::vector<uint8_t> from_hex(const std::string& text) {
  std::vector<uint8_t> bytes;
  for (size_t i = 0; i + 1 < text.size(); i += 3) {
    bytes.push_back(static_cast<uint8_t>(std::stoi(text.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

std::string to_hex(std::span<const uint8_t> bytes) {
  std::string text;
  char pair[4];
  for (const uint8_t byte : bytes) {
    std::snprintf(pair, sizeof(pair), "%02x ", byte);
    text += pair;
  }
  return text;
}

RecordingInfo sensor(size_t width, size_t height) {
  return {.width = width, .height = height};
}

/// The words behind the header.
std::vector<uint8_t> payload_of(const std::vector<uint8_t>& bytes) {
  const size_t begin = parse_raw_header(bytes, true, "").value().num_bytes;
  return {bytes.begin() + static_cast<ptrdiff_t>(begin), bytes.end()};
}

Decoded decode_raw(std::vector<uint8_t> bytes, const OpenOptions& options) {
  return decoded(open_recording(make_memory_source(std::move(bytes)), options));
}

Decoded decode_words(const std::string& hex, const std::string& format, size_t width = 1280, size_t height = 720) {
  return decode_raw(from_hex(hex), {.format = format, .width = width, .height = height});
}

/// A stream as sensors make it: some rows with many events at one time, single events, pauses, triggers.
EventBatch sensor_stream(size_t width, size_t height, size_t events, uint32_t seed) {
  std::mt19937 random(seed);
  EventBatch batch;
  int64_t t_us = 5'000'000 + random() % 1000;
  while (batch.events.size() < events) {
    t_us += random() % 4 == 0 ? random() % 40 : random() % 3;
    if (random() % 2000 == 0) t_us += 9000;
    const auto y = static_cast<uint16_t>(random() % height);
    const auto p = static_cast<uint8_t>(random() & 1);
    if (random() % 3 == 0) {
      const uint32_t density = 1 + random() % 8;
      for (size_t x = random() % width; x < width; x += 1 + random() % density) {
        batch.events.push_back({static_cast<uint16_t>(x), y, p, t_us});
        if (random() % 60 == 0) break;
      }
    } else {
      batch.events.push_back({static_cast<uint16_t>(random() % width), y, p, t_us});
    }
    if (random() % 50 == 0) batch.triggers.push_back({t_us, static_cast<uint16_t>(random() % 8), p});
  }
  return batch;
}

TEST(Evt3Golden, EventsAreWrittenAsTheseWords) {
  EventBatch batch;
  batch.events.push_back({0x123, 0x45, 1, 0x5003});
  batch.events.push_back({0x124, 0x45, 0, 0x5004});
  for (const uint16_t x : {200, 201, 203, 210, 220, 231}) batch.events.push_back({x, 0x46, 1, 0x5004});
  batch.triggers.push_back({0x5004, 6, 1});
  // TIME_HIGH 5, TIME_LOW 3, Y 45, X 123 ON; trigger 6 rising at 4; X 124 OFF; Y 46, base 200 ON, 12 + 12 + 8 pixels.
  EXPECT_EQ(to_hex(payload_of(encoded(batch, "evt3", sensor(1280, 720)))),
            "05 80 03 60 45 00 23 29 04 60 01 a6 24 21 46 00 c8 38 0b 44 00 41 80 50 ");
}

TEST(Evt2Golden, EventsAreWrittenAsTheseWords) {
  EventBatch batch;
  batch.events.push_back({639, 479, 1, 1317888});
  batch.events.push_back({1, 2, 0, 1317888 + 65});
  batch.triggers.push_back({1317888 + 1, 3, 1});
  EXPECT_EQ(to_hex(payload_of(encoded(batch, "evt2", sensor(640, 480)))),
            "70 50 00 80 df f9 13 10 01 03 40 a0 71 50 00 80 02 08 40 00 ");
}

TEST(Evt21Golden, EventsAreWrittenAsTheseWordsInBothByteOrders) {
  EventBatch batch;
  for (const uint16_t x : {64, 67, 95}) batch.events.push_back({x, 9, 1, 130});
  EXPECT_EQ(to_hex(payload_of(encoded(batch, "evt2.1", sensor(640, 480)))),
            "00 00 00 00 02 00 00 80 09 00 00 80 09 00 82 10 ");
  RecordingInfo legacy = sensor(640, 480);
  legacy.header.emplace_back("endianness", "legacy");
  EXPECT_EQ(to_hex(payload_of(encoded(batch, "evt2.1", legacy))), "02 00 00 80 00 00 00 00 09 00 82 10 09 00 00 80 ");
  EXPECT_EQ(decode_raw(encoded(batch, "evt2.1", legacy), {}).batch, batch);
}

TEST(Evt3Words, EachWordMeansWhatTheFormatSays) {
  // TIME_HIGH b2d, TIME_LOW 1, Y (slave camera) 2, base 100 ON, VECT_8 81, VECT_12 801, OTHERS with two payload words
  // and none of four bits, X 5 OFF, trigger 6 falling, padding.
  const Decoded decoded =
      decode_words("2d 8b 01 60 02 08 64 38 81 50 01 48 19 e0 34 f1 12 f0 05 20 00 a6 99 99", "evt3");
  const int64_t t = 0xb2d001;
  const EventColumns& events = decoded.batch.events;
  ASSERT_EQ(events.size(), 5u);
  EXPECT_EQ(events[0], (Event{100, 2, 1, t}));
  EXPECT_EQ(events[1], (Event{107, 2, 1, t}));
  EXPECT_EQ(events[2], (Event{108, 2, 1, t}));
  EXPECT_EQ(events[3], (Event{119, 2, 1, t}));
  EXPECT_EQ(events[4], (Event{5, 2, 0, t}));
  EXPECT_EQ(decoded.batch.triggers, (std::vector<Trigger>{{t, 6, 0}}));
  EXPECT_EQ(decoded.summary.num_violations(), 0u);
}

TEST(Evt3Words, EventsBeforeTheFirstTimeAreCountedAndDropped) {
  const Decoded decoded = decode_words("01 60 05 00 06 20 07 20 01 80 02 60 08 20", "evt3");
  ASSERT_EQ(decoded.batch.events.size(), 1u);
  EXPECT_EQ(decoded.batch.events[0], (Event{8, 5, 0, 0x1002}));
  EXPECT_EQ(decoded.summary.events_before_time, 2u);
}

TEST(Evt3Words, WhatLiesOutsideTheSensorIsDroppedAndCounted) {
  // X 15 and Y 9 are outside 12x8; base 6 with pixels 0, 5 and 11 has two outside; X 3 without a valid row is dropped.
  const Decoded decoded =
      decode_words("01 80 02 60 01 00 0f 20 06 30 21 48 03 20 09 00 03 20 02 00 04 20", "evt3", 12, 8);
  ASSERT_EQ(decoded.batch.events.size(), 4u);
  EXPECT_EQ(decoded.batch.events[0], (Event{6, 1, 0, 0x1002}));
  EXPECT_EQ(decoded.batch.events[1], (Event{11, 1, 0, 0x1002}));
  EXPECT_EQ(decoded.batch.events[2], (Event{3, 1, 0, 0x1002}));
  EXPECT_EQ(decoded.batch.events[3], (Event{4, 2, 0, 0x1002}));
  EXPECT_EQ(decoded.summary.of(Violation::kOutOfRange).count, 3u);
}

TEST(Evt2Words, EachWordMeansWhatTheFormatSays) {
  // TIME_HIGH 0x10 (1024 us), ON at 3 us (5, 6), trigger 1 rising at 4 us, OTHERS, CONTINUED, OFF at 5 us (7, 8).
  const Decoded decoded =
      decode_words("10 00 00 80 06 28 c0 10 01 01 00 a1 01 00 00 e0 01 00 00 f0 08 38 40 01", "evt2");
  ASSERT_EQ(decoded.batch.events.size(), 2u);
  EXPECT_EQ(decoded.batch.events[0], (Event{5, 6, 1, 1027}));
  EXPECT_EQ(decoded.batch.events[1], (Event{7, 8, 0, 1029}));
  EXPECT_EQ(decoded.batch.triggers, (std::vector<Trigger>{{1028, 1, 1}}));
}

class Encodings : public testing::TestWithParam<const char*> {};

TEST_P(Encodings, ReadGivesBackWhatWasWritten) {
  for (const auto& [width, height] : {std::pair<size_t, size_t>{1280, 720}, {640, 480}, {47, 31}, {16, 9}, {1, 1}}) {
    for (uint32_t seed = 0; seed < 4; ++seed) {
      const EventBatch batch = sensor_stream(width, height, 3000 + seed, seed);
      const auto bytes = encoded(batch, GetParam(), sensor(width, height));
      for (const std::string& isa : available_isas()) {
        ASSERT_TRUE(set_max_isa(isa));
        const Decoded decoded = decode_raw(bytes, {});
        ASSERT_EQ(decoded.batch, batch) << isa << " " << width << " " << seed;
        EXPECT_EQ(decoded.summary.num_violations(), 0u);
      }
    }
  }
  ASSERT_TRUE(set_max_isa(""));
}

TEST_P(Encodings, EventsWithoutOrderInARowComeBackInTheirOrder) {
  RandomStream options = {.events = 5000, .max_gap_us = 1, .trigger_every = 100};
  EventBatch batch = random_stream(options);
  EXPECT_EQ(decode_raw(encoded(batch, GetParam(), sensor(640, 480)), {}).batch, batch);
}

TEST_P(Encodings, WrittenInBatchesReadsAsOne) {
  const EventBatch whole = sensor_stream(640, 480, 5000, 3);
  std::vector<uint8_t> bytes;
  auto writer = create_recording(make_memory_sink(bytes), GetParam(), sensor(640, 480)).value();
  size_t trigger = 0;
  for (size_t begin = 0; begin < whole.events.size(); begin += 700) {
    const size_t end = std::min(begin + 700, whole.events.size());
    EventBatch part;
    part.events.append(whole.events, begin, end);
    while (trigger < whole.triggers.size() &&
           (end == whole.events.size() || whole.triggers[trigger].t < whole.events.t[end])) {
      part.triggers.push_back(whole.triggers[trigger++]);
    }
    const auto written = writer->write(part);
    if (!written) {
      // A trigger at the very time where two batches meet may come late: that is the caller's error.
      GTEST_FAIL() << written.error().text();
    }
  }
  ASSERT_TRUE(writer->finish());
  EXPECT_EQ(decode_raw(bytes, {}).batch.events, whole.events);
}

TEST_P(Encodings, LongPausesAndLateStartsKeepTheirTime) {
  EventBatch batch;
  for (const int64_t t : {int64_t{100'000'000'000}, int64_t{100'000'000'001}, int64_t{100'050'000'000},
                          int64_t{103'600'000'000}, int64_t{103'600'000'064}}) {
    batch.events.push_back({3, 4, 1, t});
  }
  const Decoded decoded = decode_raw(encoded(batch, GetParam(), sensor(64, 64)), {});
  EXPECT_EQ(decoded.batch, batch);
  EXPECT_EQ(decoded.summary.num_violations(), 0u);
}

TEST_P(Encodings, WriterRefusesWhatTheFormatCannotHold) {
  std::vector<uint8_t> bytes;
  auto writer = create_recording(make_memory_sink(bytes), GetParam(), sensor(64, 48)).value();
  const auto write = [&](const Event& event) {
    EventBatch batch;
    batch.events.push_back(event);
    return writer->write(batch);
  };
  EXPECT_EQ(write({64, 0, 0, 5}).error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(write({0, 48, 0, 5}).error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(write({0, 0, 0, -1}).error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(write({0, 0, 0, INT64_MAX}).error().code, ErrorCode::kInvalidValue);
  EXPECT_TRUE(write({0, 0, 0, 100}));
  EXPECT_EQ(write({0, 0, 0, 99}).error().code, ErrorCode::kInvalidValue);
  EXPECT_FALSE(create_recording(make_memory_sink(bytes), GetParam(), sensor(0, 0)));
  EXPECT_FALSE(create_recording(make_memory_sink(bytes), GetParam(), sensor(4000, 48)));
}

TEST_P(Encodings, EmptyRecordingHasNoEvents) {
  const Decoded decoded = decode_raw(encoded({}, GetParam(), sensor(64, 48)), {});
  EXPECT_TRUE(decoded.batch.empty());
  EXPECT_EQ(decoded.summary.events(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Raw, Encodings, testing::Values("evt2", "evt2.1", "evt3"),
                         [](const auto& test) { return "n" + std::to_string(test.index); });

TEST(RawHeaders, KeysOfAllAgesAreUnderstood) {
  const auto parse = [](const std::string& text) { return parse_raw_header(bytes_of(text), true, "file"); };
  const RawHeader old = parse("% Date 2020-09-25 07:48:29\n% evt 3.0\n% system_ID 48\n\x2d\x8b").value();
  EXPECT_EQ(old.info.format, "evt3");
  EXPECT_EQ(old.info.width, 1280u);
  EXPECT_EQ(old.num_bytes, 52u);
  EXPECT_EQ(old.info.find("Date"), "2020-09-25 07:48:29");
  const RawHeader full =
      parse("% format EVT21;endianness=legacy;height=72;width=128\r\n% geometry 128x72\r\n% end\r\n% x").value();
  EXPECT_EQ(full.info.format, "evt2.1");
  EXPECT_EQ(full.endianness, "legacy");
  EXPECT_EQ(full.info.width, 128u);
  EXPECT_EQ(full.info.height, 72u);
  EXPECT_EQ(full.num_bytes, 80u);
  // Event words that begin like a header line.
  EXPECT_EQ(parse(std::string("% evt 2.0\n% \x80\x01\n", 15)).value().num_bytes, 10u);
  EXPECT_EQ(parse("% evt 2.0\n% (!@\"a(\n").value().num_bytes, 10u);
  EXPECT_EQ(parse("").value().num_bytes, 0u);
}

TEST(RawHeaders, LinesOfOtherFormsDoNotEndThem) {
  for (const std::string line : {"%", "%comment", "% (text)", "%% x", "%\tx y", "% Gr\u00f6\u00dfe 5",
                                 "% \xd6"
                                 "lner x",
                                 "% "}) {
    const std::string text = "% evt 3.0\n" + line + "\n% geometry 640x480\n% end\n";
    const auto header = parse_raw_header(bytes_of(text), true, "").value();
    EXPECT_EQ(header.info.width, 640U) << line;
    EXPECT_EQ(header.num_bytes, text.size()) << line;
    for (size_t size = 0; size < text.size(); ++size) {
      const auto partial = parse_raw_header(bytes_of(text.substr(0, size)), false, "");
      ASSERT_FALSE(partial.ok()) << line << size;
      EXPECT_EQ(partial.error().code, ErrorCode::kTruncated) << line << size;
    }
  }
}

TEST(RawHeaders, WithoutAnEndStopAtTheFirstWordsThatAreNoKey) {
  const std::string header = "% evt 3.0\n% geometry 640x480\n", words = "%\n\x25\x80 %a";
  EXPECT_EQ(parse_raw_header(bytes_of(header + words), true, "").value().num_bytes, header.size());
}

TEST(RawHeaders, ContradictionsAndUnknownEncodingsAreErrors) {
  const auto code = [](const std::string& text) { return parse_raw_header(bytes_of(text), true, "").error().code; };
  EXPECT_EQ(code("% format EVT3;height=720;width=1280\n% geometry 640x480\n% end\n"), ErrorCode::kFormat);
  EXPECT_EQ(code("% evt 2.0\n% format EVT3\n% end\n"), ErrorCode::kFormat);
  EXPECT_EQ(code("% evt 3.0\n% geometry 0x480\n% end\n"), ErrorCode::kFormat);
  EXPECT_EQ(code("% evt 3.0\n% geometry 99999999999999999999x480\n% end\n"), ErrorCode::kFormat);
  EXPECT_EQ(code("% format EVT5;height=720;width=1280\n% end\n"), ErrorCode::kUnsupported);
  EXPECT_EQ(code("% format HISTO3D;height=720;width=1280\n% end\n"), ErrorCode::kUnsupported);
  EXPECT_EQ(code("% evt 5.0\n"), ErrorCode::kUnsupported);
}

TEST(RawHeaders, OptionsMayNotContradictTheFile) {
  const auto bytes = encoded(sensor_stream(64, 48, 100, 1), "evt3", sensor(64, 48));
  OpenOptions options = {.format = "evt2"};
  EXPECT_EQ(open_bytes(bytes, options).error().code, ErrorCode::kInvalidValue);
  options.format = "evt3";
  options.width = 65;
  EXPECT_EQ(open_bytes(bytes, options).error().code, ErrorCode::kInvalidValue);
}

TEST(RawFiles, AppearWholeOrNotAtAll) {
  const TestFolder folder;
  const auto path = folder / "recording.raw";
  const EventBatch batch = sensor_stream(64, 48, 100, 1);
  {
    auto writer = create_recording(path, "", sensor(64, 48)).value();
    ASSERT_TRUE(writer->write(batch));
  }
  EXPECT_TRUE(std::filesystem::is_empty(path.parent_path()));
  auto writer = create_recording(path, "", sensor(64, 48)).value();
  ASSERT_TRUE(writer->write(batch));
  ASSERT_TRUE(writer->finish());
  auto reader = open_recording(path).value();
  EXPECT_EQ(reader->info().format, "evt3");
  EXPECT_EQ(read_all(*reader).value(), batch);
}

}  // namespace
}  // namespace e2lf::recordings
