// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>

#include "e2lf/base/result.h"
#include "e2lf/files/options.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::live {

/// Records what is read, on and off. Each recording is a new file recording_000.raw ... (EVT3, with the header of the
/// source) that grows as events come, so that whatever ends the program leaves what had been read until then. All
/// functions may be called from any thread.
class Recorder {
 public:
  /// Recordings go to `folder`, which must exist; without one nothing can be recorded.
  Recorder(std::filesystem::path folder, recordings::RecordingInfo info);

  /// Begins a recording, or does nothing during one. Fails with kInvalidValue without a folder, and with kIo.
  [[nodiscard]] Result<void> begin();
  /// Ends the recording, if there is one. Fails with kIo.
  [[nodiscard]] Result<void> end();

  [[nodiscard]] bool is_recording() const;

  /// Appends a batch during a recording. What cannot be written ends the recording; json() tells of it.
  void write(const recordings::EventBatch& batch);

  /// {"can_record", "is_recording", "file", "bytes", "error"}: of the current recording, or of the last one.
  [[nodiscard]] Json json() const;

 private:
  [[nodiscard]] Result<void> finish();

  std::filesystem::path folder_, file_;
  recordings::RecordingInfo info_;
  mutable std::mutex mutex_;
  std::unique_ptr<recordings::RecordingWriter> writer_;
  std::shared_ptr<std::atomic<uint64_t>> bytes_ = std::make_shared<std::atomic<uint64_t>>(0);
  std::string error_;
  size_t number_ = 0;
};

}  // namespace e2lf::live
