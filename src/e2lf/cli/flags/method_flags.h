// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "e2lf/cli/verbs.h"
#include "e2lf/pipeline/field_sequence.h"
#include "e2lf/pipeline/method.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/run_record.h"

namespace e2lf::cli {

/// The flags of the verbs that reconstruct light fields.
struct MethodFlags {
  CodesSource codes;
  std::string precision = "auto", device = "cpu", gain = "auto", black = "auto", camera;
};

/// Declares -m, --codes, --camera, --precision and --device. `source` is what may state the camera.
void add_method_options(CLI::App& app, MethodFlags& flags, const std::string& source);

/// Declares --device.
void add_device_option(CLI::App& app, std::string& device);

/// Declares --gain and --black, for verbs whose output is a light field.
void add_tone_options(CLI::App& app, MethodFlags& flags);

/// Reads the model, the patterns and the camera that the flags name, adds them to the record, and takes over the
/// precision and the device. Fails as reading them does.
[[nodiscard]] Result<pipeline::MethodChoice> named_choice(const MethodFlags& flags, RunRecord& record);

/// Parses --gain (a positive number) and --black (a number of at least 0); "auto" leaves them to the method. Fails with
/// kInvalidValue.
[[nodiscard]] Result<pipeline::Tone> tone_of(const MethodFlags& flags);

/// Logs which network was chosen by default, and records the decisions behind a method: the network or patterns that
/// were chosen by default, and the sources of the patterns and the sensor profile. `passes` is the requested number of
/// passes.
void record_method(const pipeline::OpenedMethod& method, size_t passes, RunRecord& record);

}  // namespace e2lf::cli
