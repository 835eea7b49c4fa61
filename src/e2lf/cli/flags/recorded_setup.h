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
#include "e2lf/cli/output/run_record.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::cli {

/// The setup with which events were recorded, as far as it is known.
struct RecordedSetup {
  std::optional<capture::Codes> codes;
  std::optional<capture::SensorProfile> camera;
  std::optional<capture::Orientation> views = {};  ///< orientation of the views: its own, or that of the camera

  /// Returns whether the orientation is known and is not that of the camera.
  [[nodiscard]] bool has_own_views() const { return views && !(camera && camera->views == views); }
};

/// Formats the setup as header lines of a recording.
[[nodiscard]] capture::HeaderLines header_of(const RecordedSetup& setup);

/// Sets the setup of a file of event images. Must be called before its first cycle is added.
void keep_setup(const RecordedSetup& setup, capture::EventImageWriter& writer);

/// Stores the setup in the run record of a recording that was just written, for formats whose header has no place for
/// it.
void note_setup(RunRecord& record, const RecordedSetup& setup, const std::filesystem::path& recording);

/// Reads the setup of a recording from its header, or else from the run record beside it, if that describes a recording
/// of this size. Fails as capture::codes_from_header() and camera_from_header() do.
[[nodiscard]] Result<RecordedSetup> recorded_setup(const std::filesystem::path& recording,
                                                   const recordings::RecordingInfo& info);

/// Reads the setup of event images. Fails as codes_from_npy() and camera_from_npy() do.
[[nodiscard]] Result<RecordedSetup> recorded_setup(const capture::MeasurementFile& file,
                                                   const std::filesystem::path& path);

/// Returns the colour filters (see capture::colour_filter_from_name()) of the sensor of a recording or of event images,
/// which their run record contains. Returns an empty string if it has none or describes other events.
[[nodiscard]] std::string recorded_colour_filter(const std::filesystem::path& events);
/// Stores the colour filters in the record of events that were just written; does nothing if `filter` is empty.
void note_colour_filter(RunRecord& record, const std::string& filter, const std::filesystem::path& events);

}  // namespace e2lf::cli
