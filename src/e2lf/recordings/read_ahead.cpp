// SPDX-License-Identifier: MIT
#include "e2lf/recordings/read_ahead.h"

#include <utility>

#include "e2lf/base/threads.h"

namespace e2lf::recordings {

ReadAhead::ReadAhead(RecordingReader& reader) : reader_(reader) {
  const int threads = num_threads();
  if (threads == 1) return;
  thread_ = std::thread([this, threads] {
    set_num_threads(threads);  // each thread has its own setting
    run();
  });
}

ReadAhead::~ReadAhead() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    is_stopped_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void ReadAhead::run() {
  EventBatch batch;
  for (bool goes_on = true; goes_on;) {
    Result<bool> more = false;
    std::exception_ptr exception;
    try {
      more = reader_.read(batch);
    } catch (...) {
      exception = std::current_exception();
    }
    goes_on = !exception && more && *more;
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !is_read_ || is_stopped_; });
    if (is_stopped_) return;
    std::swap(next_, batch);
    more_ = std::move(more);
    exception_ = exception;
    is_read_ = true;
    changed_.notify_all();
  }
}

Result<bool> ReadAhead::read(EventBatch& batch) {
  if (!thread_.joinable()) return reader_.read(batch);
  std::unique_lock lock(mutex_);
  const bool has_ended = !is_read_ && (exception_ || !more_ || !*more_);
  if (!has_ended) {
    changed_.wait(lock, [this] { return is_read_; });
    std::swap(batch, next_);
    is_read_ = false;
    changed_.notify_all();
  } else {
    batch.clear();
  }
  if (exception_) std::rethrow_exception(exception_);
  return more_;
}

}  // namespace e2lf::recordings
