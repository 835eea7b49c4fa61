// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

namespace e2lf::cli {

/// Declares an option or argument that takes a model: a file, or the name of a bundled one with or without
/// ".safetensors", before which a file of exactly the name given goes. `model` becomes its path. Of a name that is
/// neither, Verb::run() says which ones are bundled.
CLI::Option* add_model_option(CLI::App& app, const std::string& flags, std::filesystem::path& model,
                              const std::string& help);
/// The same for several models.
CLI::Option* add_model_option(CLI::App& app, const std::string& flags, std::vector<std::filesystem::path>& models,
                              const std::string& help);

/// Declares --codes likewise: a file of patterns or a model.
CLI::Option* add_codes_option(CLI::App& app, std::filesystem::path& codes, const std::string& help);

}  // namespace e2lf::cli
