// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
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

/// The blocks of which a hash is made, for tests.
namespace e2lf::sha256 {

inline constexpr size_t kBlockBytes = 64;
using HashState = std::array<uint32_t, 8>;

/// The initial hash value of FIPS 180-4, section 5.3.3.
inline constexpr HashState kInitial = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                       0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};

/// Adds blocks of 64 bytes to the state (FIPS 180-4, section 6.2.2).
void add_blocks_scalar(HashState& state, const uint8_t* data, size_t blocks);

/// Does the same with the SHA instructions of x86, which are several times faster. The CPU must have them.
void add_blocks_with_sha_instructions(HashState& state, const uint8_t* data, size_t blocks);
[[nodiscard]] bool has_sha_instructions();

}  // namespace e2lf::sha256
