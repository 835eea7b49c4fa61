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

/// What events were made with, as far as anything tells.
struct RecordedSetup {
  std::optional<capture::Codes> codes = {};
  std::optional<capture::SensorProfile> camera = {};
  std::optional<capture::Orientation> views = {};  ///< how they come out; by itself, or as the camera says

  /// The camera does not say it.
  [[nodiscard]] bool has_own_views() const { return views && !(camera && camera->views == views); }
};

/// It as lines of a recording's header.
[[nodiscard]] capture::HeaderLines header_of(const RecordedSetup& setup);

/// Puts it beside event images, before the first cycle.
void keep_setup(const RecordedSetup& setup, capture::EventImageWriter& writer);

/// Returns the notes that keep it in the run record of a recording that was just written, for formats whose header has
/// no room.
[[nodiscard]] Json setup_notes(const RecordedSetup& setup, const std::filesystem::path& recording);

/// What a recording was made with: as its header says, else the run record beside it, where that is of a recording of
/// this size. Fails as capture::codes_from_header() and camera_from_header() do.
[[nodiscard]] Result<RecordedSetup> recorded_setup(const std::filesystem::path& recording,
                                                   const recordings::RecordingInfo& info);

/// The same of event images. Fails as codes_from_npy() and camera_from_npy() do.
[[nodiscard]] Result<RecordedSetup> recorded_setup(const capture::MeasurementFile& file,
                                                   const std::filesystem::path& path);

/// Returns the setup of a recording that is cut into cycles. Its patterns are those between which the event images of
/// the reader lie if they are those of the schedule, which may also tell how the views come out.
[[nodiscard]] Result<RecordedSetup> setup_of_cycles(const std::filesystem::path& recording,
                                                    const cycles::CycleReader& reader);

/// The colour filters (capture::colour_filter_from_name()) over the sensor of a recording or event images, kept in
/// their run record. Empty where it says none, or is of other events.
[[nodiscard]] std::string recorded_colour_filter(const std::filesystem::path& events);
/// Returns the notes that keep them in the record of events that were just written; none if `filter` is empty.
[[nodiscard]] Json colour_filter_notes(const std::string& filter, const std::filesystem::path& events);

}  // namespace e2lf::pipeline
