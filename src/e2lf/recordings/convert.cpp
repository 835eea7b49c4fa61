// SPDX-License-Identifier: MIT
#include "e2lf/recordings/convert.h"

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/files/file.h"
#include "e2lf/recordings/side_triggers.h"

namespace e2lf::recordings {
namespace {

void warn(ConvertReport& report, const std::string& message) {
  log_warning(message);
  report.warnings.push_back(message);
}

/// Returns the error that explains why there is nothing to write.
Error nothing_to_convert(const RecordingReader& reader) {
  const OpenOptions& options = reader.options();
  const std::vector<Loss> left_out = losses(reader.summary());
  std::string message = "there are no events and no triggers";
  if (options.from_us != INT64_MIN || options.to_us != INT64_MAX) {
    message += options.range == TimeOrigin::kZero ? " in this time after the first one" : " in this time on its clock";
  }
  if (!left_out.empty()) {
    message += cat(" (left out: ", loss_text(left_out), "); if its header states a wrong format, name the right one");
    return {ErrorCode::kInvalidValue, std::move(message), reader.name(), Setting::kInputFormat};
  }
  return {ErrorCode::kInvalidValue, message + "; `e2lf info` shows the content and the time range of the recording",
          reader.name()};
}

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

}  // namespace

Result<ConvertReport> convert_recording(RecordingReader& reader, const std::filesystem::path& output,
                                        const ConvertOptions& options) {
  E2LF_ASSIGN_OR_RETURN(auto writer, create_recording(output, options.format, reader.info()));
  SideTriggerWriter side(output);
  const bool has_side = output != "-" && !is_stream(output);
  const std::string name = output == "-" ? "standard output" : output.filename().string();
  const bool keeps_triggers = writer->holds_triggers() || has_side;
  ConvertReport report;
  ReadAhead ahead(reader);
  EventBatch batch;
  for (;;) {
    E2LF_ASSIGN_OR_RETURN(const bool more, ahead.read(batch));
    if (!more) break;
    for (uint8_t& polarity : batch.events.p) polarity ^= static_cast<uint8_t>(options.invert_polarity);
    E2LF_RETURN_IF_ERROR(writer->write(batch));
    if (!writer->holds_triggers() && has_side) E2LF_RETURN_IF_ERROR(side.write(batch.triggers));
    report.events += batch.events.size();
    (keeps_triggers ? report.triggers : report.lost_triggers) += batch.triggers.size();
    if (options.progress) options.progress(report.events, 0);
  }
  if (report.events + report.triggers + report.lost_triggers == 0) return nothing_to_convert(reader);
  E2LF_RETURN_IF_ERROR(writer->finish());
  E2LF_RETURN_IF_ERROR(side.finish());
  report.summary = reader.summary();

  if (report.triggers > 0 && !writer->holds_triggers()) {
    report.trigger_file = side.path().filename();
    warn(report, cat(name, ": the format cannot hold ", report.triggers, " triggers; they are in ",
                     side.path().filename().string(), " beside it"));
  }
  if (report.lost_triggers > 0) {
    warn(report, cat(name, ": the format cannot hold ", report.lost_triggers,
                     " triggers, which are lost; write to a file instead"));
  }
  return report;
}

}  // namespace e2lf::recordings
