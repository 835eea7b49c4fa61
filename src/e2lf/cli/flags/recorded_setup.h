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

/// What events were made with, as far as anything tells.
struct RecordedSetup {
  std::optional<capture::Codes> codes;
  std::optional<capture::SensorProfile> camera;
  std::optional<capture::Orientation> views = {};  ///< how they come out; by itself, or as the camera says

  /// The camera does not say it.
  [[nodiscard]] bool has_own_views() const { return views && !(camera && camera->views == views); }
};

/// It as lines of a recording's header.
[[nodiscard]] capture::HeaderLines header_of(const RecordedSetup& setup);

/// Puts it beside event images, before the first cycle.
void keep_setup(const RecordedSetup& setup, capture::EventImageWriter& writer);

/// Keeps it in the run record of a recording that was just written, for formats whose header has no room.
void note_setup(RunRecord& record, const RecordedSetup& setup, const std::filesystem::path& recording);

/// What a recording was made with: as its header says, else the run record beside it, where that is of a recording of
/// this size. Fails as capture::codes_from_header() and camera_from_header() do.
[[nodiscard]] Result<RecordedSetup> recorded_setup(const std::filesystem::path& recording,
                                                   const recordings::RecordingInfo& info);

/// The same of event images. Fails as codes_from_npy() and camera_from_npy() do.
[[nodiscard]] Result<RecordedSetup> recorded_setup(const capture::MeasurementFile& file,
                                                   const std::filesystem::path& path);

/// The colour filters (capture::colour_filter_from_name()) over the sensor of a recording or event images, kept in
/// their run record. Empty where it says none, or is of other events.
[[nodiscard]] std::string recorded_colour_filter(const std::filesystem::path& events);
/// Keeps them in the record of events that were just written; "" keeps nothing.
void note_colour_filter(RunRecord& record, const std::string& filter, const std::filesystem::path& events);

}  // namespace e2lf::cli
