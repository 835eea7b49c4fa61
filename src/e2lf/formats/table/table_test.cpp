// SPDX-License-Identifier: MIT
#include <cstdio>
#include <functional>
#include <gtest/gtest.h>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"
#include "e2lf/recordings/recording.h"
#include "testing/test_streams.h"

/// Tables of events: the columns, the unit of the times and the polarities that they declare.
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

std::string txyp(const Event& e) {
  return cat(e.t, ',', e.x, ',', e.y, ',', int{e.p});
}
std::string txyp_ns(const Event& e) {
  return cat(e.t * 1000, ',', e.x, ',', e.y, ',', int{e.p});
}
std::string txyp_seconds(const Event& e) {
  char line[64];
  std::snprintf(line, sizeof line, "%.6f %d %d %d", static_cast<double>(e.t) * 1e-6, e.x, e.y, e.p);
  return line;
}

void expect_refused(Result<ReaderPtr> reader, const std::string& option, const std::string& what) {
  ASSERT_FALSE(reader.ok()) << what;
  EXPECT_EQ(reader.error().option, option) << what << ": " << reader.error().text();
}

TEST(TableText, ColumnsHaveKnownNames) {
  for (const char* header :
       {"t,x,y,p", "t, x, y, p", "ts;xs;ys;ps", "timestamp x y polarity", "time\tcol\trow\tpol",
        "Event_Time,event_x,event_y,event_polarity", "t [us] x (px) y (px) p", "time_stamp,x,y,p"}) {
    for (const char* mark : {"", "# ", "%", "//", "; "}) {
      expect_events(cat(mark, header, "\n") + text_of(events(), txyp), cat(mark, header).c_str());
    }
  }
  expect_events(
      "x,y,t,p\n" + text_of(events(), [](const Event& e) { return cat(e.x, ' ', e.y, ' ', e.t, ' ', int{e.p}); }),
      "another order");
  expect_events("t,x,y,p,label\n" + text_of(events(), [](const Event& e) { return txyp(e) + ",car"; }),
                "a column of words");
  expect_events("Unnamed: 0,t,x,y,p\n" + text_of(events(), [](const Event& e) { return "7," + txyp(e); }),
                "a column of pandas");
}

TEST(TableText, UnknownNamesAreRefusedWithTheSettingThatStatesTheOrder) {
  for (const char* header : {"Zeit,Spalte,Zeile,Vorzeichen", "t_offset,x,y,p", "t,t,x,y", "t,x,y,sign"}) {
    expect_refused(open_text(cat(header, "\n") + text_of(events(), txyp)), "columns", header);
    expect_events(cat(header, "\n") + text_of(events(), txyp), header,
                  {.policy = DecodePolicy::kSkip, .columns = "txyp"});
  }
  const std::string ticks = "t (100 ns),x,y,p\n" + text_of(events(), txyp);
  expect_refused(open_text(ticks), "columns", "ticks");
  expect_refused(open_text(ticks, {.columns = "txyp"}), "time_unit", "ticks");
  // Only a comment right above the events names them.
  expect_refused(open_text("# t,x,y,p\n# recorded today\n" + text_of(events(), txyp)), "columns", "far above");
  expect_refused(open_text("# columns: t,x,y,p\n" + text_of(events(), txyp)), "columns", "a sentence");
  expect_refused(
      open_text("ts.sec,ts.nsec,x,y,p\n" + text_of(events(), [](const Event& e) { return "17," + txyp(e); })),
      "columns", "two columns of times");
}

TEST(TableText, WithoutNamesOnlySecondsInFrontAreRead) {
  expect_events(text_of(events(), txyp_seconds), "t x y p in seconds");
  expect_events("64 48\n" + text_of(events(), txyp_seconds), "below a size");
  expect_events("%geometry:64,48\n" +
                    text_of(events(), [](const Event& e) { return cat(e.x, ',', e.y, ',', int{e.p}, ',', e.t); }),
                "as OpenEB writes them");
  expect_refused(open_text(text_of(events(), txyp)), "columns", "whole numbers");
  expect_events(text_of(events(), txyp), "an order", {.policy = DecodePolicy::kSkip, .columns = "txyp"});
  expect_events(text_of(events(), [](const Event& e) { return "7," + txyp(e); }), "a column more",
                {.policy = DecodePolicy::kSkip, .columns = "-txyp"});
  expect_refused(open_text(text_of(events(), txyp), {.columns = "txy"}), "columns", "three columns");
}

