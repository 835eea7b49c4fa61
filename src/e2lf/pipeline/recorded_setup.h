// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/event_image_writer.h"
#include "e2lf/capture/measurement/measurement_io.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/patterns/codes_header.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/files/options.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::pipeline {

/// The setup with which events were recorded, as far as it is known.
struct RecordedSetup {
  std::optional<capture::Codes> codes = {};
  std::optional<capture::SensorProfile> camera = {};
  std::optional<capture::Orientation> views = {};  ///< orientation of the views: its own, or that of the camera

  /// Returns whether the orientation is known and is not that of the camera.
  [[nodiscard]] bool has_own_views() const { return views && !(camera && camera->views == views); }
};

/// Formats the setup as header lines of a recording.
[[nodiscard]] capture::HeaderLines header_of(const RecordedSetup& setup);

/// Sets the setup of a file of event images. Must be called before its first cycle is added.
void keep_setup(const RecordedSetup& setup, capture::EventImageWriter& writer);

/// Returns the notes that store the setup in the run record of a recording that was just written, for formats whose
/// header has no place for it.
[[nodiscard]] Json setup_notes(const RecordedSetup& setup, const std::filesystem::path& recording);

/// Reads the setup of a recording from its header, or else from the run record beside it, if that describes a recording
/// of this size. Fails as capture::codes_from_header() and camera_from_header() do.
[[nodiscard]] Result<RecordedSetup> recorded_setup(const std::filesystem::path& recording,
                                                   const recordings::RecordingInfo& info);

/// Reads the setup of event images. Fails as codes_from_npy() and camera_from_npy() do.
[[nodiscard]] Result<RecordedSetup> recorded_setup(const capture::MeasurementFile& file,
                                                   const std::filesystem::path& path);

/// Returns the setup of a recording that is divided into cycles. Its patterns are those between which the event images
/// of the reader lie if they are those of the schedule, which may also state the orientation of the views.
[[nodiscard]] Result<RecordedSetup> setup_of_cycles(const std::filesystem::path& recording,
                                                    const cycles::CycleReader& reader);

/// Returns the colour filters (see capture::colour_filter_from_name()) of the sensor of a recording or of event images,
/// which their run record contains. Returns an empty string if it has none or describes other events.
[[nodiscard]] std::string recorded_colour_filter(const std::filesystem::path& events);
/// Returns the notes that store the colour filters in the record of events that were just written; none if `filter` is
/// empty.
[[nodiscard]] Json colour_filter_notes(const std::string& filter, const std::filesystem::path& events);

}  // namespace e2lf::pipeline
