// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <functional>
#include <gtest/gtest.h>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"
#include "e2lf/recordings/recording.h"
#include "testing/test_streams.h"

/// Tables of events as people write them: which column is what, in which unit, with which polarities.
namespace e2lf::recordings {
namespace {

const OpenOptions kPlain = {.policy = DecodePolicy::kSkip};

/// 1,000 events on 64x48 px within 30 ms.
EventColumns events() {
  return random_stream({.events = 1000, .width = 64, .height = 48, .begin_us = 1038, .max_gap_us = 60}).events;
}

std::string text_of(const EventColumns& all, std::function<std::string(const Event&)> line) {
  std::string text;
  for (size_t i = 0; i < all.size(); ++i) text += line(all[i]) + '\n';
  return text;
}

Result<ReaderPtr> open_text(const std::string& text, const OpenOptions& options = kPlain) {
  return open_recording(make_memory_source(std::vector<uint8_t>(text.begin(), text.end()), "a.csv"), options);
}

Result<EventColumns> read(Result<ReaderPtr> reader) {
  if (!reader) return reader.error();
  E2LF_ASSIGN_OR_RETURN(EventBatch batch, read_all(**reader));
  if ((*reader)->summary().num_violations() > 0) return violation_error((*reader)->summary(), "");
  return std::move(batch.events);
}

void expect_events(const std::string& text, const char* what, const OpenOptions& options = kPlain) {
  const auto found = read(open_text(text, options));
  ASSERT_TRUE(found.ok()) << what << ": " << found.error().text();
  EXPECT_TRUE(*found == events()) << what;
}

std::string xytp(const Event& e) {
  return cat(e.x, ' ', e.y, ' ', e.t, ' ', int{e.p});
}
std::string txyp(const Event& e) {
  return cat(e.t, ' ', e.x, ' ', e.y, ' ', int{e.p});
}
std::string txyp_commas(const Event& e) {
  return cat(e.t, ',', e.x, ',', e.y, ',', int{e.p});
}

TEST(TableText, ColumnsAreFoundByTheirValues) {
  expect_events(text_of(events(), xytp), "x y t p");
  expect_events(text_of(events(), txyp), "t x y p");
  expect_events(text_of(events(), txyp_commas), "t,x,y,p");
  expect_events("# x y t p\n" + text_of(events(), xytp), "named x y t p");
  expect_events("64 48\n" + text_of(events(), xytp), "x y t p below a size");
}

TEST(TableText, WholeTimesAreMicrosecondsHoweverTheyAreWritten) {
  expect_events(text_of(events(), [](const Event& e) { return cat(e.t, ".0 ", e.x, ' ', e.y, ' ', int{e.p}); }), ".0");
  expect_events(
      "t x y p\n" + text_of(events(), [](const Event& e) { return cat(e.t, ".0 ", e.x, ' ', e.y, ' ', int{e.p}); }),
      ".0 with names");
  expect_events(text_of(events(),
                        [](const Event& e) {
                          char line[128];
                          std::snprintf(line, sizeof line, "%.18e %.18e %.18e %.18e", static_cast<double>(e.t),
                                        static_cast<double>(e.x), static_cast<double>(e.y), static_cast<double>(e.p));
                          return std::string(line);
                        }),
                "numpy.savetxt");
}

TEST(TableText, OptionsNameColumnsAndUnit) {
  const OpenOptions ns = {.policy = DecodePolicy::kSkip, .time_unit = TimeUnit::kNanoseconds, .columns = "xytp"};
  expect_events(
      text_of(events(), [](const Event& e) { return cat(e.x, ' ', e.y, ' ', e.t * 1000 + 999, ' ', int{e.p}); }), "ns",
      ns);
  const OpenOptions more = {.policy = DecodePolicy::kSkip, .columns = "-txyp"};
  expect_events(text_of(events(), [](const Event& e) { return "7," + txyp_commas(e); }), "a column more", more);
  const auto wrong = open_text(text_of(events(), txyp), {.columns = "txy"});
  ASSERT_FALSE(wrong.ok());
  EXPECT_EQ(wrong.error().setting, Setting::kColumns);
}

TEST(TableText, EpochNanosecondsKeepEveryMicrosecond) {
  constexpr int64_t kEpochUs = 1'600'000'000'000'000;
  const auto found = read(open_text(text_of(
      events(), [](const Event& e) { return cat((kEpochUs + e.t) * 1000, ',', e.x, ',', e.y, ',', int{e.p}); })));
  ASSERT_TRUE(found.ok()) << found.error().text();
  const EventColumns all = events();
  for (size_t i = 0; i < found->size(); ++i) ASSERT_EQ(found->t[i], kEpochUs + all.t[i]);
}

TEST(TableText, UnitsInNamesAreHeeded) {
  for (const char* name : {"t_ns", "t(ns)", "timestamp[ns]", "Timestamp (ns)", "t [ns]", "time_ns"}) {
    expect_events(
        cat("#", name, ",x,y,p\n") +
            text_of(events(), [](const Event& e) { return cat(e.t * 1000, ',', e.x, ',', e.y, ',', int{e.p}); }),
        name);
  }
  expect_events("t_ms x y p\n" + text_of(events(),
                                         [](const Event& e) {
                                           char line[64];
                                           std::snprintf(line, sizeof line, "%.3f %d %d %d",
                                                         static_cast<double>(e.t) / 1000, e.x, e.y, e.p);
                                           return std::string(line);
                                         }),
                "t_ms");
}

TEST(TableText, AnyHeaderMarkAndSeparatorWillDo) {
  for (const char* header : {"#timestamp, x, y, polarity\n", "% t,x,y,p\n", "// t,x,y,p\n", "; t,x,y,p\n",
                             "Zeit,Spalte,Zeile,Vorzeichen\n", "time,x,y,polarit\xC3\xA9\n", ""}) {
    for (const char* separator : {",", ";", "\t", " ", ", ", " ; "}) {
      expect_events(header + text_of(events(),
                                     [&](const Event& e) {
                                       return cat(e.t, separator, e.x, separator, e.y, separator, int{e.p});
                                     }),
                    cat(header, separator).c_str());
    }
  }
  expect_events(text_of(events(),
                        [](const Event& e) {
                          char line[64];
                          std::snprintf(line, sizeof line, "0,%06d;%d;%d;%d", static_cast<int>(e.t), e.x, e.y, e.p);
                          return std::string(line);
                        }),
                "decimal commas");
}

TEST(TableText, ColumnsOfWordsBarsAndSignsAreRead) {
  expect_events(text_of(events(), [](const Event& e) { return cat(e.t, '|', e.x, '|', e.y, '|', int{e.p}); }), "bars");
  expect_events(
      text_of(events(), [](const Event& e) { return cat(e.t, ',', e.x, ',', e.y, ',', e.p == 1 ? '+' : '-'); }),
      "+ and -");
  expect_events("t,x,y,p,label\n" + text_of(events(), [](const Event& e) { return txyp_commas(e) + ",car"; }),
                "a column of words");
  expect_events("Unnamed: 0,t,x,y,p\n" + text_of(events(), [](const Event& e) { return "7," + txyp_commas(e); }),
                "a column of numbers whose name has a number");
  const auto in_ns = [](const Event& e) { return cat(e.t * 1000, ',', e.x, ',', e.y, ',', int{e.p}); };
  expect_events("timestampNs,x,y,p\n" + text_of(events(), in_ns), "a unit behind a capital");
  expect_events("t,x,y,p\nns,px,px,-\n" + text_of(events(), in_ns), "a line of units");
}

TEST(TableText, CoordinatesInOrderAreNotTakenForTimes) {
  std::vector<Event> by_row;
  const EventColumns all = events();
  for (size_t i = 0; i < all.size(); ++i) by_row.push_back(all[i]);
  // Within as much time as is sorted.
  const auto place = [](const Event& event) { return std::pair(event.t / 8000, event.y); };
  std::stable_sort(by_row.begin(), by_row.end(), [&](const Event& a, const Event& b) { return place(a) < place(b); });
  std::string text;
  for (const Event& event : by_row) text += txyp(event) + '\n';
  const auto found = read(open_text(text));
  ASSERT_TRUE(found.ok()) << found.error().text();
  EXPECT_TRUE(found->t == all.t);
}

TEST(TableText, MarksEndsOfLinesAndJoinedFilesLoseNothing) {
  const std::string plain = "t,x,y,p\n" + text_of(events(), txyp_commas);
  const auto replaced = [&](const std::string& end) {
    std::string text;
    for (const char c : plain) text += c == '\n' ? end : std::string(1, c);
    return text;
  };
  const OpenOptions strict = {.policy = DecodePolicy::kStrict};
  expect_events("\xEF\xBB\xBF" + text_of(events(), txyp_commas), "mark of UTF-8", strict);
  expect_events(replaced("\r\n"), "CRLF", strict);
  expect_events(replaced("\r"), "CR", strict);
  expect_events(replaced(",\n"), "separators at the end", strict);
  const size_t middle = plain.find('\n', plain.size() / 2) + 1;
  expect_events(plain.substr(0, middle) + "t,x,y,p\n" + plain.substr(middle), "joined", strict);
  expect_events(
      text_of(events(),
              [](const Event& e) { return cat('"', e.t, "\",\"", e.x, "\",\"", e.y, "\",\"", int{e.p}, '"'); }),
      "quoted", strict);
}

TEST(TableText, AnOddFirstLineIsJudgedByTheOthers) {
  EventColumns all = events();
  all.t[0] = 0;
  all.y[0] = 1;
  const auto found = read(open_text(text_of(all, [](const Event& e) {
    char line[64];
    if (e.t == 0) return "0 " + cat(e.x, ' ', e.y, ' ', int{e.p});
    std::snprintf(line, sizeof line, "%.6f %d %d %d", static_cast<double>(e.t) * 1e-6, e.x, e.y, e.p);
    return std::string(line);
  })));
  ASSERT_TRUE(found.ok()) << found.error().text();
  EXPECT_TRUE(*found == all);
}

TEST(TableText, UnitsOfTimeInOtherWordsAreHeeded) {
  const auto in_ns = [](const Event& e) { return cat(e.t * 1000, ' ', e.x, ' ', e.y, ' ', int{e.p}); };
  for (const char* header :
       {"# resolution: 1 ns", "# tick: 1 ns", "# timestamp_resolution: 1e-9", "# time base: 1e-9 s",
        "# time in nanoseconds", "# ts_unit: ns", "ts_unit: ns", "resolution: 1 ns", "% timestamp unit = 10^-9 s",
        "# ticks per second: 1000000000", "# clock: 1 GHz, 1 tick = 1 ns", "# temporal resolution 1ns",
        "# sensor 64x48; times in ns since 1970", "# 1 ns per tick", "# exposure time: 10 ms, timestamps are in ns"}) {
    expect_events(cat(header, "\n") + text_of(events(), in_ns), header);
  }
  for (const char* header : {"# resolution: 64 x 48", "# exposure time: 10 ms", "# refractory period 1 ms",
                             "# tick: 1 us", "# frame interval in ms", "# recorded for 10 s", "# time offset: 5 ns"}) {
    expect_events(cat(header, "\n") + text_of(events(), txyp), header);
  }
  // The clock may be finer than the unit of fractions.
  expect_events("# resolution: 1 us\n" + text_of(events(),
                                                 [](const Event& e) {
                                                   char line[64];
                                                   std::snprintf(line, sizeof line, "%.6f %d %d %d",
                                                                 static_cast<double>(e.t) * 1e-6, e.x, e.y, e.p);
                                                   return std::string(line);
                                                 }),
                "seconds of a clock of 1 us");
  const auto odd = open_text("# tick: 100 ns\n" + text_of(events(), txyp));
  ASSERT_FALSE(odd.ok());
  EXPECT_EQ(odd.error().setting, Setting::kTimeUnit);
  EXPECT_TRUE(open_text("# tick: 100 ns\n" + text_of(events(), txyp), {.time_unit = TimeUnit::kMicroseconds}).ok());
}

TEST(TableText, UnitsThatAreAssumedAndImplausibleAreDoubted) {
  std::vector<std::string> warnings;
  const LogSink before = set_log_sink([&](LogLevel level, const std::string& text) {
    if (level == LogLevel::kWarning) warnings.push_back(text);
  });
  const auto doubts = [&](int64_t times, int64_t per, const OpenOptions& options = kPlain) {
    warnings.clear();
    EXPECT_TRUE(
        open_text(text_of(events(),
                          [&](const Event& e) { return cat(e.t * times / per, ' ', e.x, ' ', e.y, ' ', int{e.p}); }),
                  options)
            .ok());
    return warnings.empty() ? std::string() : warnings.front();
  };
  EXPECT_EQ(doubts(1, 1), "");
  EXPECT_NE(doubts(1000, 1).find("if they are ns"), std::string::npos) << doubts(1000, 1);
  EXPECT_NE(doubts(1, 1000).find("if they are ms"), std::string::npos) << doubts(1, 1000);
  EXPECT_EQ(doubts(1000, 1, {.time_unit = TimeUnit::kNanoseconds}), "");
  set_log_sink(before);
}

TEST(TableText, PolaritiesOf1And2AreSaidWithTheOptionThatExchangesThem) {
  std::string said;
  const LogSink before = set_log_sink([&](LogLevel, const std::string& text) { said += text; });
  const auto reader =
      open_text(text_of(events(), [](const Event& e) { return cat(e.t, ' ', e.x, ' ', e.y, ' ', e.p + 1); }));
  set_log_sink(before);
  ASSERT_TRUE(reader.ok()) << reader.error().text();
  EXPECT_EQ((*reader)->info().table->polarity, "1 = OFF, 2 = ON");
  EXPECT_NE(said.find("--invert-polarity"), std::string::npos);
}

TEST(TableText, PolaritiesOfEveryCodingKeepBothSigns) {
  using Pair = std::pair<const char*, const char*>;
  for (const auto& [off, on] : {Pair{"0", "1"},
                                {"-1", "1"},
                                {"1", "2"},
                                {"0", "255"},
                                {"255", "1"},
                                {"65535", "1"},
                                {"4294967295", "1"},
                                {"18446744073709551615", "1"},
                                {"False", "True"},
                                {"OFF", "ON"},
                                {"0.0", "1.0"},
                                {"-1", "+1"}}) {
    expect_events(
        text_of(events(),
                [&, o = off, n = on](const Event& e) { return cat(e.t, ' ', e.x, ' ', e.y, ' ', e.p == 1 ? n : o); }),
        off);
  }
}

TEST(TableText, AnotherPolarityFarBehindTellsTheCoding) {
  EventColumns all = random_stream({.events = 30000, .width = 64, .height = 48}).events;
  for (size_t i = 0; i < all.size(); ++i) all.p[i] = i > 25000;
  const auto found =
      read(open_text(text_of(all, [](const Event& e) { return cat(e.t, ' ', e.x, ' ', e.y, ' ', e.p + 1); })));
  ASSERT_TRUE(found.ok()) << found.error().text();
  EXPECT_TRUE(*found == all);
}

TEST(TableText, WhatIsNoTableIsRefusedWithItsLine) {
  std::string text;
  for (int i = 0; i < 1000; ++i) text += i % 30 == 0 ? "1,2,1,5\n" : "one,\x1b[31mtwo,3,four\n";
  const auto reader = open_text(text, {.format = "csv", .policy = DecodePolicy::kSkip});
  ASSERT_FALSE(reader.ok());
  EXPECT_EQ(reader.error().location, "a.csv: line 2");
  EXPECT_NE(reader.error().message.find("\\x1b[31mtwo"), std::string::npos) << reader.error().message;

  const auto page = open_text("<!DOCTYPE html>\n<html>not found</html>\n", {.format = "csv"});
  ASSERT_FALSE(page.ok());
  EXPECT_EQ(page.error().location, "a.csv: line 1");
  EXPECT_TRUE(open_text("t,x,y,p\n", {.format = "csv"}).ok());

  const std::string utf16("t\0,\0x\0,\0y\0,\0p\0\n\0", 16);
  const auto wide = open_text(utf16, {.format = "csv"});
  ASSERT_FALSE(wide.ok());
  EXPECT_NE(wide.error().message.find("UTF-16"), std::string::npos);
}

TEST(TableText, DamageNamesTheByteOfItsLine) {
  const std::string text = "t,x,y,p\n" + text_of(events(), txyp_commas);
  const size_t place = text.find('\n', text.size() / 2) + 1;
  auto reader = open_text(text.substr(0, place) + "rubbish\n" + text.substr(place));
  ASSERT_TRUE(reader.ok() && read_all(**reader).ok());
  EXPECT_EQ((*reader)->summary().of(Violation::kBadRecord), (ViolationCount{1, place}));
}

TEST(TableText, A32BitClockThatWrapsGoesOn) {
  const auto found = read(open_text("t,x,y,p\n" + text_of(events(), [](const Event& e) {
                                      return cat(static_cast<uint32_t>(e.t - 20000), ',', e.x, ',', e.y, ',', int{e.p});
                                    })));
  ASSERT_TRUE(found.ok()) << found.error().text();
  EXPECT_EQ(found->t.back() - found->t.front(), events().t.back() - events().t.front());
  EXPECT_TRUE(found->x == events().x);
}

TEST(Tables, FormatsWithAUnitOfTheirOwnRefuseTheOptions) {
  TestFolder folder;
  EventBatch batch;
  batch.events = events();
  for (const char* name : {"a.raw", "a_cd.dat", "a.hdf5"}) {
    write_recording(folder / name, batch, {.width = 64, .height = 48});
    EXPECT_EQ(open_recording(folder / name, {.time_unit = TimeUnit::kNanoseconds}).error().setting, Setting::kTimeUnit);
    EXPECT_EQ(open_recording(folder / name, {.columns = "txyp"}).error().setting, Setting::kColumns);
  }
}

template <typename T, typename From>
NpyArray column(const From& values, const std::function<double(double)>& change = {}) {
  std::vector<T> converted;
  for (const auto value : values) {
    const auto number = static_cast<double>(value);
    converted.push_back(static_cast<T>(change ? change(number) : number));
  }
  return make_npy<T>({converted.size()}, converted);
}

Result<EventColumns> read_arrays(const NpzArrays& arrays) {
  return read(open_recording(make_memory_source(encode_npz(arrays), "a.npz"),
                             {.format = "npz", .policy = DecodePolicy::kSkip}));
}

TEST(TableText, UnitsInNamesAreUnderstoodOrRefused) {
  const auto with = [](const char* name, int64_t times) {
    return cat(name, ",x,y,p\n") +
           text_of(events(), [times](const Event& e) { return cat(e.t * times, ',', e.x, ',', e.y, ',', int{e.p}); });
  };
  for (const char* name : {"tns", "nanos", "t (ns since start)", "time_ns_since_epoch", "Zeit in Nanosekunden",
                           "timestamp(int64 ns)", "t (10^-9 s)", "t_nano", "时间戳(纳秒)"}) {
    expect_events(with(name, 1000), name);
  }
  for (const char* name :
       {"t (100ns)", "t_10us", "t [0.1 ms]", "time [1/2000 s]", "t_ps", "t (min)", "t (h)", "time (x1000 ns)"}) {
    const auto reader = open_text(with(name, 1));
    if (std::string_view(name) == "time (x1000 ns)") {  // which are microseconds
      EXPECT_TRUE(reader.ok()) << name;
      continue;
    }
    ASSERT_FALSE(reader.ok()) << name;
    EXPECT_EQ(reader.error().setting, Setting::kTimeUnit) << name;
  }
  // A counter beside the times.
  expect_events("timestamp,time_us,x,y,p\n" + text_of(events(),
                                                      [i = 0](const Event& e) mutable {
                                                        return cat(i++, ',', e.t, ',', e.x, ',', e.y, ',', int{e.p});
                                                      }),
                "a counter");
}

TEST(TableText, PolaritiesAreWhatTheHeaderStates) {
  const auto inverted = text_of(events(), [](const Event& e) { return cat(e.t, ',', e.x, ',', e.y, ',', 1 - e.p); });
  for (const char* header : {"# polarity: 0 = ON, 1 = OFF", "# polarity (0=on, 1=off)", "# p: 1 = darker, 0 = brighter",
                             "# ON=0 OFF=1", "# polarity: 1 means OFF", "# polarity(off/on=1/0)"}) {
    expect_events(cat(header, "\nt,x,y,p\n") + inverted, header);
  }
  for (const char* header :
       {"# ON=1, OFF=0", "# p=0 is OFF", "# polarity(off/on=0/1)", "# c_on = 0", "# bias_off = 1"}) {
    expect_events(cat(header, "\nt,x,y,p\n") + text_of(events(), txyp_commas), header);
  }
  expect_events("t,x,y,polarity (0 = OFF, 1 = ON)\n" + text_of(events(), txyp_commas), "in a name");
  const auto negative = open_text(
      "t,x,y,p\n" + text_of(events(), [](const Event& e) { return cat(e.t, ',', e.x, ',', e.y, ',', -int{e.p}); }));
  ASSERT_FALSE(negative.ok());
  EXPECT_EQ(negative.error().setting, Setting::kColumns);
}

TEST(TableText, SizesOfOtherThingsAreNotThatOfTheSensor) {
  const auto size_with = [](const char* header) {
    const auto reader = open_text(cat(header, "\nt,x,y,p\n") + text_of(events(), txyp_commas));
    EXPECT_TRUE(reader.ok());
    return std::pair((*reader)->info().width, (*reader)->info().height);
  };
  for (const char* header :
       {"# pixel size: 18x18 um", "# tile size: 16x16", "# display size: 1920x1080", "# resolution of the mask: 32x24",
        "# kernel size 3x3", "# checkerboard: width=9 height=6"}) {
    EXPECT_EQ(size_with(header), (std::pair<size_t, size_t>(0, 0))) << header;
  }
  for (const char* header :
       {"# size (h, w): 48 64", "# resolution: 48x64 (HxW)", "# sensor_resolution: [48, 64]", "# sensor size 64x48"}) {
    EXPECT_EQ(size_with(header), (std::pair<size_t, size_t>(64, 48))) << header;
  }
}

TEST(Tables, UnusedRowsOfZerosAreDroppedAndCounted) {
  const EventColumns all = events();
  NpzArrays arrays;
  const auto padded = [](auto column) {
    column.resize(column.size() + 500);
    std::fill(column.end() - 500, column.end(), 0);
    return column;
  };
  arrays["x"] = column<int32_t>(padded(all.x));
  arrays["y"] = column<int32_t>(padded(all.y));
  arrays["p"] = column<uint8_t>(padded(all.p));
  arrays["t"] = column<int64_t>(padded(all.t));
  auto reader =
      open_recording(make_memory_source(encode_npz(arrays), "a.npz"), {.format = "npz", .policy = DecodePolicy::kSkip});
  ASSERT_TRUE(reader.ok()) << reader.error().text();
  EXPECT_TRUE(read_all(**reader)->events == all);
  EXPECT_EQ((*reader)->summary().of(Violation::kZeros).count, 500U);
}

TEST(TableArrays, UnitsInNamesAndPolaritiesWithoutASignAreRead) {
  const EventColumns all = events();
  NpzArrays arrays;
  arrays["xs"] = column<int32_t>(all.x);
  arrays["ys"] = column<double>(all.y);
  arrays["polarity"] = column<uint8_t>(all.p, [](double p) { return p == 1 ? 1 : 255; });
  arrays["timestamp_ns"] = column<int64_t>(all.t, [](double t) { return 1000 * t; });
  const auto found = read_arrays(arrays);
  ASSERT_TRUE(found.ok()) << found.error().text();
  EXPECT_TRUE(*found == all);
}

TEST(TableArrays, WhateverTheirNamesAndShapesAreRead) {
  const EventColumns all = events();
  const NpyArray x = column<int32_t>(all.x), y = column<int32_t>(all.y), p = column<uint8_t>(all.p),
                 t = column<int64_t>(all.t);
  std::vector<int64_t> rows;
  for (size_t i = 0; i < all.size(); ++i) rows.insert(rows.end(), {all.t[i], all.x[i], all.y[i], all.p[i]});
  const NpyArray matrix = make_npy<int64_t>({all.size(), 4}, rows);
  NpyArray standing = x, lying = t;
  standing.shape = {all.size(), 1};
  lying.shape = {1, all.size()};
  for (const NpzArrays& arrays : {NpzArrays{{"arr_0", t}, {"arr_1", x}, {"arr_2", y}, {"arr_3", p}},
                                  NpzArrays{{"x", standing}, {"y", y}, {"p", p}, {"t", lying}},
                                  NpzArrays{{"event_data", matrix}, {"label", column<int32_t>(std::vector<int>{3})}},
                                  NpzArrays{{"dataset_events_t", t}, {"x", x}, {"y", y}, {"p", p}}}) {
    const auto found = read_arrays(arrays);
    ASSERT_TRUE(found.ok()) << arrays.begin()->first << ": " << found.error().text();
    EXPECT_TRUE(*found == all) << arrays.begin()->first;
  }
}

TEST(TableArrays, ASignedClockThatWrapsGoesOn) {
  const EventColumns all = events();
  NpzArrays arrays;
  arrays["x"] = column<int32_t>(all.x);
  arrays["y"] = column<int32_t>(all.y);
  arrays["p"] = column<uint8_t>(all.p);
  arrays["t"] =
      column<int32_t>(all.t, [](double t) { return t <= 20000 ? 2147483647 - 20000 + t : t - 20001 - 2147483648; });
  const auto found = read_arrays(arrays);
  ASSERT_TRUE(found.ok()) << found.error().text();
  EXPECT_EQ(found->t.back() - found->t.front(), all.t.back() - all.t.front());
}

TEST(TableArrays, AFolderOfEvrealIsARecording) {
  TestFolder folder;
  const EventColumns all = events();
  std::vector<int16_t> xy;
  for (size_t i = 0; i < all.size(); ++i) {
    xy.push_back(static_cast<int16_t>(all.x[i]));
    xy.push_back(static_cast<int16_t>(all.y[i]));
  }
  std::filesystem::create_directory(folder / "seq");
  ASSERT_TRUE(write_npy(folder / "seq/events_xy.npy", make_npy<int16_t>({all.size(), 2}, xy)).ok());
  ASSERT_TRUE(write_npy(folder / "seq/events_p.npy", column<uint8_t>(all.p)).ok());
  ASSERT_TRUE(write_npy(folder / "seq/events_ts.npy", column<double>(all.t, [](double t) { return t * 1e-6; })).ok());
  ASSERT_TRUE(write_file(folder / "seq/metadata.json", std::string("{\"sensor_resolution\": [48, 64]}")).ok());
  auto reader = open_recording(folder / "seq", kPlain);
  ASSERT_TRUE(reader.ok()) << reader.error().text();
  EXPECT_EQ((*reader)->info().width, 64u);
  EXPECT_TRUE(read_all(**reader)->events == all);
}

}  // namespace
}  // namespace e2lf::recordings
