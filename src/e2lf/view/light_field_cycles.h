// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/light_field_io.h"

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

}  // namespace e2lf::view
