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
  /// The disparities of the views (3, 3), (3, 4), (4, 3) and (4, 4) of a light field, px per view step, NaN where they
  /// are not known: float32 [4, y, x], or without elements if none is known.
  Tensor disparity = {};
};

/// The content of a file made by `e2lf pack`. Does not require torch.
struct PackedData {
  std::vector<PackedPicture> light_fields, textures;
};

/// Returns whether any tensor has a name of the form "lightfield/..." or "texture/...", as `e2lf pack` writes them
/// beside "disparity/...".
[[nodiscard]] bool is_packed_data(const Safetensors& file);

/// Separates the tensors of a file into light fields with their disparities and textures. `location` names the file in
/// errors. Fails with kFormat (a tensor that is none of them, or of another type) and with kShape, naming the tensor.
[[nodiscard]] Result<PackedData> sort_packed_data(Safetensors file, const std::string& location);

struct PackOptions {
  std::vector<std::filesystem::path> light_fields = {};  ///< files or folders of any kind that read_light_field() reads
  std::vector<std::filesystem::path> textures = {};  ///< images, or folders that are searched for .png, .jpg and .jpeg
  bool estimate_disparity = false;  ///< as depth::estimate_disparity() does, of the four central views of light fields
};

struct PackSummary {
  size_t light_fields = 0, textures = 0;
  size_t with_disparity = 0;  ///< of the light fields
  size_t bytes = 0;           ///< size of the tensors
};

/// Packs light fields and photographs into one .safetensors file, 8-bit grey, for training on any machine:
/// "lightfield/<name>" U8 [8, 8, y, x] and "texture/<folder>/<name>" U8 [y, x], named after the files without their
/// extensions. If a light field has more than 8x8 views, the central ones are taken. "disparity/<name>" F32 [4, y, x]
/// keeps the true disparities of view (4, 4) in the folder of a light field (depth::find_true_disparity()), and what
/// was estimated with a confidence above 0.2. Does not require torch. Fails with kExists, kInvalidValue (two inputs
/// with the same name, an image smaller than 64x64 px, or nothing to pack), and as the readers, depth::true_disparity()
/// and depth::estimate_disparity() do.
[[nodiscard]] Result<PackSummary> pack(const std::filesystem::path& output, const PackOptions& options,
                                       const ProgressFn& progress = {});

}  // namespace e2lf::learn
