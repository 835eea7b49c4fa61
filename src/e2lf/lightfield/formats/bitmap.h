// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::lightfield {

/// The depth of pictures for displays: 1 bit per pixel (white from 128 on) or 8 bits.
enum class BitDepth { k1, k8 };

/// Encodes a grey picture as PNG, or as uncompressed BMP with a grey palette. Fails with kInternal if libpng fails. A
/// colour picture breaks the contract.
[[nodiscard]] Result<std::vector<uint8_t>> encode_grey_png(const ByteImage& image, BitDepth depth);
[[nodiscard]] std::vector<uint8_t> encode_grey_bmp(const ByteImage& image, BitDepth depth);

}  // namespace e2lf::lightfield
