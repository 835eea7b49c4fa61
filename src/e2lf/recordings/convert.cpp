// SPDX-License-Identifier: MIT
#include "e2lf/recordings/convert.h"

#include <exception>
#include <semaphore>
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
    return {ErrorCode::kInvalidValue, std::move(message), reader.name(), "event_format"};
  }
  return fail(ErrorCode::kInvalidValue, reader.name(),
              message + "; `e2lf info` shows the content and the time range of the recording");
}

/// Reads the next batch of a recording in a separate thread while the caller processes the previous one. If only one
/// thread is permitted (num_threads()), reads on request. The reader must not be used otherwise during the lifetime of
/// this object.
class ReadAhead {
 public:
  explicit ReadAhead(RecordingReader& reader) : reader_(reader) {
    const int threads = num_threads();
    if (threads == 1) return;
    thread_ = std::jthread([this, threads](const std::stop_token& stop) {
      set_num_threads(threads);  // each thread has its own setting
      for (size_t i = 0;; i = 1 - i) {
        free_.acquire();
        if (stop.stop_requested() || !fill(slots_[i])) return;
      }
    });
  }
  ~ReadAhead() {
    thread_.request_stop();
    free_.release();
  }

  /// Reads a batch as RecordingReader::read() does; exceptions of the reader are rethrown here. Nothing may be read
  /// after the end or an error.
  [[nodiscard]] Result<bool> read(EventBatch& batch) {
    if (!thread_.joinable()) return reader_.read(batch);
    full_.acquire();
    Slot& slot = slots_[taken_++ % 2];
    if (slot.exception) std::rethrow_exception(slot.exception);
    std::swap(batch, slot.batch);
    Result<bool> more = slot.more;
    free_.release();
    return more;
  }

 private:
  struct Slot {
    EventBatch batch;
    Result<bool> more = false;
    std::exception_ptr exception;
  };

  /// Reads to a slot. Returns false if it is the last one.
  bool fill(Slot& slot) {
    try {
      slot.more = reader_.read(slot.batch);
    } catch (...) {
      slot.more = false;
      slot.exception = std::current_exception();
    }
    const bool goes_on = slot.more && *slot.more;
    full_.release();
    return goes_on;
  }

  RecordingReader& reader_;
  Slot slots_[2];
  std::counting_semaphore<> free_{2}, full_{0};
  size_t taken_ = 0;
  std::jthread thread_;  ///< uses the members above
};

/// Writes the triggers beside a recording. The file appears at finish(), and only if there was a trigger.
class SideTriggerWriter {
 public:
  explicit SideTriggerWriter(const std::filesystem::path& recording) : path_(side_trigger_path(recording)) {}

  Result<void> write(const std::vector<Trigger>& triggers) {
    if (triggers.empty()) return {};
    std::string text;
    if (sink_ == nullptr) {
      E2LF_ASSIGN_OR_RETURN(sink_, open_file_sink(path_));
      text = "p,id,t\n";
    }
    for (const Trigger& trigger : triggers) text += cat(int{trigger.p}, ',', trigger.id, ',', trigger.t, '\n');
    return sink_->write(as_bytes(text));
  }
  Result<void> finish() { return sink_ == nullptr ? Result<void>() : sink_->commit(); }
  [[nodiscard]] std::string file_name() const { return path_.filename().string(); }

 private:
  std::filesystem::path path_;
  SinkPtr sink_;
};

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
    report.trigger_file = side.file_name();
    warn(report, cat(name, ": the format cannot hold ", report.triggers, " triggers; they are in ", side.file_name(),
                     " beside it"));
  }
  if (report.lost_triggers > 0) {
    warn(report, cat(name, ": the format cannot hold ", report.lost_triggers,
                     " triggers, which are lost; write to a file instead"));
  }
  return report;
}

}  // namespace e2lf::recordings
