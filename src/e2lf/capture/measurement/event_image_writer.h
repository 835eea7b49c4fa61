// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/measurement/recorded_setup.h"

namespace e2lf::capture {

/// Writes an .npz file with `events` int16 [cycles, N-1, y, x] cycle by cycle, in constant memory for any number of
/// cycles. The file appears complete at finish(); if the writer is destroyed before, it leaves nothing.
/// read_event_images() and numpy read it.
class EventImageWriter {
 public:
  /// Starts writing to a temporary file beside `path`. Fails with kIo.
  [[nodiscard]] static Result<EventImageWriter> create(const std::filesystem::path& path);
  EventImageWriter(EventImageWriter&&) noexcept;
  ~EventImageWriter();

  /// Stores the setup of the events in the file. Must be called before the first cycle is added.
  void keep(const RecordedSetup& setup);

  /// Appends a cycle. All cycles must have the shape of the first one. Fails with kIo.
  [[nodiscard]] Result<void> add(const EventImages& images);

  [[nodiscard]] uint64_t cycles() const;

  /// Adds the findings of the whole recording (RecordedSetup::findings), completes the file and moves it to its path.
  /// Fails with kIo, and with kInvalidValue if no cycle was added.
  [[nodiscard]] Result<void> finish(const std::string& findings = "");

 private:
  class Impl;
  explicit EventImageWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Writes an .npz file with `events` int16 [cycles, N-1, y, x] and the setup; see setup_to_arrays(). All cycles
/// must have the same shape. Fails with kIo.
[[nodiscard]] Result<void> write_event_images(const std::filesystem::path& path, const EventImageFile& file);

/// Copies the complete cycles of a file that was never finished, with its codes, camera and views, to `path`, and
/// returns their number. Writes no file if there are none. Fails with kIo, and with kFormat if `unfinished` is another
/// kind of file.
[[nodiscard]] Result<uint64_t> recover_event_images(const std::filesystem::path& unfinished,
                                                    const std::filesystem::path& path);

}  // namespace e2lf::capture