TEST(TableText, UnitsStandInNamesOrOptions) {
  for (const char* name :
       {"t_ns", "t(ns)", "timestamp[ns]", "Timestamp (ns)", "t [nsec]", "timestampNs", "time in nanoseconds"}) {
    expect_events(cat(name, ",x,y,p\n") + text_of(events(), txyp_ns), name);
  }
  expect_events("t,x,y,p\n" + text_of(events(), txyp_ns), "an option",
                {.policy = DecodePolicy::kSkip, .time_unit = TimeUnit::kNanoseconds});
  expect_events("t_ms x y p\n" + text_of(events(),
                                         [](const Event& e) {
                                           char line[64];
                                           std::snprintf(line, sizeof line, "%.3f %d %d %d",
                                                         static_cast<double>(e.t) / 1000, e.x, e.y, e.p);
                                           return std::string(line);
                                         }),
                "t_ms");
  EXPECT_EQ((*open_text("t,x,y,p\n" + text_of(events(), txyp)))->info().table->time_unit, std::string("us"));
}

TEST(TableText, WithoutAUnitWholeTimesAreMicrosecondsAndFractionsSeconds) {
  expect_events("t,x,y,p\n" + text_of(events(), txyp_seconds), "seconds");
  expect_events(
      "t,x,y,p\n" + text_of(events(), [](const Event& e) { return cat(e.t, ".0,", e.x, ',', e.y, ',', int{e.p}); }),
      ".0");
  expect_events("t x y p\n" + text_of(events(),
                                      [](const Event& e) {
                                        char line[128];
                                        std::snprintf(line, sizeof line, "%.18e %.18e %.18e %.18e",
                                                      static_cast<double>(e.t), static_cast<double>(e.x),
                                                      static_cast<double>(e.y), static_cast<double>(e.p));
                                        return std::string(line);
                                      }),
                "numpy.savetxt");
  expect_refused(open_text("t,x,y,p\n" + text_of(events(),
                                                 [](const Event& e) {
                                                   return cat((1'600'000'000'000'000 + e.t) * 1000, ',', e.x, ',', e.y,
                                                              ',', int{e.p});
                                                 })),
                 "time_unit", "ns since 1970");
  expect_refused(
      open_text("t,x,y,p\n" +
                text_of(events(), [](const Event& e) { return cat(e.t, ".5,", e.x, ',', e.y, ',', int{e.p}); })),
      "time_unit", "us with fractions");
}

TEST(TableText, PolaritiesAre01OrMinus11OrWords) {
  const auto with = [](const char* off, const char* on) {
    return "t,x,y,p\n" +
           text_of(events(), [=](const Event& e) { return cat(e.t, ' ', e.x, ' ', e.y, ' ', e.p == 1 ? on : off); });
  };
  using Pair = std::pair<const char*, const char*>;
  for (const auto& [off, on] : {Pair{"0", "1"}, {"-1", "1"}, {"-1", "+1"}, {"0.0", "1.0"}, {"False", "true"}}) {
    expect_events(with(off, on), off);
  }
  for (const auto& [off, on] : {Pair{"1", "2"}, {"0", "255"}, {"255", "1"}, {"0", "-1"}}) {
    expect_refused(open_text(with(off, on)), "", off);
    expect_events(with(off, on), off, {.policy = DecodePolicy::kSkip, .polarities = cat(off, ",", on)});
  }
  for (const char* text : {"1", "1,1", "a,b", "1,2,3"}) {
    expect_refused(open_text(with("1", "2"), {.polarities = text}), "", text);
  }
}

TEST(TableText, FractionsOfPixelsAreRefused) {
  const auto reader = open_text(
      "t,x,y,p\n" + text_of(events(), [](const Event& e) { return cat(e.t, ',', e.x, ".25,", e.y, ".5,", int{e.p}); }));
  ASSERT_FALSE(reader.ok());
  EXPECT_EQ(reader.error().code, ErrorCode::kUnsupported);
  const auto large = [](const Event& e) { return cat(e.t, ',', e.x * 480, ',', e.y, ',', int{e.p}); };
  expect_refused(open_text("t,x,y,p\n" + text_of(events(), large)), "sensor_width", "1/32 px");
}

TEST(TableText, MarksEndsOfLinesAndJoinedFilesLoseNothing) {
  const std::string plain = "t,x,y,p\n" + text_of(events(), txyp);
  const auto replaced = [&](const std::string& end) {
    std::string text;
    for (const char c : plain) text += c == '\n' ? end : std::string(1, c);
    return text;
  };
  const OpenOptions strict = {.policy = DecodePolicy::kStrict};
  expect_events("\xEF\xBB\xBF" + plain, "mark of UTF-8", strict);
  expect_events(replaced("\r\n"), "CRLF", strict);
  expect_events(replaced(",\n"), "separators at the end", strict);
  const size_t middle = plain.find('\n', plain.size() / 2) + 1;
  expect_events(plain.substr(0, middle) + "t,x,y,p\n" + plain.substr(middle), "joined", strict);
  const auto quoted = [](const Event& e) { return cat('"', e.t, "\"|\"", e.x, "\"|\"", e.y, "\"|\"", int{e.p}, '"'); };
  expect_events("\"t\"|\"x\"|\"y\"|\"p\"\n" + text_of(events(), quoted), "quoted", strict);
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

  const auto wide = open_text("\xFF\xFEt", {.format = "csv"});
  ASSERT_FALSE(wide.ok());
  EXPECT_EQ(wide.error().code, ErrorCode::kUnsupported);
}

TEST(TableText, DamageNamesTheByteOfItsLine) {
  const std::string text = "t,x,y,p\n" + text_of(events(), txyp);
  const size_t place = text.find('\n', text.size() / 2) + 1;
  auto reader = open_text(text.substr(0, place) + "rubbish\n" + text.substr(place));
  ASSERT_TRUE(reader.ok() && read_all(**reader).ok());
  EXPECT_EQ((*reader)->summary().of(Violation::kBadRecord), (ViolationCount{1, place}));
}

TEST(Tables, FormatsWithAUnitOfTheirOwnRefuseTheOptions) {
  TestFolder folder;
  EventBatch batch;
  batch.events = events();
  for (const char* name : {"a.raw", "a_cd.dat", "a.hdf5"}) {
    write_recording(folder / name, batch, {.width = 64, .height = 48});
    EXPECT_EQ(open_recording(folder / name, {.time_unit = TimeUnit::kNanoseconds}).error().option, "time_unit");
    EXPECT_EQ(open_recording(folder / name, {.columns = "txyp"}).error().option, "columns");
    EXPECT_EQ(open_recording(folder / name, {.polarities = "1,2"}).error().option, "columns");
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

TEST(TableArrays, NamesAndShapesDecideWhatIsRead) {
  const EventColumns all = events();
  const NpyArray x = column<int32_t>(all.x), y = column<double>(all.y), p = column<uint8_t>(all.p),
                 t = column<int64_t>(all.t), t_ns = column<int64_t>(all.t, [](double us) { return 1000 * us; });
  std::vector<double> rows;
  for (size_t i = 0; i < all.size(); ++i) {
    rows.insert(rows.end(),
                {static_cast<double>(all.t[i]) * 1e-6, double(all.x[i]), double(all.y[i]), double(all.p[i])});
  }
  const NpyArray matrix = make_npy<double>({all.size(), 4}, rows);
  for (const NpzArrays& arrays : {NpzArrays{{"xs", x}, {"ys", y}, {"polarity", p}, {"timestamp_ns", t_ns}},
                                  NpzArrays{{"event_data", matrix}, {"label", column<int32_t>(std::vector<int>{3})}},
                                  NpzArrays{{"dataset_events_t", t}, {"x", x}, {"y", y}, {"p", p}}}) {
    const auto found = read_arrays(arrays);
    ASSERT_TRUE(found.ok()) << arrays.begin()->first << ": " << found.error().text();
    EXPECT_TRUE(*found == all) << arrays.begin()->first;
  }
  EXPECT_FALSE(read_arrays({{"arr_0", t}, {"arr_1", x}, {"arr_2", y}, {"arr_3", p}}).ok());
  EXPECT_FALSE(read_arrays({{"t", t}, {"ts", t}, {"x", x}, {"y", y}, {"p", p}}).ok());
}

TEST(TableArrays, TimesThatFloatsDoNotResolveAreRefused) {
  const EventColumns all = events();
  NpzArrays arrays = {{"x", column<int32_t>(all.x)}, {"y", column<int32_t>(all.y)}, {"p", column<uint8_t>(all.p)}};
  arrays["t"] = column<float>(all.t, [](double us) { return 1.7e9 + us * 1e-6; });
  EXPECT_EQ(read_arrays(arrays).error().code, ErrorCode::kInvalidValue);
  std::vector<uint8_t> halves;  // 32 + i / 32 s
  for (size_t i = 0; i < all.size(); ++i) {
    const auto bits = static_cast<uint16_t>(0x5000 + i);
    halves.insert(halves.end(), {static_cast<uint8_t>(bits), static_cast<uint8_t>(bits >> 8)});
  }
  arrays["t"].type = "f2";
  arrays["t"].item_size = 2;
  arrays["t"].bytes = halves;
  EXPECT_EQ(read_arrays(arrays).error().code, ErrorCode::kInvalidValue);
}

}  // namespace
}  // namespace e2lf::recordings
