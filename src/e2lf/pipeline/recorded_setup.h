// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/recorded_setup.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/files/bundled_files.h"  // for programs: it passes the folder of an installed package
#include "e2lf/files/options.h"
#include "e2lf/model/model.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::pipeline {

/// The source that states the patterns or the sensor profile of some events.
enum class StatedBy {
  kCaller,
  kEvents,  ///< the file of the events
  kModel,   ///< the network that was trained for them
  kNone,    ///< no source; they are unknown or assumed
};

/// Aperture patterns, and the properties of the sensor for which they were made.
struct KnownCodes {
  capture::Codes codes;
  StatedBy stated_by = StatedBy::kNone;
  capture::SensorConstants constants;
  std::string event_model = "reference-aware";
  capture::MeasurementKind measurement = capture::MeasurementKind::kEventImages;  ///< input of the model
};

/// Returns true if a source other than the model itself states which patterns the camera showed.
[[nodiscard]] bool are_patterns_stated(const std::optional<KnownCodes>& known);

/// Returns the patterns between which the event images of a network lie: `codes`, or capture::whole_cycle() of them if
/// the network takes the transitions of their whole cycle.
[[nodiscard]] capture::Codes codes_for(const model::Model& model, const capture::Codes& codes);

/// Returns the patterns of the caller, or else those of the file of the events, or else those of the model, which also
/// provides the constants. Returns nothing if no source has any.
[[nodiscard]] std::optional<KnownCodes> known_codes(const std::optional<capture::Codes>& of_caller,
                                                    const std::optional<capture::Codes>& of_events,
                                                    const model::Model* model);

/// Returns the default patterns: those of bundled_model(), or the built-in ones if it is missing.
/// Fails as read_patterns() does.
[[nodiscard]] Result<capture::Codes> usual_patterns();

/// Reads the patterns from a file of patterns or from a model file. Fails as read_codes() and read_model() do, and with
/// kNotFound if the model contains none.
[[nodiscard]] Result<capture::Codes> read_patterns(const std::filesystem::path& path);

/// Returns the notes that store the setup in the run record of a recording that was just written, for formats whose
/// header has no place for it.
[[nodiscard]] Json setup_notes(const capture::RecordedSetup& setup, const std::filesystem::path& recording);

/// Reads the setup of a recording from its header, or else from the run record beside it if the record describes a
/// recording of this size. Fails as capture::setup_from_header() does.
[[nodiscard]] Result<capture::RecordedSetup> recorded_setup(const std::filesystem::path& recording,
                                                            const recordings::RecordingInfo& info);

/// Returns the setup of a recording that is divided into cycles. If its patterns are those of the schedule, they are
/// reduced to the patterns between which the reader forms event images. The patterns are those of the recording, or
/// else those of the schedule. The orientation of the views is that of the schedule if it states one.
[[nodiscard]] Result<capture::RecordedSetup> setup_of_cycles(const std::filesystem::path& recording,
                                                             const cycles::CycleReader& reader);

}  // namespace e2lf::pipeline
