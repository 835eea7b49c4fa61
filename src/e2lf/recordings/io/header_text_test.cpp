// SPDX-License-Identifier: MIT
#include "e2lf/recordings/io/header_text.h"

#include <gtest/gtest.h>

#include "e2lf/base/text.h"
#include "e2lf/recordings/recording.h"
#include "testing/test_streams.h"

namespace e2lf::recordings {
namespace {

TEST(HeaderText, IsUtf8WhateverTheBytesAre) {
  EXPECT_EQ(header_text("M\u00fcller \u4e16 \U0001F4F7"), "M\u00fcller \u4e16 \U0001F4F7");
  EXPECT_EQ(header_text("M\xfcller"), "M\u00fcller");
  EXPECT_EQ(header_text("two\nlines\t\x7f"), "two lines  ");
  EXPECT_EQ(header_text("up\u009b2J"), "up 2J");
  for (const char* bytes : {"\xc0\x80", "\xed\xa0\x80", "\xf5\x80\x80\x80", "\xe2\x82", "\x80"}) {
    EXPECT_FALSE(is_utf8(bytes));
    EXPECT_TRUE(is_utf8(header_text(bytes)));
  }
}

/// A header line between those that name the encoding, the size and the end.
EventBatch read_with_line(const std::string& line, RecordingInfo& info, std::vector<uint8_t>& bytes) {
  const EventBatch batch = random_stream({.events = 500, .width = 64, .height = 48, .trigger_every = 50});
  bytes = encoded(batch, "evt3", {.width = 64, .height = 48});
  bytes.insert(bytes.begin(), line.begin(), line.end());
  auto reader = open_bytes(bytes).value();
  info = reader->info();
  EXPECT_EQ(read_all(*reader).value(), batch);
  EXPECT_EQ(reader->summary().num_violations(), 0U);
  return batch;
}

TEST(RawHeaders, LettersBeyondAsciiDoNotEndTheHeader) {
  RecordingInfo info;
  std::vector<uint8_t> bytes;
  for (const std::string name : {"M\xc3\xbcller", "M\xfcller"}) {
    const EventBatch batch = read_with_line("% camera_owner " + name + "\n", info, bytes);
    EXPECT_EQ(info.width, 64U);
    EXPECT_EQ(info.find("camera_owner"), "M\u00fcller");
    // The writers keep it.
    for (const char* format : {"evt2", "evt2.1", "evt3"}) {
      const std::vector<uint8_t> copy = encoded(batch, format, info);
      auto again = open_bytes(copy).value();
      EXPECT_EQ(again->info().find("camera_owner"), "M\u00fcller") << format;
    }
  }
}

TEST(DatHeaders, LettersBeyondAsciiBecomeUtf8) {
  const std::string text = std::string("% owner M\xfcller\n% Version 2\n% Width 64\n% Height 48\n% end\n\x0c\x08", 59);
  auto reader = open_recording(make_memory_source(std::vector<uint8_t>(text.begin(), text.end()))).value();
  EXPECT_EQ(reader->info().format, "dat");
  EXPECT_EQ(reader->info().width, 64U);
  EXPECT_EQ(reader->info().find("owner"), "M\u00fcller");
}

TEST(DatHeaders, MayHaveAnyLinesThatBeginWithPercent) {
  const std::string comments(70'000, 'x');
  std::string many_lines = "% first";
  for (size_t i = 0; i < 70; ++i) many_lines += "\n% " + comments.substr(0, 1'000);
  for (const std::string& line : std::initializer_list<std::string>{
           "%", "%comment", "%% x", "%\tkey value", "% \"quoted\" name", "% M\xc3\xbcller x", "% M\xfcller x", "% ",
           "% " + comments.substr(0, 5'000), "% " + comments, many_lines}) {
    for (const std::string& end : std::initializer_list<std::string>{"", "% end\n"}) {
      std::string text = "% Version 2\n" + line + "\n% Width 64\n% Height 48\n" + end;
      text += std::string("\x0c\x08\x05\0\0\0\x07\xC0\x02\x10", 10);  // t = 5, x = 7, y = 11, p = 1
      auto reader = open_recording(make_memory_source(std::vector<uint8_t>(text.begin(), text.end())),
                                   {.format = text.size() > 4'000 ? "dat" : ""});
      ASSERT_TRUE(reader.ok()) << line.substr(0, 40) << ": " << reader.error().text();
      EXPECT_EQ((*reader)->info().format, "dat");
      EXPECT_EQ((*reader)->info().width, 64U);
      const EventBatch batch = read_all(**reader).value();
      ASSERT_EQ(batch.events.size(), 1U) << line.substr(0, 40);
      EXPECT_EQ(batch.events[0], (Event{7, 11, 1, 5}));
    }
  }
}

TEST(RawHeaders, MayHave70Kilobytes) {
  const EventBatch batch = random_stream({.events = 500, .width = 64, .height = 48});
  const std::vector<uint8_t> plain = encoded(batch, "evt3", {.width = 64, .height = 48});
  for (const size_t in_line : {1'000, 70'000}) {
    std::string lines;
    while (lines.size() < 70'000) lines += "% note " + std::string(in_line, 'x') + "\n";
    std::vector<uint8_t> bytes(lines.begin(), lines.end());
    bytes.insert(bytes.end(), plain.begin(), plain.end());
    auto reader = open_recording(make_memory_source(bytes), {.format = "raw"}).value();
    EXPECT_EQ(reader->info().width, 64U);
    EXPECT_EQ(read_all(*reader).value(), batch);
  }
}

}  // namespace
}  // namespace e2lf::recordings
