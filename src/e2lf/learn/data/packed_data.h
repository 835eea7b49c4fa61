// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/files/safetensors.h"

namespace e2lf::learn {

/// A light field or photograph of the packed data.
struct PackedPicture {
  std::string name;
  Tensor pixels;  ///< uint8; [8, 8, y, x] for a light field, [y, x] for a photograph
};

/// The content of a file made by `e2lf pack`. Does not require torch.
struct PackedData {
  std::vector<PackedPicture> light_fields, textures;
};

/// Returns whether any tensor has a name of the form "lightfield/..." or "texture/...", as `e2lf pack` writes them.
[[nodiscard]] bool is_packed_data(const Safetensors& file);

/// Separates the tensors of a file into light fields and textures. `location` names the file in errors. Fails with
/// kFormat (a tensor that is neither, or not U8) and with kShape, naming the tensor.
[[nodiscard]] Result<PackedData> sort_packed_data(Safetensors file, const std::string& location);

struct PackOptions {
  std::vector<std::filesystem::path> light_fields = {};  ///< files or folders of any kind that read_light_field() reads
  std::vector<std::filesystem::path> textures = {};  ///< images, or folders that are searched for .png, .jpg and .jpeg
};

struct PackSummary {
  size_t light_fields = 0, textures = 0;
  size_t bytes = 0;  ///< size of the pixels
};

/// Packs light fields and photographs into one .safetensors file, 8-bit grey, for training on any machine:
/// "lightfield/<name>" U8 [8, 8, y, x] and "texture/<folder>/<name>" U8 [y, x], named after the files without their
/// extensions. If a light field has more than 8x8 views, the central ones are taken. Does not require torch. Fails with
/// kExists, kInvalidValue (two inputs with the same name, an image smaller than 64x64 px, or nothing to pack) and as
/// the readers do.
[[nodiscard]] Result<PackSummary> pack(const std::filesystem::path& output, const PackOptions& options,
                                       const ProgressFn& progress = {});

}  // namespace e2lf::learn
