// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::film {

enum class FilmFormat {
  kGif,   ///< repeats for ever; grey is kept exactly, colour becomes 256 fixed ones
  kWebm,  ///< VP9
  kMp4,   ///< H.264, or MPEG-4 where its encoder is missing
};

/// What an extension means: .gif, .webm, .mp4. Fails with kUnsupported.
[[nodiscard]] Result<FilmFormat> film_format_of(const std::filesystem::path& path);

/// Whether this build can write films.
[[nodiscard]] bool can_write_films();

struct FilmOptions {
  FilmFormat format = FilmFormat::kGif;
  int frames_per_s = 25;  ///< 1 to 100
};

/// Writes pictures of one size as a film, by FFmpeg's libraries. WebM and MP4 have even sizes: an odd last row or
/// column is left out.
class FilmFile {
 public:
  /// The first frame says the size, and whether there is colour. Fails with kMissingDependency (a build without the
  /// libraries, or these without an encoder), kIo and kInternal.
  [[nodiscard]] static Result<FilmFile> create(const std::filesystem::path& path, const FilmOptions& options,
                                               const lightfield::Image& first);
  FilmFile(FilmFile&& other) noexcept;
  FilmFile& operator=(FilmFile&& other) noexcept;
  ~FilmFile();

  /// Another size breaks the contract. Fails with kIo and kInternal.
  [[nodiscard]] Result<void> add(const lightfield::Image& frame);

  /// Ends the file; nothing may be added then. Fails as add().
  [[nodiscard]] Result<void> finish();

 private:
  struct Impl;
  explicit FilmFile(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace e2lf::film
