// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// Reads the next batch of a recording on a thread of its own while the caller works on the one before. With one thread
/// allowed (num_threads()), reads when asked. Nobody else may use the reader until this is gone.
class ReadAhead {
 public:
  explicit ReadAhead(RecordingReader& reader);
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;
  ~ReadAhead();

  /// As RecordingReader::read(batch); what that throws is thrown here.
  [[nodiscard]] Result<bool> read(EventBatch& batch);

 private:
  void run();

  RecordingReader& reader_;
  std::mutex mutex_;
  std::condition_variable changed_;
  EventBatch next_;
  Result<bool> more_ = true;      ///< of the last read; nothing follows an end or an error
  std::exception_ptr exception_;  ///< of the last read
  bool is_read_ = false;          ///< next_, more_ and exception_ wait to be taken
  bool is_stopped_ = false;
  std::thread thread_;
};

}  // namespace e2lf::recordings
