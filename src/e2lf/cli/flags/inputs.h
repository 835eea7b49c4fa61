// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/cli/flags/light_field_flags.h"
#include "e2lf/cli/output/run_record.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/model/model.h"
#include "e2lf/pipeline/patterns.h"

namespace e2lf::cli {

/// Where a verb takes its aperture patterns from: a model file or a file of codes.
struct CodesSource {
  std::filesystem::path model, codes;
};

/// Declares -m/--model and --codes.
void add_codes_options(CLI::App& app, CodesSource& source);

/// The model that was named, if one was: read once, and kept in the record by what was read. Fails as read_model does.
[[nodiscard]] Result<std::optional<model::Model>> read_named_model(const CodesSource& source, RunRecord& record);

/// The patterns of --codes, if it was given. Fails as pipeline::read_patterns() does.
[[nodiscard]] Result<std::optional<capture::Codes>> read_named_codes(const CodesSource& source);

/// Keeps the file of these patterns in the record. Warns where they are not those that the events' file holds.
void note_named_codes(const CodesSource& source, const std::optional<capture::Codes>& codes,
                      const std::optional<capture::Codes>& of_events, RunRecord& record);

/// What is known of the patterns behind some events: those of --codes, else `of_events` (what the events' own file
/// holds), else those of `model`. Nothing when none of them has any. Warns where --codes and the events' file differ.
[[nodiscard]] Result<std::optional<pipeline::KnownCodes>> find_codes(const CodesSource& source,
                                                                     const std::optional<model::Model>& model,
                                                                     const std::optional<capture::Codes>& of_events,
                                                                     RunRecord& record);

/// Reads the patterns: those of --codes, else those of the model. Where neither is given, takes those of the bundled
/// model and says so; without one, the built-in ones. Fails with kNotFound when the model holds no codes.
[[nodiscard]] Result<pipeline::KnownCodes> load_codes(const CodesSource& source, RunRecord& record);

/// read_light_field() with a line of progress.
[[nodiscard]] Result<lightfield::LightField> read_with_progress(const std::filesystem::path& path,
                                                                const lightfield::ReadOptions& options, bool is_quiet);

}  // namespace e2lf::cli
