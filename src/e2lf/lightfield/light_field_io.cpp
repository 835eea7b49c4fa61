// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/light_field_io.h"

#include <cctype>
#include <mutex>
#include <span>
#include <string_view>

#include "e2lf/base/choice.h"
#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/lightfield/formats/readers.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/views.h"

namespace e2lf::lightfield {
namespace fs = std::filesystem;
namespace {

using namespace std::string_view_literals;

// The HDF5 signature is at byte 0, or after the 512-byte header of a MATLAB 7.3 file.
constexpr size_t kMatlabHeaderBytes = 512;
constexpr std::string_view kHdf5Signature = "\x89HDF\r\n\x1a\n"sv;

/// Returns the path of the array in a kArrayFolder.
fs::path array_in(const fs::path& folder) {
  return folder / "lightfield.npy";
}

/// Detects the kind from the first bytes of a file.
std::optional<LightFieldKind> kind_of_bytes(std::span<const uint8_t> bytes) {
  if (is_png(bytes) || is_jpeg(bytes)) return LightFieldKind::kLenslet;
  const std::string_view head(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (head.starts_with(kHdf5Signature)) return LightFieldKind::kHdf5;
  if (head.size() > kMatlabHeaderBytes && head.substr(kMatlabHeaderBytes).starts_with(kHdf5Signature)) {
    return LightFieldKind::kHdf5;
  }
  if (head.starts_with("MATLAB 5.0 MAT-file"sv)) return LightFieldKind::kMat;
  if (head.starts_with("\x93NUMPY"sv)) return LightFieldKind::kNpy;
  if (head.starts_with("PK\x03\x04"sv)) return LightFieldKind::kNpz;
  return std::nullopt;
}

/// Detects the storage from names and first bytes alone; its content may still be something else.
Result<LightFieldKind> storage_kind(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) return fail(ErrorCode::kNotFound, path, "no such file or folder; check the path");
  if (fs::is_directory(status)) {
    if (fs::exists(array_in(path), error)) return LightFieldKind::kArrayFolder;
    E2LF_ASSIGN_OR_RETURN(const ViewFiles views, list_views(path));
    if (!views.files.empty()) return views.kind;
    if (const auto cycles = cycle_folders(path); !cycles.empty()) {
      return fail(ErrorCode::kUnsupported, path, "the folder contains a light field for each cycle; give one, e.g. ",
                  (path / cycles.front().filename()).string());
    }
    return fail(ErrorCode::kUnsupported, path, no_views_text(path));
  }
  E2LF_ASSIGN_OR_RETURN(const auto bytes, read_head(path, kMatlabHeaderBytes + kHdf5Signature.size()));
  if (const auto kind = kind_of_bytes(bytes)) return *kind;
  return fail(ErrorCode::kUnsupported, path,
              "not a light field of a known kind; give a folder of views, .mat, .h5, .npy, .npz or a lenslet mosaic");
}

Result<bool> holds_light_field(LightFieldKind kind, const fs::path& path) {
  if (kind == LightFieldKind::kHdf5) return hdf5_has_light_field(path);
  if (kind == LightFieldKind::kArrayFolder) return holds_light_field(LightFieldKind::kNpy, array_in(path));
  if (kind == LightFieldKind::kNpy) {
    E2LF_ASSIGN_OR_RETURN(const NpyArray array, peek_npy(path));
    return npy_shape(array).has_value();
  }
  if (kind == LightFieldKind::kNpz) {
    E2LF_ASSIGN_OR_RETURN(const NpzArrays arrays, peek_npz(path));
    const NpyArray* array = find_light_field(arrays);
    return array != nullptr && npy_shape(*array).has_value();
  }
  return true;
}

Result<LightField> read_npz_light_field(const fs::path& path, const ReadOptions& options) {
  E2LF_ASSIGN_OR_RETURN(const NpzArrays arrays, read_npz(path));
  if (const NpyArray* array = find_light_field(arrays)) return from_npy(*array, options, path.string());
  std::vector<std::string> names;
  for (const auto& [name, array] : arrays) names.push_back(name);
  return fail(ErrorCode::kNotFound, path, "no array light_field, but ", join(names), "; store it under that name");
}

/// Tells options that describe another kind of storage.
void tell_unused(LightFieldKind kind, const fs::path& path, const ReadOptions& options) {
  const bool may_be_one_picture = kind == LightFieldKind::kLenslet || kind == LightFieldKind::kHdf5;
  const bool is_array = kind == LightFieldKind::kArrayFolder;  // its array is asked again
  if (options.lenslet_views > 0 && !may_be_one_picture && !is_array) log_unused_grid(path.string());
  if (options.view_columns > 0 && kind != LightFieldKind::kHciFolder && !is_array) {
    log_warning(cat(path.string(),
                    ": the number of view columns has no effect, since the views are not numbered consecutively"));
  }
}

/// Reads the views in the order in which they are stored.
Result<LightField> read_stored(const fs::path& path, const ReadOptions& options, const ProgressFn& progress) {
  E2LF_ASSIGN_OR_RETURN(const LightFieldKind kind, storage_kind(path));
  tell_unused(kind, path, options);
  switch (kind) {
    case LightFieldKind::kViewFolder:
    case LightFieldKind::kHciFolder:
    case LightFieldKind::kStanfordFolder:
      return read_view_folder(path, options, progress);
    case LightFieldKind::kArrayFolder:
      return read_stored(array_in(path), options, progress);
    case LightFieldKind::kMat:
      return read_mat(path, options);
    case LightFieldKind::kHdf5:
      return read_hdf5(path, options);
    case LightFieldKind::kLenslet:
      return read_lenslet(path, options);
    case LightFieldKind::kNpz:
      return read_npz_light_field(path, options);
    case LightFieldKind::kNpy: {
      E2LF_ASSIGN_OR_RETURN(const NpyArray array, read_npy(path));
      return from_npy(array, options, path.string());
    }
  }
  return fail(ErrorCode::kInternal, path, "unknown kind of light field");
}

}  // namespace

void log_unused_grid(const std::string& location) {
  log_warning(
      cat(location, ": the number of views per axis of one picture has no effect, since the views are separate"));
}

const char* kind_name(LightFieldKind kind) {
  constexpr const char* kNames[] = {"folder of VV_UU.png",      "HCI folder",  "Stanford folder",
                                    "folder of lightfield.npy", "MATLAB file", "HDF5 file",
                                    "lenslet mosaic",           "npy array",   "npz archive"};
  return kNames[static_cast<size_t>(kind)];
}

std::vector<fs::path> cycle_folders(const fs::path& folder) {
  std::vector<fs::path> folders = paths_in(folder);
  std::erase_if(folders, [](const fs::path& path) {
    return !path.filename().string().starts_with("cycle_") || !is_folder(path);
  });
  return folders;
}

Result<LightFieldKind> detect_kind(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const LightFieldKind kind, storage_kind(path));
  E2LF_ASSIGN_OR_RETURN(const bool holds, holds_light_field(kind, path));
  if (holds) return kind;
  return fail(ErrorCode::kUnsupported, path, "an ", kind_name(kind),
              " that does not contain a light field; check the file");
}

