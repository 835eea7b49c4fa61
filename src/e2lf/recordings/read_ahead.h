// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// Reads the next batch of a recording in a separate thread while the caller processes the previous one. If only one
/// thread is permitted (num_threads()), reads on request. The reader must not be used otherwise during the lifetime of
/// this object.
class ReadAhead {
 public:
  explicit ReadAhead(RecordingReader& reader);
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;
  ~ReadAhead();

  /// Reads a batch as RecordingReader::read() does; exceptions of the reader are rethrown here.
  [[nodiscard]] Result<bool> read(EventBatch& batch);

 private:
  void run();

  RecordingReader& reader_;
  std::mutex mutex_;
  std::condition_variable changed_;
  EventBatch next_;
  Result<bool> more_ = true;      ///< result of the last read; nothing follows an end or an error
  std::exception_ptr exception_;  ///< exception of the last read
  bool is_read_ = false;          ///< whether next_, more_ and exception_ are ready
  bool is_stopped_ = false;
  std::thread thread_;
};

}  // namespace e2lf::recordings
