// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>

#include "e2lf/base/result.h"
#include "e2lf/files/options.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::live {

/// Records the event stream on request. Each recording is a new file recording_000.raw, recording_001.raw, ... in EVT3
/// with the header of the source. The file grows as events arrive, so that it contains everything read so far however
/// the program ends. All functions may be called from any thread.
class Recorder {
 public:
  /// Recordings are written to `folder`, which must exist. If it is empty, begin() fails.
  Recorder(std::filesystem::path folder, recordings::RecordingInfo info);

  /// Starts a recording unless one is in progress. Fails with kInvalidValue (no folder), kNotFound and kIo.
  [[nodiscard]] Result<void> begin();
  /// Ends the recording if one is in progress. Fails with kIo.
  [[nodiscard]] Result<void> end();

  [[nodiscard]] bool is_recording() const;

  /// Appends a batch if a recording is in progress. A write error ends the recording and is reported by json().
  void write(const recordings::EventBatch& batch);

  /// Returns {"can_record", "is_recording", "file", "bytes", "error"} of the current or else of the last recording.
  [[nodiscard]] Json json() const;

 private:
  [[nodiscard]] Result<void> finish();

  std::filesystem::path folder_, file_;
  recordings::RecordingInfo info_;
  mutable std::mutex mutex_;
  std::unique_ptr<recordings::RecordingWriter> writer_;
  std::string error_;
  size_t number_ = 0;
};

}  // namespace e2lf::live
