// SPDX-License-Identifier: MIT
// The implementation for builds without the FFmpeg libraries.
#include "e2lf/base/text.h"
#include "e2lf/film/film_file.h"

namespace e2lf::film {

Result<void> check_film_support() {
  return fail(ErrorCode::kMissingDependency, "",
              "this build cannot write films; install libavcodec-dev, libavformat-dev, libavutil-dev "
              "and libswscale-dev and build again");
}

Result<void> write_film(const std::filesystem::path& /*path*/, FilmFormat /*format*/, const Film& /*film*/,
                        const ProgressFn& /*progress*/) {
  return check_film_support();
}

}  // namespace e2lf::film
