// SPDX-License-Identifier: MIT
// Determines the format of a film by its name; declared in film_file.h and needed without FFmpeg, too.
#include "e2lf/film/film_file.h"

namespace e2lf::film {

Result<FilmFormat> film_format_of(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".gif") return FilmFormat::kGif;
  if (extension == ".webm") return FilmFormat::kWebm;
  if (extension == ".mp4") return FilmFormat::kMp4;
  return Error{ErrorCode::kUnsupported, "no film format has this extension; use .gif, .webm or .mp4", path.string()};
}

}  // namespace e2lf::film
