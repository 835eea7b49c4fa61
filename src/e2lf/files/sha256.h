// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"

namespace e2lf {

/// Return the SHA-256 of a text or of bytes in hexadecimal, as sha256sum prints it.
[[nodiscard]] std::string sha256_of_bytes(std::span<const uint8_t> bytes);
[[nodiscard]] std::string sha256_of_text(const std::string& text);

/// Computes the SHA-256 of a file; for a folder, that of the sorted lines "hash  name" of all files in it and in its
/// subfolders, with names relative to the folder. Needs constant memory. Fails with kIo.
[[nodiscard]] Result<std::string> sha256_of(const std::filesystem::path& path, const ProgressFn& progress = {});

}  // namespace e2lf
