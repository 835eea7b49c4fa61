// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/event_images.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/files/options.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/model/model.h"
#include "e2lf/view/light_field_cycles.h"

namespace e2lf::view {

/// Makes the bytes of a part: a PNG, or deflated int16. Called from any thread.
using Part = std::function<Result<std::vector<uint8_t>>()>;

/// What a page of the viewer shows: a description in JSON, and parts (pictures, counts) that it names by their number.
/// viewer/src/document.ts reads it.
class Document {
 public:
  /// A light field of one or more cycles. Each view becomes an 8-bit PNG: round(255 * clamp(value)). `notes` are shown
  /// beside the labels of the cycles: one for each, or none.
  void add_light_field(const std::string& name, const std::shared_ptr<LightFieldCycles>& cycles,
                       const std::vector<std::string>& notes = {});

  /// More will come: the page asks for the description again and again.
  void set_growing() { is_growing_ = true; }

  /// The disparity maps of a light field that was added, its number among the items: one map, or one for each cycle, px
  /// per view step of the pixels of view (view_y, view_x). Maps of another size than the views break the contract.
  /// Numbers are kept in thousandths, those beyond +-32 px are cut off; what is not finite is not known.
  void add_disparity(size_t item, const std::vector<lightfield::Image>& maps, size_t view_y, size_t view_x);

  /// Event images of one or more cycles, all of one shape; `codes` may be null.
  void add_event_images(const std::string& name, const std::vector<capture::EventImages>& cycles,
                        const capture::Codes* codes);

  void add_model(const model::Model& model);

  /// PSNR of each view of the second light field, clamped, for each cycle that both have; a first one of a single cycle
  /// is the truth of all. `first` and `second` are numbers of items, `psnr_db` is [cycle][view].
  void add_comparison(size_t first, size_t second, const std::vector<std::vector<double>>& psnr_db);

  /// Adds any item as viewer/src/document.ts describes it.
  void add_item(Json item) { items_.push_back(std::move(item)); }
  /// Adds a part and returns its number.
  size_t add_part(Part part);

  [[nodiscard]] size_t num_items() const { return items_.size(); }
  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }

  /// The description as JSON text that may stand in an HTML page.
  [[nodiscard]] std::string description() const;

 private:
  Json items_ = Json::array(), comparisons_ = Json::array();
  std::vector<Part> parts_;
  bool is_growing_ = false;
};

/// A part that holds these counts: int16, little-endian, deflated (zlib).
[[nodiscard]] Part counts_part(std::span<const int16_t> counts);

/// PSNR of each view, in view order; infinity where equal. Light fields of different shapes break the contract.
[[nodiscard]] std::vector<double> psnr_of_views(const lightfield::LightField& truth,
                                                const lightfield::LightField& reconstruction);

}  // namespace e2lf::view
