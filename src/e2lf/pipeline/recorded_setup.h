// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/recorded_setup.h"
#include "e2lf/capture/patterns/codes_header.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/files/options.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::pipeline {

/// Formats the setup as header lines of a recording.
[[nodiscard]] capture::HeaderLines header_of(const capture::RecordedSetup& setup);

/// Returns the notes that store the setup in the run record of a recording that was just written, for formats whose
/// header has no place for it.
[[nodiscard]] Json setup_notes(const capture::RecordedSetup& setup, const std::filesystem::path& recording);

/// Reads the setup of a recording from its header, or else from the run record beside it if the record describes a
/// recording of this size. Fails as capture::codes_from_header() and camera_from_header() do.
[[nodiscard]] Result<capture::RecordedSetup> recorded_setup(const std::filesystem::path& recording,
                                                            const recordings::RecordingInfo& info);

/// Returns the setup of a recording that is divided into cycles. If its patterns are those of the schedule, they are
/// reduced to the patterns between which the reader forms event images. The patterns are those of the caller, or else
/// those of the recording, or else those of the schedule. The orientation of the views is that of the schedule if it
/// states one.
[[nodiscard]] Result<capture::RecordedSetup> setup_of_cycles(
    const std::filesystem::path& recording, const cycles::CycleReader& reader,
    const std::optional<capture::Codes>& of_caller = std::nullopt);

/// Returns the colour filters (see capture::colour_filter_from_name()) of the sensor of a recording or of event images,
/// which their run record contains. Returns an empty string if it has none or describes other events.
[[nodiscard]] std::string recorded_colour_filter(const std::filesystem::path& events);
/// Returns the notes that store the colour filters in the record of events that were just written; none if `filter` is
/// empty.
[[nodiscard]] Json colour_filter_notes(const std::string& filter, const std::filesystem::path& events);

}  // namespace e2lf::pipeline
