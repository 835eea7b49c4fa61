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

/// One light field, or those of the cycles of a recording, read when they are looked at; the last one is kept in
/// memory. png() may be called from any thread.
class LightFieldCycles {
 public:
  /// `path` is a light field of any format, a folder that holds `lightfield.npy`, or a folder of such (cycle_00000
  /// ...). Reads the first one. Fails as read_light_field does, and with kUnsupported where the views need more than
  /// kMostBytes of a browser's memory.
  [[nodiscard]] static Result<std::shared_ptr<LightFieldCycles>> open(const std::filesystem::path& path,
                                                                      const lightfield::ReadOptions& options);
  static constexpr uint64_t kMostBytes = uint64_t{1} << 30;

  [[nodiscard]] size_t size() const { return paths_.size(); }
  [[nodiscard]] const lightfield::Shape& shape() const { return shape_; }
  [[nodiscard]] std::string label(size_t cycle) const;

  /// A whole cycle. Fails as read_light_field does, and with kShape where it is not like the first one.
  [[nodiscard]] Result<std::shared_ptr<const lightfield::LightField>> read(size_t cycle);

  /// A view (its number) as an 8-bit PNG. Fails as read() does.
  [[nodiscard]] Result<std::vector<uint8_t>> png(size_t cycle, size_t view);

 private:
  LightFieldCycles(std::vector<std::filesystem::path> paths, const lightfield::ReadOptions& options)
      : paths_(std::move(paths)), options_(options) {}
  std::vector<std::filesystem::path> paths_;
  lightfield::ReadOptions options_;
  lightfield::Shape shape_;
  std::mutex mutex_;
  std::shared_ptr<const lightfield::LightField> kept_;
  size_t kept_cycle_ = 0;
};

}  // namespace e2lf::view