Result<LightField> read_light_field(const fs::path& path, const ReadOptions& options, const ProgressFn& progress) {
  E2LF_ASSIGN_OR_RETURN(const capture::Orientation stored, stored_orientation(path));
  E2LF_ASSIGN_OR_RETURN(LightField light_field, read_stored(path, options, progress));
  if (!stored.is_upright()) {
    log_info(cat(path.string(), ": its views are ", capture::orientation_name(stored),
                 ", as run.json states; they are reordered"));
  }
  orient(light_field, stored + options.orientation);
  return light_field;
}

namespace {

constexpr Choice<LightFieldFormat> kFormats[] = {{"png", LightFieldFormat::kPng8},
                                                 {"png16", LightFieldFormat::kPng16},
                                                 {"npy", LightFieldFormat::kNpy},
                                                 {"h5", LightFieldFormat::kHdf5}};

}  // namespace

Result<LightFieldFormat> parse_format(const std::string& word) {
  return choice_of(word, kFormats, "light-field format");
}

bool is_folder_format(LightFieldFormat format) {
  return format == LightFieldFormat::kPng8 || format == LightFieldFormat::kPng16;
}

Result<LightFieldFormat> format_of_path(const fs::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".npy") return LightFieldFormat::kNpy;
  if (extension == ".h5" || extension == ".hdf5") return LightFieldFormat::kHdf5;
  const bool is_named = extension.size() > 1 && std::isalpha(static_cast<unsigned char>(extension[1])) != 0;
  if (!is_named) return LightFieldFormat::kPng8;
  return Error{
      ErrorCode::kUnsupported,
      cat("light fields are not written with the extension ", extension, "; use .npy, .h5 or the name of a folder"),
      path.string(), "format"};
}

Result<void> write_views(const fs::path& folder, const LightFieldView& light_field, LightFieldFormat format,
                         const ProgressFn& progress) {
  E2LF_REQUIRE(is_folder_format(format), "views are written in a folder format");
  const Shape shape = shape_of(light_field);
  const PngDepth depth = format == LightFieldFormat::kPng16 ? PngDepth::k16 : PngDepth::k8;
  std::mutex mutex;
  std::optional<Error> error;
  size_t done = 0;
  parallel_for(shape.num_views(), 1, [&](size_t begin, size_t end) {
    for (size_t view = begin; view < end; ++view) {
      const size_t view_y = view / shape.views_x, view_x = view % shape.views_x;
      const std::string name = formatted("%02zu_%02zu.png", view_y, view_x);
      const Result<void> status = write_png(folder / name, view_image(light_field, view_y, view_x), depth);
      const std::lock_guard lock(mutex);
      if (!status.ok() && !error) error = status.error();
      ++done;
      if (progress) progress(done, shape.num_views());
    }
  });
  if (error) return *error;
  return {};
}

Result<void> write_light_field(const fs::path& path, const LightFieldView& light_field, const WriteOptions& options,
                               const ProgressFn& progress) {
  E2LF_REQUIRE(light_field.size() > 0, "a light field to write has samples");
  if (is_folder_format(options.format)) {
    E2LF_ASSIGN_OR_RETURN(ResultFolder folder, ResultFolder::create(path, options.overwrite));
    E2LF_RETURN_IF_ERROR(write_views(folder.path(), light_field, options.format, progress));
    return folder.commit();
  }
  E2LF_RETURN_IF_ERROR(check_output(path, options.overwrite));
  if (options.format == LightFieldFormat::kNpy) return write_npy_light_field(path, light_field);
  return write_hdf5(path, light_field);
}

}  // namespace e2lf::lightfield
