// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::cli {

/// Whether this build has `e2lf view`.
[[nodiscard]] bool has_viewer();

/// Shows the light fields of a reconstruction in a browser while they come. Its own thread serves the viewer.
class LiveView {
 public:
  /// Serves from now on, and says on standard error where. `name` is that of the light field, `folder` that in which
  /// the cycles are being written. Fails with kIo where the port is taken, and with kMissingDependency in a build
  /// without the viewer.
  [[nodiscard]] static Result<LiveView> start(const std::string& name, const std::filesystem::path& folder,
                                              uint16_t port);
  LiveView(LiveView&& other) noexcept;
  LiveView& operator=(LiveView&& other) = delete;
  ~LiveView();

  /// A cycle is done; `note` is shown beside it. Views that are too many for a browser are left out, with a warning.
  void add(const std::string& cycle, lightfield::LightField light_field, const std::string& note);

  /// Where the cycles lie from now on.
  void set_folder(const std::filesystem::path& folder);

  /// No cycle will come. Goes on serving until stop_requested(). Fails with kIo.
  [[nodiscard]] Result<void> finish();

 private:
  class Impl;
  explicit LiveView(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace e2lf::cli
