// SPDX-License-Identifier: MIT
// Writes DAT; declared in codecs.h.
#include <algorithm>
#include <vector>

#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"
#include "e2lf/formats/codecs.h"
#include "e2lf/formats/dat/dat_format.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::recordings::dat {
namespace {

constexpr uint16_t kMaxCoordinate = 0x3FFF;
constexpr uint16_t kMaxTriggerId = 0x3F;

class DatWriter final : public RecordingWriter {
 public:
  /// If `trigger_file` is empty, triggers are dropped.
  DatWriter(SinkPtr sink, const RecordingInfo& info, std::filesystem::path trigger_file)
      : sink_(std::move(sink)),
        info_(info),
        trigger_file_(std::move(trigger_file)),
        check_(most_pixels(info.width), most_pixels(info.height), sink_->name()) {}

  Result<void> begin() { return sink_->write(as_bytes(make_header(info_, kTypeCd))); }

  bool holds_triggers() const override { return !trigger_file_.empty(); }

  Result<void> write(const EventBatch& batch) override {
    E2LF_RETURN_IF_ERROR(check_(batch));
    const EventColumns& events = batch.events;
    buffer_.resize(events.size() * kRecordBytes);
    for (size_t i = 0; i < events.size(); ++i) {
      E2LF_RETURN_IF_ERROR(check_time(events.t[i], unwrap_event_));
      const uint32_t place = static_cast<uint32_t>(events.p[i]) << 28 | static_cast<uint32_t>(events.y[i]) << 14 |
                             static_cast<uint32_t>(events.x[i]);
      store_le(&buffer_[i * kRecordBytes], static_cast<uint32_t>(events.t[i]));
      store_le(&buffer_[i * kRecordBytes + 4], place);
    }
    E2LF_RETURN_IF_ERROR(sink_->write(buffer_));
    return holds_triggers() ? write_triggers(batch.triggers) : Result<void>{};
  }

  Result<void> finish() override {
    if (trigger_sink_) E2LF_RETURN_IF_ERROR(trigger_sink_->commit());
    return sink_->commit();
  }

 private:
  /// Limits the sensor's size to the coordinates of the format; 0 = unknown.
  static size_t most_pixels(size_t size) {
    constexpr size_t kMost = kMaxCoordinate + size_t{1};
    return size == 0 ? kMost : std::min(size, kMost);
  }

  Result<void> write_triggers(const std::vector<Trigger>& triggers) {
    if (triggers.empty()) return {};
    if (!trigger_sink_) {
      E2LF_ASSIGN_OR_RETURN(trigger_sink_, open_file_sink(trigger_file_));
      E2LF_RETURN_IF_ERROR(trigger_sink_->write(as_bytes(make_header(info_, kTypeTrigger))));
    }
    buffer_.resize(triggers.size() * kRecordBytes);
    for (size_t i = 0; i < triggers.size(); ++i) {
      const Trigger& trigger = triggers[i];
      E2LF_RETURN_IF_ERROR(check_time(trigger.t, unwrap_trigger_));
      if (trigger.id > kMaxTriggerId) {
        return Error{ErrorCode::kInvalidValue,
                     cat("trigger id ", trigger.id, " does not fit into DAT; write HDF5 instead"), sink_->name()};
      }
      store_le(&buffer_[i * kRecordBytes], static_cast<uint32_t>(trigger.t));
      store_le(&buffer_[i * kRecordBytes + 4], static_cast<uint32_t>(trigger.id) << 26 | trigger.p);
    }
    return trigger_sink_->write(buffer_);
  }

  /// Checks that a reader of the low 32 bits will obtain the same time.
  Result<void> check_time(int64_t t_us, TimeUnwrapper<32>& unwrap) const {
    if (unwrap(static_cast<uint32_t>(t_us)) == t_us) [[likely]] {
      return {};
    }
    return Error{ErrorCode::kInvalidValue,
                 cat("time ", t_us,
                     " us cannot be recovered from its low 32 bits; begin at zero or write another format, e.g. .hdf5"),
                 sink_->name(), Setting::kShiftTime};
  }

  SinkPtr sink_;
  RecordingInfo info_;
  std::filesystem::path trigger_file_;
  BatchCheck check_;
  SinkPtr trigger_sink_;
  std::vector<uint8_t> buffer_;
  TimeUnwrapper<32> unwrap_event_, unwrap_trigger_;
};

Result<WriterPtr> start(SinkPtr sink, const RecordingInfo& info, std::filesystem::path trigger_file) {
  auto writer = std::make_unique<DatWriter>(std::move(sink), info, std::move(trigger_file));
  E2LF_RETURN_IF_ERROR(writer->begin());
  return WriterPtr(std::move(writer));
}

}  // namespace

Result<WriterPtr> create(SinkPtr sink, const RecordingInfo& info) {
  return start(std::move(sink), info, {});
}

Result<WriterPtr> create_file(const std::filesystem::path& path, const RecordingInfo& info) {
  E2LF_ASSIGN_OR_RETURN(auto sink, open_file_sink(path));
  return start(std::move(sink), info, trigger_path(path));
}

}  // namespace e2lf::recordings::dat
