// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::cli {

/// Returns true if this build includes `e2lf view`.
[[nodiscard]] bool has_viewer();

/// Shows the light fields of a reconstruction in a browser while they are being computed. The viewer is served by a
/// separate thread.
class LiveView {
 public:
  /// Starts serving and prints the address to standard error. `name` is that of the light field, and `folder` is where
  /// the cycles are written. Fails with kIo if the port is in use, and with kMissingDependency in a build without the
  /// viewer.
  [[nodiscard]] static Result<LiveView> start(const std::string& name, const std::filesystem::path& folder,
                                              uint16_t port);
  LiveView(LiveView&& other) noexcept;
  LiveView& operator=(LiveView&& other) = delete;
  ~LiveView();

  /// Adds a completed cycle; `note` is shown beside it. Views that exceed a browser's memory are omitted, with a
  /// warning.
  void add(const std::string& cycle, lightfield::LightField light_field, const std::string& note);

  /// Sets the folder of the cycles.
  void set_folder(const std::filesystem::path& folder);

  /// Declares that no cycle will follow, and continues to serve until stop_requested(). Fails with kIo.
  [[nodiscard]] Result<void> finish();

 private:
  class Impl;
  explicit LiveView(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace e2lf::cli
