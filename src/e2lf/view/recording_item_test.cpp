// SPDX-License-Identifier: MIT
#include <fstream>
#include <gtest/gtest.h>

#include "e2lf/view/document.h"
#include "testing/test_files.h"

namespace e2lf::view {
namespace {

/// A text recording of 200 events, and the ways to open it.
struct TestRecording {
  TestFolder folder;
  RecordingSource source;

  TestRecording() {
    std::ofstream file(folder / "events.csv");
    file << "t,x,y,p\n";
    for (int i = 0; i < 200; ++i) file << 1000 + 10 * i << ',' << i % 20 << ',' << i / 20 << ',' << i % 2 << '\n';
    source.open = [this](size_t width, size_t height) {
      recordings::OpenOptions options;
      options.width = width;
      options.height = height;
      return recordings::open_recording(folder / "events.csv", options);
    };
  }

  /// Returns the bytes of all frames.
  [[nodiscard]] std::vector<std::vector<uint8_t>> frames() const {
    Document document;
    EXPECT_TRUE(add_recording(document, "events", source, 4));
    EXPECT_EQ(Json::parse(document.description())["items"][0]["frames"].size(), 4U);
    std::vector<std::vector<uint8_t>> parts;
    for (const Part& part : document.parts()) parts.push_back(part().value());
    return parts;
  }
};

TEST(AddRecording, FramesAreTheSameWhereverTheSearchForCyclesEnds) {
  TestRecording recording;
  const auto alone = recording.frames();
  for (const size_t num_batches : {0, 1, 2, 100}) {
    recording.source.open_cycles = [&](const auto& on_batch) -> Result<cycles::CycleReader> {
      E2LF_ASSIGN_OR_RETURN(const auto reader, recording.source.open(20, 10));
      recordings::EventBatch batch;
      for (size_t i = 0; i < num_batches; ++i) {
        E2LF_ASSIGN_OR_RETURN(const bool more, reader->read(batch, recordings::RecordingReader::kMinBatch));
        if (!more) break;
        on_batch(batch);
      }
      return Error{ErrorCode::kInvalidValue, "there are no cycles", ""};
    };
    EXPECT_EQ(recording.frames(), alone) << num_batches;
  }
}

}  // namespace
}  // namespace e2lf::view
