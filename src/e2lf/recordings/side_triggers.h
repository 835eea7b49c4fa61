// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/recordings/event.h"
#include "e2lf/recordings/io/byte_sink.h"
#include "e2lf/recordings/io/byte_source.h"
#include "e2lf/recordings/trigger_feed.h"

namespace e2lf::recordings {

/// Triggers of a recording whose format has no place for them: <name>_triggers.csv beside <name>.<extension>, a line
/// "p,id,t" each (t in microseconds) under a line that says so. They are read in any order, and held in memory.

[[nodiscard]] std::filesystem::path side_trigger_path(const std::filesystem::path& recording);

/// The triggers beside a recording; an empty feed when there is no such file (or `recording` is empty), and, with a
/// warning, when it holds events. A line that cannot be read is counted in the reader's summary (kBadRecord). Fails
/// with kIo.
[[nodiscard]] Result<TriggerFeed> open_side_triggers(const std::filesystem::path& recording);

/// The triggers in the text that a source holds.
[[nodiscard]] TriggerFeed make_side_trigger_feed(std::unique_ptr<ByteSource> source);

/// Writes the file; it appears at finish(), and only when there was a trigger.
class SideTriggerWriter {
 public:
  explicit SideTriggerWriter(const std::filesystem::path& recording) : path_(side_trigger_path(recording)) {}

  [[nodiscard]] Result<void> write(std::span<const Trigger> triggers);
  [[nodiscard]] Result<void> finish();
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::unique_ptr<ByteSink> sink_;
};

}  // namespace e2lf::recordings
