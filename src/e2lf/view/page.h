// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/view/document.h"

namespace e2lf::view {

/// Returns the viewer page, a single HTML file without data, as built from viewer/.
[[nodiscard]] std::string_view empty_page();

/// Writes the page with the document embedded, as one file that opens without a server. The parts are stored in base64,
/// which adds a third to their size. Fails as the parts do, and with kIo.
[[nodiscard]] Result<void> write_page(const std::filesystem::path& path, const Document& document,
                                      const ProgressFn& progress = {});

}  // namespace e2lf::view
