// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <string>

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

struct FilmOptions {
  FilmFormat format = FilmFormat::kGif;
  int frames_per_s = 25;  ///< 1 to 100
};

/// Writes pictures of one size as a film with the FFmpeg libraries. WebM and MP4 need even sizes; an odd last row or
/// column is cut off.
class FilmFile {
 public:
  /// Creates the film. The first frame determines the size and whether there is colour. Fails with kMissingDependency
  /// (a build without the libraries, or libraries without an encoder), kUnsupported (sides outside of 2 to 16384 px),
  /// kIo and kInternal.
  [[nodiscard]] static Result<std::unique_ptr<FilmFile>> create(const std::filesystem::path& path,
                                                                const FilmOptions& options,
                                                                const lightfield::Image& first);
  virtual ~FilmFile() = default;

  /// Adds a frame. Another size breaks the contract. Fails with kIo and kInternal.
  [[nodiscard]] virtual Result<void> add(const lightfield::Image& frame) = 0;

  /// Finishes the file; no frames may be added afterwards. Fails as add() does.
  [[nodiscard]] virtual Result<void> finish() = 0;
};

}  // namespace e2lf::film
