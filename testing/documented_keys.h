// SPDX-License-Identifier: MIT
// Compares the keys of a configuration with the table of a page.
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"

namespace e2lf {

/// Returns the keys that have no row "| `path` | default | ..." in `page`. Keys of the first object of a list have the
/// path of the list and "[]".
inline std::vector<std::string> undocumented_keys(const Json& defaults, const std::string& page,
                                                  const std::string& path = "") {
  std::vector<std::string> missing;
  for (const auto& [key, value] : defaults.items()) {
    const bool is_list = value.is_array() && !value.empty() && value[0].is_object();
    if (value.is_object() || is_list) {
      const auto inner = undocumented_keys(is_list ? value[0] : value, page, cat(path, key, is_list ? "[]." : "."));
      missing.insert(missing.end(), inner.begin(), inner.end());
      continue;
    }
    const auto has_row = [&](const std::string& shown) {
      return page.find(cat("\n| `", path, key, "` | ", shown, " |")) != std::string::npos;
    };
    const bool is_shown = has_row(value.is_null() ? "" : json_line(value)) ||
                          (value.is_number_float() && has_row(json_line(json_number(value.get<float>()))));
    if (!is_shown) missing.push_back(path + key);
  }
  return missing;
}

/// Returns the text of docs/<name>.
inline std::string page_text(const std::string& name) {
  const auto bytes = read_file(std::filesystem::path(E2LF_SOURCE_TREE) / "docs" / name).value();
  return {bytes.begin(), bytes.end()};
}

}  // namespace e2lf
