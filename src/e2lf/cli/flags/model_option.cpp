// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/model_option.h"

#include "e2lf/base/text.h"
#include "e2lf/cli/flags/option_types.h"
#include "e2lf/files/bundled_files.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

/// Throws the parser's exception for missing files.
fs::path find(const BundledKind& kind, const std::string& name) {
  auto path = find_file_or_bundled(kind, name);
  if (!path) throw CLI::FileError(path.error().text());
  return *std::move(path);
}

}  // namespace

CLI::Option* add_model_option(CLI::App& app, const std::string& flags, fs::path& model, const std::string& help) {
  const auto take = [&model](const CLI::results_t& names) {
    model = find(kBundledModels, names.back());
    return true;
  };
  return app.add_option(flags, take, help)->type_name(kModelType);
}

CLI::Option* add_model_option(CLI::App& app, const std::string& flags, std::vector<fs::path>& models,
                              const std::string& help) {
  const auto take = [&models](const CLI::results_t& names) {
    models.clear();
    for (const std::string& name : names) models.push_back(find(kBundledModels, name));
    return true;
  };
  return app.add_option(flags, take, help)->type_name(kModelType)->expected(1, CLI::detail::expected_max_vector_size);
}

CLI::Option* add_codes_option(CLI::App& app, fs::path& codes, const std::string& help) {
  const auto take = [&codes](const CLI::results_t& names) {
    codes = find(kBundledCodes, names.back());
    return true;
  };
  return app.add_option("--codes", take, help)->type_name(kCodesType);
}

}  // namespace e2lf::cli
