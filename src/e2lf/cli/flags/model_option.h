// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

namespace e2lf::cli {

/// Declares an option or argument that takes a model: a file, or the name of a bundled model with or without
/// ".safetensors". A file with exactly this name takes precedence. `model` is set to the path. If the name is neither,
/// Verb::run() lists the bundled models.
CLI::Option* add_model_option(CLI::App& app, const std::string& flags, std::filesystem::path& model,
                              const std::string& help);
/// Declares the same for several models.
CLI::Option* add_model_option(CLI::App& app, const std::string& flags, std::vector<std::filesystem::path>& models,
                              const std::string& help);

/// Declares --codes: a file of patterns, a model, or the name of a bundled model.
CLI::Option* add_codes_option(CLI::App& app, std::filesystem::path& codes, const std::string& help);

}  // namespace e2lf::cli
