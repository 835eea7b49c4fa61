// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>

#include "e2lf/base/result.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/model/model.h"

namespace e2lf::pipeline {

/// Who tells the patterns or the sensor profile behind some events.
enum class ToldBy {
  kCaller,
  kEvents,  ///< the file of the events
  kModel,   ///< the network, which was trained for them
  kNobody,
};

/// The patterns, and what is known of the sensor for which they were made.
struct KnownCodes {
  capture::Codes codes;
  ToldBy told_by = ToldBy::kNobody;
  capture::SensorConstants constants;
  std::string event_model = "reference-aware";
  capture::MeasurementKind measurement = capture::MeasurementKind::kEventImages;  ///< the input of the model
};

/// Returns true if anything but the model itself tells which patterns the camera showed.
[[nodiscard]] bool are_patterns_told(const std::optional<KnownCodes>& known);

/// Returns the first of these patterns that there are: those of the caller, those of the file of the events, and those
/// of the model, which also tells the constants. Returns nothing if there are none.
[[nodiscard]] std::optional<KnownCodes> known_codes(const std::optional<capture::Codes>& of_caller,
                                                    const std::optional<capture::Codes>& of_events,
                                                    const model::Model* model);

/// Returns the patterns for a caller who names none: those of bundled_model(), or the built-in ones if it is missing.
/// Fails as read_patterns() does.
[[nodiscard]] Result<capture::Codes> usual_patterns();

/// Reads the patterns of a file of them or of a model file. Fails as read_codes() and read_model() do, and with
/// kNotFound if the model holds none.
[[nodiscard]] Result<capture::Codes> read_patterns(const std::filesystem::path& path);

}  // namespace e2lf::pipeline
