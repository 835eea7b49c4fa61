// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "e2lf/cli/flags/cycle_options.h"
#include "e2lf/cli/flags/inputs.h"
#include "e2lf/cli/flags/recorded_setup.h"
#include "e2lf/cli/output/run_record.h"
#include "e2lf/model/model.h"

namespace e2lf::cli {

/// The bundled network for events of such patterns: e2lf-n4-camera where the camera has physical pixels, e2lf-n4 or
/// e2lf-n8 otherwise. Says which was taken. Nothing where the patterns are not those that they were trained for, or no
/// network is bundled. Fails as read_model does.
[[nodiscard]] Result<std::optional<model::Model>> bundled_network(const capture::Codes& codes,
                                                                  const std::optional<capture::SensorProfile>& camera,
                                                                  RunRecord& record);

/// The bundled network for some events, by the patterns of --codes or those that the events' file names. Fails with
/// kInvalidValue where nothing names them, and with kNotFound where no bundled network was trained for them.
[[nodiscard]] Result<std::optional<model::Model>> find_bundled_network(
    const std::filesystem::path& events, const CodesSource& source, const RecordedSetup& setup,
    const std::optional<capture::SensorProfile>& camera, RunRecord& record);

/// What cycles of a recording must have for the patterns that are named. Fails as read_patterns().
[[nodiscard]] Result<CycleFlags> wanted_cycles(CycleFlags flags, const CodesSource& source,
                                               const std::optional<model::Model>& model);

/// Whether anything but the model itself tells which patterns the camera showed.
[[nodiscard]] bool are_patterns_told(const std::optional<KnownCodes>& known);

/// Says that the patterns are only assumed.
void warn_of_assumed_patterns(const std::filesystem::path& events, const std::string& whose);

/// A network works for the patterns that it was trained for alone. Says where those are not, or may not be, the
/// events', and keeps it in the record.
void tell_patterns(const std::filesystem::path& events, const model::Model& model,
                   const std::optional<KnownCodes>& known, RunRecord& record);

/// The camera that recorded some events: that of --camera (`named`), else the one that their file names. Keeps it in
/// the record. Fails as load_camera() does.
[[nodiscard]] Result<std::optional<capture::SensorProfile>> camera_of_events(const std::string& named,
                                                                             const RecordedSetup& setup,
                                                                             RunRecord& record);

/// Gives a network that is told the camera this one, or leaves it with the one that it was made for. Says where a
/// network that is not told one has never seen such pixels.
void tell_camera(const std::optional<capture::SensorProfile>& camera, model::Model& model, RunRecord& record);

}  // namespace e2lf::cli
