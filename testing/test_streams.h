// SPDX-License-Identifier: MIT
#pragma once

#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "e2lf/recordings/recording.h"

/// Streams and files shared by the tests of the module.
namespace e2lf::recordings {

struct RandomStream {
  size_t events = 1000;
  size_t width = 640;
  size_t height = 480;
  int64_t begin_us = 1000;
  uint32_t max_gap_us = 10;  ///< between events
  size_t trigger_every = 0;  ///< events per trigger; 0 = none
  uint32_t seed = 1;
};

inline EventBatch random_stream(const RandomStream& options) {
  std::mt19937 random(options.seed);
  EventBatch batch;
  int64_t t_us = options.begin_us;
  for (size_t i = 0; i < options.events; ++i) {
    t_us += random() % (options.max_gap_us + 1);
    batch.events.push_back({static_cast<uint16_t>(random() % options.width),
                            static_cast<uint16_t>(random() % options.height), static_cast<uint8_t>(random() & 1),
                            t_us});
    if (options.trigger_every != 0 && i % options.trigger_every == 0) {
      batch.triggers.push_back({t_us, static_cast<uint16_t>(random() % 8), static_cast<uint8_t>(random() & 1)});
    }
  }
  return batch;
}

/// Returns the bytes of a recording in a format.
inline std::vector<uint8_t> encoded(const EventBatch& batch, const std::string& format,
                                    const RecordingInfo& info = {.width = 640, .height = 480}) {
  std::vector<uint8_t> bytes;
  const auto writer = create_recording(make_memory_sink(bytes), format, info).value();
  writer->write(batch).value();
  writer->finish().value();
  return bytes;
}

/// Writes a recording to a file; without a format, its extension selects it.
inline void write_recording(const std::filesystem::path& path, const EventBatch& batch, const RecordingInfo& info,
                            const std::string& format = "") {
  const auto writer = create_recording(path, format, info).value();
  writer->write(batch).value();
  writer->finish().value();
}

/// Opens a recording in memory, which the caller keeps.
inline Result<ReaderPtr> open_bytes(std::span<const uint8_t> bytes, const OpenOptions& options = {}) {
  return open_recording(make_memory_source(bytes), options);
}

/// What a reader returned.
struct Decoded {
  EventBatch batch;
  DecodeSummary summary;
  RecordingInfo info = {};
  bool operator==(const Decoded& other) const { return batch == other.batch && summary == other.summary; }
};

inline Decoded decoded(Result<ReaderPtr> opened) {
  const ReaderPtr reader = std::move(opened).value();
  EventBatch batch = read_all(*reader).value();
  return {std::move(batch), reader->summary(), reader->info()};
}

/// Reads a recording without warnings of damage.
inline Decoded decoded(SourcePtr source, OpenOptions options = {}) {
  options.policy = DecodePolicy::kSkip;
  return decoded(open_recording(std::move(source), options));
}
inline Decoded decoded(std::span<const uint8_t> bytes, const OpenOptions& options = {}) {
  return decoded(make_memory_source(bytes), options);
}

/// Returns the path of a data file ("events/other/sample.aedat4"), or an empty path if E2LF_DATA is not set or has no
/// such file.
inline std::filesystem::path data_file(const std::string& name) {
  const char* folder = std::getenv("E2LF_DATA");
  if (folder == nullptr) return {};
  const std::filesystem::path path = std::filesystem::path(folder) / name;
  return std::filesystem::exists(path) ? path : std::filesystem::path();
}

/// A folder for one test, which is removed with the object.
class TestFolder {
 public:
  TestFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "e2lf_events_XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  ~TestFolder() { std::filesystem::remove_all(path_); }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

#define E2LF_SKIP_WITHOUT(path) \
  if ((path).empty()) GTEST_SKIP() << "E2LF_DATA does not have this file"

}  // namespace e2lf::recordings
