// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/comparison_page.h"

#include "e2lf/view/page.h"

namespace e2lf::cli {

Result<void> write_comparison_page(const std::filesystem::path& path, const lightfield::LightField& truth,
                                   const lightfield::LightField& reconstruction) {
  view::Document document;
  for (const auto& [name, light_field] : {std::pair("scene", &truth), std::pair("reconstruction", &reconstruction)}) {
    E2LF_RETURN_IF_ERROR(view::check_browser_memory(light_field->shape(), path));
    const auto cycles = std::make_shared<view::LightFieldCycles>();
    cycles->add(name, *light_field);
    document.add_light_field(name, cycles);
  }
  document.add_comparison(0, 1, {view::psnr_of_views(truth, reconstruction)});
  return view::write_page(path, document);
}

}  // namespace e2lf::cli
