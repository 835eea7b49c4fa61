// SPDX-License-Identifier: MIT
#include "e2lf/recordings/timeline.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>
#include <random>

#include "e2lf/base/text.h"
#include "e2lf/files/npy.h"
#include "e2lf/recordings/codecs/metavision_hdf5/metavision_layout.h"
#include "e2lf/recordings/recording.h"
#include "testing/chunked_source.h"
#include "testing/test_aedat4.h"
#include "testing/test_evt4.h"
#include "testing/test_rosbag.h"
#include "testing/test_streams.h"

namespace e2lf::recordings {
namespace {

using Bytes = std::vector<uint8_t>;

/// Events in blocks of so many, as they are.
class ListedBlocks final : public EventBlocks {
 public:
  ListedBlocks(EventColumns events, size_t step) : events_(std::move(events)), step_(step) {}
  Result<bool> next(EventBatch& block, DecodeSummary&) override {
    block.clear();
    const size_t end = std::min(events_.size(), next_ + step_);
    block.events.append(events_, next_, end);
    return std::exchange(next_, end) < end;
  }
  Result<void> seek_before(int64_t) override {
    next_ = 0;
    return {};
  }

 private:
  EventColumns events_;
  size_t step_, next_ = 0;
};

Decoded read_in_blocks(const EventColumns& events, size_t step) {
  return decoded(std::make_unique<RecordingReader>(std::make_unique<ListedBlocks>(events, step),
                                                   RecordingInfo{.width = 640, .height = 480}, "list",
                                                   OpenOptions{.policy = DecodePolicy::kSkip}));
}

EventColumns in_order(const EventColumns& events) {
  std::vector<Event> list;
  for (size_t i = 0; i < events.size(); ++i) list.push_back(events[i]);
  std::stable_sort(list.begin(), list.end(), [](const Event& a, const Event& b) { return a.t < b.t; });
  EventColumns sorted;
  for (const Event& event : list) sorted.push_back(event);
  return sorted;
}

/// Events whose neighbours are swapped, pair by pair.
EventColumns swapped_pairs(size_t count, uint32_t max_gap_us = 200) {
  EventColumns events = random_stream({.events = count, .width = 64, .height = 48, .max_gap_us = max_gap_us}).events;
  for (size_t i = 0; i < count; ++i) events.t[i] += static_cast<int64_t>(i);  // no two at the same time
  for (size_t i = 0; i + 1 < count; i += 2) {
    const Event first = events[i];
    events.set(i, events[i + 1]);
    events.set(i + 1, first);
  }
  return events;
}

uint64_t late_events(const EventColumns& events) {
  uint64_t late = 0;
  int64_t latest_us = INT64_MIN;
  for (const int64_t t_us : events.t) {
    late += t_us < latest_us;
    latest_us = std::max(latest_us, t_us);
  }
  return late;
}

Bytes text_bytes(const std::string& text) {
  return {text.begin(), text.end()};
}

Bytes as_csv(const EventColumns& events) {
  std::string text = "x,y,p,t\n";
  for (size_t i = 0; i < events.size(); ++i) {
    text += cat(events.x[i], ",", events.y[i], ",", int{events.p[i]}, ",", events.t[i], "\n");
  }
  return text_bytes(text);
}

Bytes as_npz(const EventColumns& events) {
  NpzArrays arrays;
  const auto put = [&](const char* key, const auto& column) {
    arrays.emplace(key, make_npy({column.size()}, std::span(std::as_const(column))));
  };
  put("x", events.x);
  put("y", events.y);
  put("p", events.p);
  put("t", events.t);
  return encode_npz(arrays);
}

/// A format whose writer requires order: the records of sorted events, exchanged afterwards.
Bytes with_records_in_order_of(const EventColumns& events, const char* format, size_t record_bytes) {
  const EventColumns sorted = in_order(events);
  EventBatch batch;
  batch.events.append(sorted);
  const Bytes bytes = encoded(batch, format, {.width = 64, .height = 48});
  const size_t header = bytes.size() - events.size() * record_bytes;
  // Pairs are swapped, so that event i comes from place i ^ 1.
  Bytes swapped = bytes;
  for (size_t i = 0; i < events.size() / 2 * 2; ++i) {
    std::copy_n(bytes.begin() + static_cast<ptrdiff_t>(header + (i ^ 1) * record_bytes), record_bytes,
                swapped.begin() + static_cast<ptrdiff_t>(header + i * record_bytes));
  }
  return swapped;
}

std::vector<Event> slice_of(const EventColumns& events, size_t begin, size_t end) {
  std::vector<Event> part;
  for (size_t i = begin; i < std::min(end, events.size()); ++i) part.push_back(events[i]);
  return part;
}

EventColumns columns_of(const std::vector<Event>& events) {
  EventColumns columns;
  for (const Event& event : events) columns.push_back(event);
  return columns;
}

Bytes as_aedat4(const EventColumns& events) {
  std::vector<std::pair<int32_t, Bytes>> packets;
  for (size_t i = 0; i < events.size(); i += 100) {
    packets.emplace_back(0, formats::aedat4::event_packet(columns_of(slice_of(events, i, i + 100))));
  }
  return formats::aedat4::make_file(packets, formats::aedat4::Compression::kLz4);
}

formats::rosbag::TestMessages messages_of(const EventColumns& events, size_t events_each) {
  formats::rosbag::TestMessages messages;
  for (size_t i = 0; i < events.size(); i += events_each) {
    messages.emplace_back(0, formats::rosbag::list_message(columns_of(slice_of(events, i, i + events_each))));
  }
  return messages;
}

Bytes as_mcap(const EventColumns& events) {
  return formats::rosbag::mcap_file({{"/cam/events", formats::rosbag::kListType}}, messages_of(events, 100));
}

#ifdef E2LF_HAVE_SQLITE
Bytes as_sqlite(const EventColumns& events) {
  return formats::rosbag::sqlite_file({{"/cam/events", formats::rosbag::kListType}}, messages_of(events, 100));
}
#endif

/// Returns the bytes of an HDF5 file that `fill` fills.
template <typename Fill>
Bytes hdf5_bytes(const Fill& fill) {
  const hdf5_events::LibraryLock lock;
  const hdf5_events::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.get(), size_t{1} << 20, 0);
  const hdf5_events::Handle file(H5Fcreate("memory.hdf5", H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose);
  fill(file.get());
  H5Fflush(file.get(), H5F_SCOPE_GLOBAL);
  Bytes bytes(static_cast<size_t>(H5Fget_file_image(file.get(), nullptr, 0)));
  H5Fget_file_image(file.get(), bytes.data(), bytes.size());
  return bytes;
}

/// Adds a data set in chunks, with the groups of its path.
void put_dataset(hid_t file, const char* path, hid_t type, size_t count, const void* values) {
  const hsize_t length = count, chunk = 256;
  const hdf5_events::Handle space(H5Screate_simple(1, &length, nullptr), H5Sclose);
  const hdf5_events::Handle groups(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(groups.get(), 1);
  const hdf5_events::Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(layout.get(), 1, &chunk);
  const hdf5_events::Handle set(H5Dcreate2(file, path, type, space.get(), groups.get(), layout.get(), H5P_DEFAULT),
                                H5Dclose);
  ASSERT_GE(H5Dwrite(set.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), 0) << path;
}

Bytes as_hdf5(const EventColumns& events) {
  std::vector<hdf5_events::EventRecord> records;
  for (size_t i = 0; i < events.size(); ++i) {
    records.push_back({events.x[i], events.y[i], static_cast<int16_t>(events.p[i]), events.t[i]});
  }
  return hdf5_bytes([&](hid_t file) {
    put_dataset(file, "CD/events", hdf5_events::event_type().get(), records.size(), records.data());
  });
}

Bytes as_dsec(const EventColumns& events) {
  return hdf5_bytes([&](hid_t file) {
    put_dataset(file, "events/x", H5T_NATIVE_UINT16, events.size(), events.x.data());
    put_dataset(file, "events/y", H5T_NATIVE_UINT16, events.size(), events.y.data());
    put_dataset(file, "events/p", H5T_NATIVE_UINT8, events.size(), events.p.data());
    put_dataset(file, "events/t", H5T_NATIVE_INT64, events.size(), events.t.data());
  });
}

Bytes as_evt4(const EventColumns& events) {
  EventBatch batch;
  batch.events.append(events);
  return evt4_file(batch);
}

TEST(Disorder, OfNeighbouringPairsIsSortedInEveryFormat) {
  const EventColumns events = swapped_pairs(1000), sorted = in_order(events);
  const std::pair<const char*, Bytes> files[] = {{"dat", with_records_in_order_of(events, "dat", 8)},
                                                 {"csv", as_csv(events)},
                                                 {"npz", as_npz(events)},
                                                 {"aedat4", as_aedat4(events)},
                                                 {"mcap", as_mcap(events)},
#ifdef E2LF_HAVE_SQLITE
                                                 {"rosbag", as_sqlite(events)},
#endif
                                                 {"hdf5", as_hdf5(events)},
                                                 {"dsec", as_dsec(events)},
                                                 {"evt4", as_evt4(events)}};
  for (const auto& [format, bytes] : files) {
    SCOPED_TRACE(format);
    const OpenOptions options = {.format = format, .policy = DecodePolicy::kSkip};
    const Decoded file = decoded(open_bytes(bytes, options));
    EXPECT_EQ(file.batch.events, sorted);
    EXPECT_EQ(file.summary.out_of_order, late_events(events));
    EXPECT_EQ(file.summary.num_violations(), 0U);
    EXPECT_EQ(decoded(open_recording(chunked(bytes, 97), options)).batch, file.batch);
  }
}

TEST(Disorder, OfRawWordsLosesNothing) {
  // Words of EVT2 state the lower bits of times; a decoder gives an event before its predecessor the time of that one.
  EventBatch batch;
  for (int64_t i = 0; i < 1000; ++i)
    batch.events.push_back({static_cast<uint16_t>(i % 64), 1, 1, 64 * (i / 8) + i % 8});
  Bytes bytes = encoded(batch, "evt2", {.width = 64, .height = 48});
  const size_t words = 1000 + 125, header = bytes.size() - 4 * words;
  for (size_t i = 0; i < words; i += 9) {  // the second and third word after each TIME_HIGH
    const auto second = bytes.begin() + static_cast<ptrdiff_t>(header + 4 * (i + 2));
    std::swap_ranges(second, second + 4, second + 4);
  }
  const Decoded file = decoded(open_bytes(bytes, OpenOptions{.policy = DecodePolicy::kSkip}));
  EXPECT_EQ(file.batch.events.size(), batch.events.size());
  EXPECT_TRUE(std::is_sorted(file.batch.events.t.begin(), file.batch.events.t.end()));
}

TEST(Disorder, OfInterleavedPacketsOfABagIsSorted) {
  // Packets of 8 ms that begin every 4 ms.
  EventColumns events;
  for (int64_t packet = 0; packet < 50; ++packet) {
    for (int64_t i = 0; i < 20; ++i) {
      events.push_back({static_cast<uint16_t>(i), static_cast<uint16_t>(packet % 48), 1, 4000 * packet + 400 * i});
    }
  }
  const Decoded bag =
      decoded(formats::rosbag::mcap_file({{"/cam/events", formats::rosbag::kListType}}, messages_of(events, 20)));
  EXPECT_EQ(bag.batch.events, in_order(events));
  EXPECT_EQ(bag.summary.num_violations(), 0U);
}

TEST(Disorder, WithinTheWindowIsSortedWhateverTheBlocks) {
  // Blocks of 9 ms in reverse.
  EventColumns events = random_stream({.events = 20'000, .max_gap_us = 20}).events;
  for (size_t begin = 0; begin < events.size();) {
    const auto from = events.t.begin() + static_cast<ptrdiff_t>(begin);
    const auto to = std::lower_bound(from, events.t.end(), *from + 9000);
    const auto end = static_cast<size_t>(to - events.t.begin());
    std::reverse(from, to);
    std::reverse(events.x.begin() + static_cast<ptrdiff_t>(begin), events.x.begin() + static_cast<ptrdiff_t>(end));
    begin = end;
  }
  EventColumns expected = in_order(events);
  for (const size_t step : {size_t{1}, size_t{50}, size_t{3000}, events.size()}) {
    const Decoded read = read_in_blocks(events, step);
    EXPECT_EQ(read.batch.events, expected) << step;
    EXPECT_EQ(read.summary.out_of_order, late_events(events)) << step;
    EXPECT_EQ(read.summary.num_violations(), 0U) << step;
  }
}

TEST(Disorder, BeyondTheWindowIsDroppedAndCountedWhateverTheBlocks) {
  EventColumns events = random_stream({.events = 20'000, .max_gap_us = 20}).events;
  EventColumns kept;
  size_t num_late = 0;
  for (size_t i = 0; i < events.size(); ++i) {
    const bool is_late = i % 500 == 400;
    if (is_late) events.t[i] -= kDisorderUs + 200;
    if (is_late && i > 1000) {
      ++num_late;
    } else {
      kept.push_back(events[i]);
    }
  }
  events.erase(0, 1000);
  kept.erase(0, 1000);
  for (const size_t step : {size_t{1}, size_t{50}, size_t{3000}, events.size()}) {
    const Decoded read = read_in_blocks(events, step);
    EXPECT_EQ(read.batch.events, kept) << step;
    EXPECT_EQ(read.summary.of(Violation::kTimeBackwards).count, num_late) << step;
  }
}

TEST(Disorder, OfAWholeRecordingIsRefused) {
  const EventColumns sorted = random_stream({.events = 5000, .width = 64, .height = 48, .max_gap_us = 200}).events;
  std::vector<size_t> order(sorted.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::vector<EventColumns> recordings;
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  const auto by = [&](const auto& less) {
    std::stable_sort(order.begin(), order.end(), less);
    EventColumns events;
    for (const size_t i : order) events.push_back(sorted[i]);
    return events;
  };
  recordings.push_back(by([](size_t, size_t) { return false; }));
  std::sort(order.begin(), order.end());
  recordings.push_back(by([&](size_t a, size_t b) { return sorted.p[a] < sorted.p[b]; }));
  recordings.push_back(by([&](size_t a, size_t b) { return sorted.y[a] < sorted.y[b]; }));
  for (const EventColumns& events : recordings) {
    for (const Bytes& bytes : {as_csv(events), as_npz(events), as_aedat4(events)}) {
      const auto all = read_all(*open_bytes(bytes, {.policy = DecodePolicy::kSkip}).value());
      ASSERT_FALSE(all.ok());
      EXPECT_EQ(all.error().code, ErrorCode::kFormat);
      EXPECT_NE(all.error().message.find("sort"), std::string::npos);
    }
  }
}

TEST(Seeking, FindsSortedEvents) {
  const EventColumns events = swapped_pairs(200'000), sorted = in_order(events);
  for (const Bytes& bytes : {with_records_in_order_of(events, "dat", 8), as_csv(events)}) {
    auto reader = open_bytes(bytes).value();
    for (const size_t i : {size_t{150'000}, size_t{50}, size_t{199'999}}) {
      ASSERT_TRUE(reader->seek(sorted.t[i]).ok());
      const auto first = std::lower_bound(sorted.t.begin(), sorted.t.end(), sorted.t[i]) - sorted.t.begin();
      EventColumns expected;
      expected.append(sorted, static_cast<size_t>(first), sorted.size());
      EXPECT_EQ(read_all(*reader).value().events, expected) << i;
    }
  }
}

TEST(Seeking, StaysInTheRangeOfTheOptions) {
  const EventBatch stream = random_stream({.events = 20'000, .trigger_every = 100});
  const int64_t from_us = stream.events.t[5000], to_us = stream.events.t[15'000];
  for (const char* format : {"evt3", "dat", "csv"}) {
    OpenOptions options = {.from_us = from_us, .to_us = to_us};
    const Bytes bytes = encoded(stream, format);
    auto reader = open_bytes(bytes, options).value();
    for (const int64_t t_us : {stream.events.t[100], stream.events.t[10'000]}) {
      ASSERT_TRUE(reader->seek(t_us).ok());
      const EventColumns rest = read_all(*reader).value().events;
      EXPECT_EQ(rest.t.front(),
                *std::lower_bound(stream.events.t.begin(), stream.events.t.end(), std::max(t_us, from_us)))
          << format;
      EXPECT_LT(rest.t.back(), to_us) << format;
    }
  }
}

}  // namespace
}  // namespace e2lf::recordings
