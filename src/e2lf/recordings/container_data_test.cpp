// SPDX-License-Identifier: MIT
#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>

#include "e2lf/files/file.h"
#include "e2lf/recordings/codecs/metavision_hdf5/metavision_layout.h"
#include "e2lf/recordings/convert.h"
#include "e2lf/recordings/recording.h"
#include "testing/chunked_source.h"
#include "testing/test_streams.h"

/// The containers among the data at hand against their known counts.
namespace e2lf::recordings {
namespace {

EventBatch read_file_of(const std::filesystem::path& path, const OpenOptions& options = {}) {
  auto reader = open_recording(path, options);
  EXPECT_TRUE(reader.ok()) << reader.error().text();
  if (!reader) return {};
  auto batch = read_all(**reader);
  EXPECT_TRUE(batch.ok()) << batch.error().text();
  EXPECT_EQ((*reader)->summary().num_violations(), 0u);
  return batch.ok() ? *std::move(batch) : EventBatch();
}

template <typename T>
int64_t sum(const Column<T>& column) {
  return std::accumulate(column.begin(), column.end(), int64_t{0});
}

TEST(ContainerData, EcfFileAndDatFileOfOneRecordingAreEqual) {
  const auto ecf = data_file("events/other/evt3_gen41_metavision_ecf.hdf5");
  const auto dat = data_file("events/other/evt3_gen41_cd.dat");
  E2LF_SKIP_WITHOUT(ecf);
  const EventBatch batch = read_file_of(ecf);
  ASSERT_EQ(batch.events.size(), 219596u);
  EXPECT_EQ(sum(batch.events.p), 115532);
  EXPECT_EQ(sum(batch.events.x), 159113225);
  EXPECT_EQ(sum(batch.events.y), 85638051);
  EXPECT_EQ(sum(batch.events.t) - 219596 * (batch.events.t.front() - 11718656), 2574324900467);
  EXPECT_TRUE(read_file_of(ecf, {.threads = 0}) == batch);
  EXPECT_TRUE(read_file_of(dat) == batch);
}

/// All entries of an index data set as (number, time), and its offset.
std::pair<std::vector<std::pair<uint64_t, int64_t>>, std::string> read_index(const std::filesystem::path& path,
                                                                             const std::string& name) {
  const hdf5_events::Handle file = e2lf::hdf5::open_file(path);
  auto shape = hdf5_events::open_dataset(file.get(), name, "");
  std::vector<hdf5_events::IndexRecord> records(shape->length);
  EXPECT_TRUE(
      hdf5_events::read_elements(*shape, hdf5_events::index_type().get(), 0, records.size(), records.data(), "").ok());
  std::vector<std::pair<uint64_t, int64_t>> entries;
  for (const hdf5_events::IndexRecord& record : records) entries.emplace_back(record.id, record.ts);
  for (const auto& [attribute, text] : e2lf::hdf5::read_text_attributes(shape->dataset.get())) {
    if (attribute == "offset") return {entries, text};
  }
  return {entries, ""};
}

TEST(ContainerData, WrittenIndexesAreThoseOfTheVendorsFile) {
  const auto vendor = data_file("events/other/evt3_hd_trigger_metavision_ecf.hdf5");
  E2LF_SKIP_WITHOUT(vendor);
  TestFolder folder;
  auto reader = open_recording(vendor);
  ASSERT_TRUE(convert_recording(**reader, folder / "ours.hdf5").ok());
  EXPECT_EQ(read_index(folder / "ours.hdf5", "CD/indexes"), read_index(vendor, "CD/indexes"));
  EXPECT_EQ(read_index(folder / "ours.hdf5", "EXT_TRIGGER/indexes"), read_index(vendor, "EXT_TRIGGER/indexes"));
  EXPECT_LE(std::filesystem::file_size(folder / "ours.hdf5"), std::filesystem::file_size(vendor));
}

TEST(ContainerData, EcfFileWithTriggersHasTheRecordingsSums) {
  const auto path = data_file("events/other/evt3_hd_trigger_metavision_ecf.hdf5");
  E2LF_SKIP_WITHOUT(path);
  const EventBatch batch = read_file_of(path);
  ASSERT_EQ(batch.events.size(), 82469u);
  EXPECT_EQ(sum(batch.events.p), 41439);
  EXPECT_EQ(sum(batch.events.x), 42078718);
  EXPECT_EQ(sum(batch.events.y), 31656267);
  EXPECT_EQ(sum(batch.events.t) - 82469 * (batch.events.t.front() - 14224870), 1222326831810);
  const std::vector<Trigger> triggers = {{330275, 0, 0}, {332275, 0, 1}};
  EXPECT_EQ(batch.triggers, triggers);
}

TEST(ContainerData, OldDatFileHasItsEvents) {
  const auto path = data_file("events/other/sample_ncars.dat");
  E2LF_SKIP_WITHOUT(path);
  const EventBatch batch = read_file_of(path);
  EXPECT_EQ(batch.events.size(), 2009u);
  EXPECT_EQ(batch.events[0], (Event{25, 8, 0, 0}));
  EXPECT_EQ(batch.events[1], (Event{67, 35, 0, 35}));
}

TEST(ContainerData, Aedat4FilesHaveTheirEvents) {
  for (const auto& [name, count, width] : {std::tuple("sample", 111954u, 320u), std::tuple("davis", 117667u, 346u)}) {
    const auto path = data_file(std::string("events/other/") + name + ".aedat4");
    E2LF_SKIP_WITHOUT(path);
    const EventBatch batch = read_file_of(path);
    EXPECT_EQ(batch.events.size(), count) << name;
    // The same through a pipe.
    const auto bytes = read_file(path).value();
    auto live = open_recording(std::make_unique<ChunkedSource>(bytes, std::vector<size_t>{777}, 10007)).value();
    EXPECT_TRUE(read_all(*live).value() == batch) << name;
    auto reader = open_recording(path);
    EXPECT_EQ((*reader)->info().width, width);
    EXPECT_EQ((*reader)->info().format, "aedat4");
  }
}

TEST(ContainerData, SeekingGivesTheRest) {
  for (const char* name : {"sample.aedat4", "davis.aedat4", "evt3_gen41_cd.dat", "evt3_gen41_metavision_ecf.hdf5"}) {
    const auto path = data_file(std::string("events/other/") + name);
    E2LF_SKIP_WITHOUT(path);
    const EventBatch all = read_file_of(path);
    for (const double part : {0.01, 0.5, 0.95}) {
      const auto event = static_cast<size_t>(part * static_cast<double>(all.events.size()));
      const int64_t from_us = all.events.t[event];
      const EventBatch rest = read_file_of(path, {.from_us = from_us});
      const auto begin = std::lower_bound(all.events.t.begin(), all.events.t.end(), from_us) - all.events.t.begin();
      EventColumns expected;
      expected.append(all.events, static_cast<size_t>(begin), all.events.size());
      EXPECT_TRUE(rest.events == expected) << name << " " << part;
      const auto is_late = [from_us](const Trigger& trigger) { return trigger.t >= from_us; };
      EXPECT_EQ(std::ssize(rest.triggers), std::count_if(all.triggers.begin(), all.triggers.end(), is_late)) << name;
    }
  }
}

}  // namespace
}  // namespace e2lf::recordings
