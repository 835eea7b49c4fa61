// SPDX-License-Identifier: MIT
#include "e2lf/live/recorder.h"

#include <cerrno>
#include <fcntl.h>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/recordings/io/bytes.h"

namespace e2lf::live {
namespace fs = std::filesystem;

Recorder::Recorder(fs::path folder, recordings::RecordingInfo info)
    : folder_(std::move(folder)), info_(std::move(info)) {
  info_.format = "evt3";
}

Result<void> Recorder::begin() {
  const std::lock_guard lock(mutex_);
  if (writer_) return {};
  if (folder_.empty()) {
    return Error{ErrorCode::kInvalidValue, "no folder for recordings was given; start e2lf live with -o FOLDER", ""};
  }
  int descriptor = -1;
  do {
    file_ = folder_ / formatted("recording_%03zu.raw", number_++);
    descriptor = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (descriptor < 0 && errno == EEXIST);
  if (descriptor < 0) return fail_to("create", file_, errno);
  error_.clear();
  auto sink = recordings::make_descriptor_sink(descriptor, /*owned=*/true, file_.string());
  E2LF_ASSIGN_OR_RETURN(writer_, recordings::create_recording(std::move(sink), "evt3", info_));
  return {};
}

Result<void> Recorder::finish() {
  if (!writer_) return {};
  const Result<void> finished = writer_->finish();
  writer_.reset();
  if (!finished) error_ = finished.error().text();
  return finished;
}

Result<void> Recorder::end() {
  const std::lock_guard lock(mutex_);
  return finish();
}

bool Recorder::is_recording() const {
  const std::lock_guard lock(mutex_);
  return writer_ != nullptr;
}

void Recorder::write(const recordings::EventBatch& batch) {
  const std::lock_guard lock(mutex_);
  if (!writer_) return;
  const Result<void> written = writer_->write(batch);
  if (written) return;
  // The file keeps what was written before; of two errors, the first one states the cause.
  (void)finish();
  error_ = written.error().text();
  log_warning(cat("the recording has ended: ", error_));
}

Json Recorder::json() const {
  const std::lock_guard lock(mutex_);
  std::error_code error;
  const uintmax_t bytes = fs::file_size(file_, error);
  return {{"can_record", !folder_.empty()},
          {"is_recording", writer_ != nullptr},
          {"file", file_.string()},
          {"bytes", error ? 0 : bytes},
          {"error", error_}};
}

}  // namespace e2lf::live
