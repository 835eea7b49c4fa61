// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/recordings/event.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/io/bytes.h"

namespace e2lf::recordings {

/// Triggers of a recording whose format cannot hold them are stored in <name>_triggers.csv beside <name>.<extension>: a
/// header line, and one line "p,id,t" per trigger (t in microseconds). They may be in any order and are held in memory.

[[nodiscard]] std::filesystem::path side_trigger_path(const std::filesystem::path& recording);

/// Opens the triggers beside a recording. Returns null if there is no such file, or if `recording` is empty. Lines that
/// cannot be read are counted in the reader's summary (kBadRecord). Fails with kIo, and with kFormat if the file does
/// not begin with the names of the columns.
[[nodiscard]] Result<TriggersPtr> open_side_triggers(const std::filesystem::path& recording);

/// Returns the triggers in the text of a source.
[[nodiscard]] TriggersPtr make_side_triggers(SourcePtr source);

/// Writes the file. It appears at finish(), and only if there was a trigger.
class SideTriggerWriter {
 public:
  explicit SideTriggerWriter(const std::filesystem::path& recording) : path_(side_trigger_path(recording)) {}

  [[nodiscard]] Result<void> write(std::span<const Trigger> triggers);
  [[nodiscard]] Result<void> finish();
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  SinkPtr sink_;
};

}  // namespace e2lf::recordings
