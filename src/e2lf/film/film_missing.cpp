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

Result<std::unique_ptr<FilmFile>> FilmFile::create(const std::filesystem::path& /*path*/,
                                                   const FilmOptions& /*options*/, const lightfield::Image& /*first*/) {
  return check_film_support().error();
}

}  // namespace e2lf::film
