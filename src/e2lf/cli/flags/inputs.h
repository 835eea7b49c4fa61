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

/// The sources of the aperture patterns of a verb: a model file or a file of codes.
struct CodesSource {
  std::filesystem::path model, codes;
};

/// Declares -m/--model and --codes.
void add_codes_options(CLI::App& app, CodesSource& source);

/// Reads the model if one was given, and adds its content to the record. Fails as read_model() does.
[[nodiscard]] Result<std::optional<model::Model>> read_named_model(const CodesSource& source, RunRecord& record);

/// Reads the patterns of --codes if it was given. Fails as pipeline::read_patterns() does.
[[nodiscard]] Result<std::optional<capture::Codes>> read_named_codes(const CodesSource& source);

/// Adds the file of these patterns to the record, and warns if they differ from those in the file of the events.
void note_named_codes(const CodesSource& source, const std::optional<capture::Codes>& codes,
                      const std::optional<capture::Codes>& of_events, RunRecord& record);

/// Returns the patterns of --codes, or else `of_events` (those in the file of the events), or else those of `model`, or
/// nothing if none of them exist. Warns if --codes and the file of the events differ.
[[nodiscard]] Result<std::optional<pipeline::KnownCodes>> find_codes(const CodesSource& source,
                                                                     const std::optional<model::Model>& model,
                                                                     const std::optional<capture::Codes>& of_events,
                                                                     RunRecord& record);

/// Reads the patterns of --codes, or else those of the model. If neither is given, uses those of the bundled model and
/// logs this, or the built-in ones if there is no bundled model. Fails with kNotFound if the model contains no
/// patterns.
[[nodiscard]] Result<pipeline::KnownCodes> load_codes(const CodesSource& source, RunRecord& record);

/// Reads a light field with read_light_field() and shows the progress.
[[nodiscard]] Result<lightfield::LightField> read_with_progress(const std::filesystem::path& path,
                                                                const lightfield::ReadOptions& options, bool is_quiet);

}  // namespace e2lf::cli
