// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/event_images.h"

namespace e2lf::capture {

/// Writes an .npz with `events` int16 [cycles, N-1, y, x] cycle by cycle, in constant memory, for any number of cycles.
/// The file appears at finish(), whole; destroyed without it, nothing is left behind. Read it with read_event_images()
/// or numpy.
class EventImageWriter {
 public:
  /// Starts beside `path`. Fails with kIo.
  [[nodiscard]] static Result<EventImageWriter> create(const std::filesystem::path& path);
  EventImageWriter(EventImageWriter&&) noexcept;
  ~EventImageWriter();

  /// The patterns [N, view_y, view_x] that the events were made with, `codes` in the file. Before the first cycle.
  void set_codes(const NpyArray& codes);

  /// The camera that recorded them, `camera` in the file; see camera_to_npy(). Before the first cycle.
  void set_camera(const NpyArray& camera);

  /// How the views come out, `views` in the file; see views_to_npy(). Before the first cycle.
  void set_views(const NpyArray& views);

  /// Appends a cycle; all cycles must have the shape of the first. Fails with kIo.
  [[nodiscard]] Result<void> add(const EventImages& images);

  [[nodiscard]] uint64_t cycles() const;

  /// Ends the file and puts it in place. Fails with kIo, and kInvalidValue when no cycle was added.
  [[nodiscard]] Result<void> finish();

 private:
  class Impl;
  explicit EventImageWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Writes the whole cycles of a file that was never finished, its codes, camera and views to `path`, and returns how
/// many there are; no file when there is none. Fails with kIo, and kFormat for a file of another kind.
[[nodiscard]] Result<uint64_t> recover_event_images(const std::filesystem::path& unfinished,
                                                    const std::filesystem::path& path);

}  // namespace e2lf::capture
