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
/// memory. A reconstruction that is going on adds to them. All but label() may be called from any thread.
class LightFieldCycles {
 public:
  /// No cycle yet: add() brings them.
  LightFieldCycles() = default;

  /// `path` is a light field of any format, a folder that holds `lightfield.npy`, or a folder of such (cycle_00000
  /// ...). Reads the first one. Fails as read_light_field does, and with kUnsupported where the views need more than
  /// kMostBytes of a browser's memory.
  [[nodiscard]] static Result<std::shared_ptr<LightFieldCycles>> open(const std::filesystem::path& path,
                                                                      const lightfield::ReadOptions& options);
  static constexpr uint64_t kMostBytes = uint64_t{1} << 30;

  /// A cycle that has just been made, and will lie in folder()/name; the newest one is kept in memory. Another shape
  /// than that of the first breaks the contract.
  void add(const std::string& name, lightfield::LightField light_field);
  /// Where the cycles that were added lie from now on.
  void set_folder(const std::filesystem::path& folder);

  [[nodiscard]] size_t size() const;
  [[nodiscard]] lightfield::Shape shape() const;
  [[nodiscard]] std::string label(size_t cycle) const;

  /// A whole cycle. Fails as read_light_field does, and with kShape where it is not like the first one.
  [[nodiscard]] Result<std::shared_ptr<const lightfield::LightField>> read(size_t cycle);

  /// A view (its number) as an 8-bit PNG. Fails as read() does.
  [[nodiscard]] Result<std::vector<uint8_t>> png(size_t cycle, size_t view);

 private:
  LightFieldCycles(std::vector<std::filesystem::path> paths, const lightfield::ReadOptions& options)
      : paths_(std::move(paths)), options_(options) {}

  using Kept = std::shared_ptr<const lightfield::LightField>;

  std::vector<std::filesystem::path> paths_;  ///< of cycles that were added: relative to folder_
  std::filesystem::path folder_;
  lightfield::ReadOptions options_;
  lightfield::Shape shape_;
  mutable std::mutex mutex_;
  Kept kept_, newest_;  ///< the one that was read last, the one that was added last
  size_t kept_cycle_ = 0;
};

/// Whether the views are few enough for a browser: see LightFieldCycles::kMostBytes. Fails with kUnsupported.
[[nodiscard]] Result<void> check_browser_memory(const lightfield::Shape& shape, const std::filesystem::path& path);

}  // namespace e2lf::view
