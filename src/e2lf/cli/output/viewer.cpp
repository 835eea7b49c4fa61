// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/viewer.h"

#include <memory>
#include <utility>

#include "e2lf/view/document.h"

namespace e2lf::cli {

Result<void> write_comparison_page(const std::filesystem::path& path, const ComparedLightField& truth,
                                   const ComparedLightField& reconstruction,
                                   const std::optional<depth::DisparityError>& error) {
  view::Document document;
  for (const auto& [name, shown] : {std::pair("scene", &truth), std::pair("reconstruction", &reconstruction)}) {
    const lightfield::Shape& shape = shown->light_field.shape();
    E2LF_RETURN_IF_ERROR(view::check_browser_memory(shape, path));
    const auto cycles = std::make_shared<view::LightFieldCycles>();
    cycles->add(name, shown->light_field);
    document.add_light_field(name, cycles);
    if (!error) continue;
    document.add_disparity(document.num_items() - 1, {{shown->disparity}, depth::middle_view(shape)});
  }
  view::Quality quality = view::quality_of_pictures(truth.light_field, reconstruction.light_field);
  quality.disparity = error;
  quality.truth_source = "those of the scene";
  document.add_comparison(0, 1, {quality});
  return view::write_page(path, document);
}

}  // namespace e2lf::cli
