// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::film {

enum class FilmFormat {
  kGif,   ///< loops forever; grey is exact, and colours are reduced to 256 fixed ones
  kWebm,  ///< VP9
  kMp4,   ///< H.264, or MPEG-4 if there is no H.264 encoder
};

/// Returns the format of an extension: .gif, .webm or .mp4. Fails with kUnsupported.
[[nodiscard]] inline Result<FilmFormat> film_format_of(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".gif") return FilmFormat::kGif;
  if (extension == ".webm") return FilmFormat::kWebm;
  if (extension == ".mp4") return FilmFormat::kMp4;
  return fail(ErrorCode::kUnsupported, path, "this is not the extension of a film; use .gif, .webm or .mp4");
}

/// Fails with kMissingDependency if this build has no libraries for films.
[[nodiscard]] Result<void> check_film_support();

/// Pictures of one size, frame_at(0), frame_at(1), ..., at a constant rate.
struct Film {
  std::function<lightfield::Image(size_t frame)> frame_at = {};
  size_t frames = 1;
  int frames_per_s = 25;  ///< 1 to 100
};

/// Writes a film with the FFmpeg libraries. The first frame determines the size and whether there is colour. WebM and
/// MP4 need even sizes; an odd last row or column is cut off. Frames of another size break the contract. Fails with
/// kMissingDependency (a build without the libraries, or libraries without an encoder), kUnsupported (sides outside of
/// 2 to 16384 px), kIo and kInternal.
[[nodiscard]] Result<void> write_film(const std::filesystem::path& path, FilmFormat format, const Film& film,
                                      const ProgressFn& progress = {});

}  // namespace e2lf::film
