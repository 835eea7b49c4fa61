// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/depth/disparity_error.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/live/session.h"
#include "e2lf/recordings/live/camera.h"

/// What other verbs show in the viewer. In a build without it, these functions fail with kMissingDependency.
namespace e2lf::cli {

/// Whether this build includes `e2lf view`.
#ifdef E2LF_NO_VIEWER
inline constexpr bool kHasViewer = false;
#else
inline constexpr bool kHasViewer = true;
#endif
/// Returns the error of what needs it, so that verbs fail before they open anything.
[[nodiscard]] Error no_viewer_error();

/// A light field, with the disparities of its middle view.
struct ComparedLightField {
  const lightfield::LightField& light_field;  ///< limited to [0, 1] for the figures, as its files are
  const lightfield::Image& disparity;
};

/// Writes a self-contained HTML file in which the viewer shows a scene beside its reconstruction, whose disparities
/// have this error. Fails with kIo, and with kUnsupported (a browser would not have enough memory for the views).
[[nodiscard]] Result<void> write_comparison_page(const std::filesystem::path& path, const ComparedLightField& truth,
                                                 const ComparedLightField& reconstruction,
                                                 const std::optional<depth::DisparityError>& error);

/// Reconstructs the cycle of a frozen light field again in the best quality. The result is upright and has the same
/// brightness.
using FineMethod = std::function<Result<lightfield::LightField>(const live::LiveField& frozen)>;

/// The page of `e2lf live`, served by a separate thread. Besides the requests of live_requests.h, it answers those for
/// the views of the last frozen light field and of the same cycle reconstructed in the best quality. Its additional
/// commands (POST) are freeze and fine, which return {"name"} of the light field that the page will contain, and
/// camera?name=&value=, which changes a setting of the camera; the statistics list those settings as "camera".
struct LivePage {
  std::string url;
  std::function<Result<void>()> finish;  ///< continues to serve until stop_requested(); fails with kIo
};

/// Starts serving. `session` must outlive the page, which changes the settings of `camera`. Fails with kIo if the port
/// is in use, and with kMissingDependency in a build without the viewer.
[[nodiscard]] Result<LivePage> start_live_page(live::Session& session, FineMethod fine,
                                               std::shared_ptr<recordings::RunningCamera> camera, uint16_t port);

}  // namespace e2lf::cli
