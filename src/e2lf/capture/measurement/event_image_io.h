// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/measurement/recorded_setup.h"
#include "e2lf/files/npy.h"

namespace e2lf::capture {

/// The content of a file of measurements: one entry per cycle, all of the same kind and shape.
template <typename Cycle>
struct CyclesFile {
  std::vector<Cycle> cycles;
  RecordedSetup setup = {};
};
using EventImageFile = CyclesFile<EventImages>;

/// Reads event images from
///  - an .npz file with `events` [cycles, N-1, y, x] or [N-1, y, x] (any integer type, or floats with integral values)
///  and optionally `codes`, `camera`, `views` and `findings`;
///  - an .npy file of either shape;
///  - a folder of event_image_00000.npy, ... as the paper's software writes them, [y, x] or [y, x, 1], one per
///  transition.
/// Fails with kInvalidValue (NaN, fractions, or values beyond int16), kShape (images of different sizes), kNotFound (no
/// such file or array, or a missing number in a folder), kUnsupported (another extension), and as setup_from_arrays()
/// and the readers of these formats do.
[[nodiscard]] Result<EventImageFile> read_event_images(const std::filesystem::path& path);

using MeasurementFile = CyclesFile<Measurement>;

/// Reads an .npz file whose arrays determine the kind: `images` float [cycles, N, y, x] are coded images, `events`
/// int16 [cycles, N-1, y, x] together with `images` [cycles, 1, y, x] are a hybrid, and `lens_array` float [cycles, y,
/// x] is the image behind a lens array. All other files are read by read_event_images(). Fails with kShape (axes or
/// sizes that do not match), kInvalidValue (values that are not finite), and as read_event_images() does.
[[nodiscard]] Result<MeasurementFile> read_measurements(const std::filesystem::path& path);

/// Writes measurements in the format that read_measurements() describes. All cycles must have the same kind and shape.
/// Fails with kIo.
[[nodiscard]] Result<void> write_measurements(const std::filesystem::path& path, const MeasurementFile& file);

/// Returns whether the names of the arrays are those of a measurement with intensity images.
[[nodiscard]] bool holds_images(const NpzArrays& arrays);

/// Writes an .npz file with `events` int16 [cycles, N-1, y, x] cycle by cycle, in constant memory for any number of
/// cycles. The file appears complete at finish(); if the writer is destroyed before, it leaves nothing.
/// read_event_images() and numpy read it.
class EventImageWriter {
 public:
  /// Starts writing to a temporary file beside `path`. Fails with kIo.
  [[nodiscard]] static Result<std::unique_ptr<EventImageWriter>> create(const std::filesystem::path& path);
  virtual ~EventImageWriter() = default;

  /// Stores the setup of the events in the file. Must be called before the first cycle is added.
  virtual void keep(const RecordedSetup& setup) = 0;

  /// Appends a cycle. All cycles must have the shape of the first one. Fails with kIo.
  [[nodiscard]] virtual Result<void> add(const EventImages& images) = 0;

  [[nodiscard]] virtual uint64_t cycles() const = 0;

  /// Adds the findings of the whole recording (RecordedSetup::findings), completes the file and moves it to its path.
  /// Fails with kIo, and with kInvalidValue if no cycle was added.
  [[nodiscard]] virtual Result<void> finish(const std::string& findings = "") = 0;
};

/// Writes an .npz file with `events` int16 [cycles, N-1, y, x] and the setup; see setup_to_arrays(). All cycles
/// must have the same shape. Fails with kIo.
[[nodiscard]] Result<void> write_event_images(const std::filesystem::path& path, const EventImageFile& file);

}  // namespace e2lf::capture
