// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/live/session.h"

namespace e2lf::cli {

/// Reconstructs the cycle of a frozen light field again, as well as possible; upright, and as bright as that one.
using FineMethod = std::function<Result<lightfield::LightField>(const live::LiveField& frozen)>;

/// The page of `e2lf live`, served by a thread of its own: what live_requests.h answers, the light field that was
/// frozen last with all its views, and the same cycle reconstructed well. Commands (POST) beside those of
/// live_requests.h: freeze, fine; both answer {"name"} of the light field that the page will have.
class LivePage {
 public:
  /// Serves from now on. `session` must outlive the page. Fails with kIo where the port is taken, and with
  /// kMissingDependency in a build without the viewer.
  [[nodiscard]] static Result<LivePage> start(live::Session& session, FineMethod fine, uint16_t port);
  LivePage(LivePage&& other) noexcept;
  LivePage& operator=(LivePage&& other) = delete;
  ~LivePage();

  [[nodiscard]] std::string url() const;
  /// Goes on serving until stop_requested(). Fails with kIo.
  [[nodiscard]] Result<void> finish();

 private:
  class Impl;
  explicit LivePage(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace e2lf::cli
