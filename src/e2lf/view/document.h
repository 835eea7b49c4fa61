// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/depth/disparity.h"
#include "e2lf/depth/disparity_error.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/files/options.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/model/model.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::view {

/// One light field, or the light fields of the cycles of a recording. They are read when they are viewed, and the last
/// one is kept in memory. Once all cycles are there, all functions may be called from any thread.
class LightFieldCycles {
 public:
  /// Begins without cycles; add() adds them.
  LightFieldCycles() = default;

  /// Opens a light field of any format, a folder that contains `lightfield.npy`, or a folder of such folders
  /// (cycle_00000 ...), and reads the first one. Fails as read_light_field does, and with kUnsupported if the views
  /// need more than kMostBytes of browser memory.
  [[nodiscard]] static Result<std::shared_ptr<LightFieldCycles>> open(const std::filesystem::path& path,
                                                                      const lightfield::ReadOptions& options);
  static constexpr uint64_t kMostBytes = uint64_t{1} << 30;

  /// Adds a cycle, which stays in memory. Another shape than that of the first one breaks the contract.
  void add(const std::string& name, lightfield::LightField light_field);

  [[nodiscard]] size_t size() const { return paths_.size(); }
  [[nodiscard]] const lightfield::Shape& shape() const { return shape_; }
  [[nodiscard]] std::string label(size_t cycle) const;

  /// Reads a whole cycle. Fails as read_light_field does, and with kShape if it has another shape than the first one.
  [[nodiscard]] Result<std::shared_ptr<const lightfield::LightField>> read(size_t cycle);

  /// Returns a view, given by its number, as an 8-bit PNG. Fails as read() does.
  [[nodiscard]] Result<std::vector<uint8_t>> png(size_t cycle, size_t view);

 private:
  LightFieldCycles(std::vector<std::filesystem::path> paths, const lightfield::ReadOptions& options)
      : paths_(std::move(paths)), options_(options) {}

  using SharedLightField = std::shared_ptr<const lightfield::LightField>;

  std::vector<std::filesystem::path> paths_;
  lightfield::ReadOptions options_;
  lightfield::Shape shape_;
  std::vector<SharedLightField> added_;  ///< all cycles, if they were added
  std::mutex mutex_;                     ///< of the following
  SharedLightField kept_;                ///< the cycle read last
  size_t kept_cycle_ = 0;
};

/// Fails with kUnsupported if the views need too much browser memory; see LightFieldCycles::kMostBytes.
[[nodiscard]] Result<void> check_browser_memory(const lightfield::Shape& shape, const std::filesystem::path& path);

/// The figures of a reconstruction, as `e2lf eval` computes them.
struct Quality {
  std::vector<double> psnr_db;        ///< eval::psnr_of_views()
  eval::Tone tone;                    ///< eval::best_tone()
  std::vector<double> toned_psnr_db;  ///< with this tone
  std::optional<depth::DisparityError> disparity = {};
  std::string truth_source = {};  ///< of the true disparities, in words
};

/// Computes the figures without those of the disparity. Different shapes break the contract.
[[nodiscard]] Quality quality_of(const lightfield::LightField& truth, const lightfield::LightField& reconstruction);
/// The same for values limited to [0, 1], as files of pictures and the page store them.
[[nodiscard]] Quality quality_of_pictures(lightfield::LightField truth, lightfield::LightField reconstruction);

/// Disparity maps of one view, in px per view step: one, or one for each cycle.
struct DisparityMaps {
  std::vector<lightfield::Image> maps;
  depth::ViewIndex view;
  std::vector<lightfield::Image> confidences = {};  ///< of the same pixels, in [0, 1], if they are known
};

/// Makes the bytes of a part, which is a PNG or deflated int16. It may be called from any thread.
using Part = std::function<Result<std::vector<uint8_t>>()>;

/// The content of a viewer page: a description in JSON, and numbered parts (pictures, counts) that it refers to. It is
/// read by viewer/src/document.ts.
class Document {
 public:
  /// Adds a light field of one or more cycles. Each view becomes an 8-bit PNG: round(255 * clamp(value)).
  void add_light_field(const std::string& name, const std::shared_ptr<LightFieldCycles>& cycles);

  /// Marks the document as growing, so that the page requests the description repeatedly.
  void set_growing() { is_growing_ = true; }

  /// Adds disparity maps to a light field, given by its number among the items. Maps of another size than the views
  /// break the contract. Values are stored in thousandths and clamped to +-32 px; values that are not finite are stored
  /// as unknown.
  void add_disparity(size_t item, const DisparityMaps& disparity);

  /// Adds event images of one or more cycles, all of one shape. `codes` may be null.
  void add_event_images(const std::string& name, const std::vector<capture::EventImages>& cycles,
                        const capture::Codes* codes);

  void add_model(const model::Model& model);

  /// Adds the figures of the second light field for each cycle that both have. If the first one has a single cycle, it
  /// is the truth for all. `first` and `second` are numbers of items.
  void add_comparison(size_t first, size_t second, const std::vector<Quality>& cycles);

  /// Adds any item in the form described in viewer/src/document.ts.
  void add_item(Json item) { items_.push_back(std::move(item)); }
  /// Adds a part and returns its number.
  size_t add_part(Part part);

  [[nodiscard]] size_t num_items() const { return items_.size(); }
  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }

  /// Returns the description as JSON text that can be embedded in an HTML page.
  [[nodiscard]] std::string description() const;

 private:
  Json items_ = Json::array(), comparisons_ = Json::array();
  std::vector<Part> parts_;
  bool is_growing_ = false;
};

/// Opens a recording from its beginning, several times.
struct RecordingSource {
  /// Opens it for a sensor of this size if the recording does not state one; 0 = as stated.
  std::function<Result<std::unique_ptr<recordings::RecordingReader>>(size_t width, size_t height)> open;
  /// Opens its cycles; `on_batch` is called with everything that is read. If empty, no cycles are searched.
  std::function<Result<cycles::CycleReader>(const std::function<void(const recordings::EventBatch&)>& on_batch)>
      open_cycles;
};

/// Adds a recording as at most `num_frames` (>= 1) images of events accumulated over equal intervals, with its event
/// rate, its triggers and the cycles found in it (none if they cannot be determined). It is read twice, or three times
/// if the search for cycles ends early. Times are relative to the first event or trigger. Fails as the reader does, and
/// with kInvalidValue if there are no events.
[[nodiscard]] Result<void> add_recording(Document& document, const std::string& name, const RecordingSource& source,
                                         size_t num_frames);

/// Returns a part that holds these counts as int16, little-endian, deflated (zlib).
[[nodiscard]] Part counts_part(std::span<const int16_t> counts);

/// Returns the viewer page, a single HTML file without data, as built from viewer/.
[[nodiscard]] std::string_view empty_page();

/// Writes the page with the document embedded, as one file that opens without a server. The parts are stored in base64,
/// which adds a third to their size. Fails as the parts do, and with kIo.
[[nodiscard]] Result<void> write_page(const std::filesystem::path& path, const Document& document,
                                      const ProgressFn& progress = {});

}  // namespace e2lf::view
