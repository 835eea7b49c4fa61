// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/live/session.h"
#include "e2lf/recordings/live/camera.h"

namespace e2lf::live {

/// Reconstructs the cycle of a frozen light field again in the best quality. The result is upright and has the same
/// brightness.
using FineMethod = std::function<Result<lightfield::LightField>(const LiveField& frozen)>;

/// The page of `e2lf live`, served by a separate thread. Besides the requests of live_requests.h, it answers those for
/// the views of the last frozen light field and of the same cycle reconstructed in the best quality. Its additional
/// commands (POST) are freeze and fine, which return {"name"} of the light field that the page will contain, and
/// camera?name=&value=, which changes a setting of the camera; the statistics list those settings as "camera".
struct LivePage {
  std::string url;
  std::function<Result<void>()> finish;  ///< serves until stop_requested(); fails with kIo
};

/// Starts serving. `session` must outlive the page, which changes the settings of `camera`. Fails with kIo if the port
/// is in use, and with kMissingDependency in a build without the viewer.
[[nodiscard]] Result<LivePage> start_live_page(Session& session, FineMethod fine,
                                               std::shared_ptr<recordings::RunningCamera> camera, uint16_t port);

}  // namespace e2lf::live
