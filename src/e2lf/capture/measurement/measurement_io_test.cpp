// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "e2lf/capture/measurement/event_image_io.h"
#include "testing/test_files.h"

namespace e2lf::capture {
namespace {

using testing::HasSubstr;

/// Two cycles of a kind with N = 3 patterns of 8x16 px, every number different.
MeasurementFile two_cycles(MeasurementKind kind) {
  MeasurementFile file;
  float value = 0;
  for (int cycle = 0; cycle < 2; ++cycle) {
    Measurement measurement;
    measurement.kind = kind;
    if (has_events(kind)) measurement.events = EventImages(2, 8, 16);
    for (int16_t& count : measurement.events.values) count = static_cast<int16_t>(++value);
    if (const size_t images = num_images(kind, 3); images > 0) measurement.images = CodedIntensities(images, 8, 16);
    for (float& intensity : measurement.images.values) intensity = ++value / 1024;
    file.cycles.push_back(std::move(measurement));
  }
  return file;
}

TEST(MeasurementFile, EveryKindComesBackAsItWasWritten) {
  const TestFolder folder;
  for (const auto kind : {MeasurementKind::kEventImages, MeasurementKind::kCodedImages, MeasurementKind::kHybrid,
                          MeasurementKind::kLensArray}) {
    MeasurementFile file = two_cycles(kind);
    file.setup.codes = complement(Codes(3, 8, 8));
    ASSERT_TRUE(write_measurements(folder / "m.npz", file));
    const auto read = read_measurements(folder / "m.npz");
    ASSERT_TRUE(read) << read.error().text();
    ASSERT_EQ(read->cycles.size(), 2U);
    for (size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(read->cycles[i].kind, kind) << measurement_name(kind);
      EXPECT_EQ(read->cycles[i].events, file.cycles[i].events);
      EXPECT_EQ(read->cycles[i].images.values, file.cycles[i].images.values);
      EXPECT_EQ(read->cycles[i].height(), 8U);
      EXPECT_EQ(read->cycles[i].width(), 16U);
    }
    EXPECT_EQ(read->setup.codes, file.setup.codes);
  }
}

TEST(MeasurementFile, EventImagesAreReadByTheirOwnReader) {
  const TestFolder folder;
  ASSERT_TRUE(write_measurements(folder / "m.npz", two_cycles(MeasurementKind::kEventImages)));
  EXPECT_EQ(read_event_images(folder / "m.npz").value().cycles[1],
            two_cycles(MeasurementKind::kEventImages).cycles[1].events);
}

TEST(MeasurementFile, RefusesArraysThatDoNotFit) {
  const TestFolder folder;
  const auto error_of = [&](const NpzArrays& arrays) {
    EXPECT_TRUE(write_npz(folder / "m.npz", arrays));
    const auto read = read_measurements(folder / "m.npz");
    EXPECT_FALSE(read);
    return read ? Error{} : read.error();
  };
  const std::vector<float> values(64, 0.5F);
  const std::vector<int16_t> counts(64, 1);
  const auto images = make_npy(std::vector<size_t>{1, 1, 8, 8}, std::span<const float>(values));
  EXPECT_THAT(error_of({{"images", make_npy(std::vector<size_t>{8, 8}, std::span<const float>(values))}}).message,
              HasSubstr("expected [cycles, image, y, x]"));
  EXPECT_THAT(error_of({{"images", images},
                        {"events", make_npy(std::vector<size_t>{1, 4, 4, 4}, std::span<const int16_t>(counts))}})
                  .message,
              HasSubstr("image"));
  EXPECT_THAT(error_of({{"images", images},
                        {"events", make_npy(std::vector<size_t>{2, 1, 8, 4}, std::span<const int16_t>(counts))}})
                  .message,
              HasSubstr("with 2 of events"));
  std::vector<float> bad = values;
  bad[3] = std::numeric_limits<float>::infinity();
  EXPECT_THAT(error_of({{"lens_array", make_npy(std::vector<size_t>{1, 8, 8}, std::span<const float>(bad))}}).message,
              HasSubstr("not finite"));
}

TEST(MeasurementKind, NamesGoBothWays) {
  for (const auto kind : {MeasurementKind::kEventImages, MeasurementKind::kCodedImages, MeasurementKind::kHybrid,
                          MeasurementKind::kLensArray}) {
    EXPECT_EQ(choice_of(measurement_name(kind), kMeasurementKinds).value(), kind);
  }
  EXPECT_THAT(choice_of("spikes", kMeasurementKinds).error().message, HasSubstr("lens-array"));
}

}  // namespace
}  // namespace e2lf::capture
