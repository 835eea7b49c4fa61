// SPDX-License-Identifier: MIT
#include "e2lf/cli/file_kind.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/capture/measurement_io.h"
#include "e2lf/cli/recording_flags.h"
#include "e2lf/files/mat5.h"
#include "e2lf/files/npy.h"
#include "e2lf/lightfield/light_field_io.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

/// Fails where a file or folder is not there or may not be looked into.
Result<void> check_readable(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error) && !error) {
    return Error{ErrorCode::kNotFound, "there is no such file or folder; check the path", path.string()};
  }
  if (!error && fs::is_directory(path, error)) fs::directory_iterator(path, error);
  if (!error) return {};
  return Error{ErrorCode::kIo, cat("cannot be looked into (", error.message(), "); check its permissions"),
               path.string()};
}

Result<FileKind> folder_kind(const fs::path& path) {
  std::error_code error;
  if (fs::exists(path / "event_image_00000.npy", error)) return FileKind::kEventImages;
  if (fs::exists(path / "events_ts.npy", error)) return FileKind::kRecording;
  if (!lightfield::cycle_folders(path).empty()) return FileKind::kCycles;
  if (lightfield::detect_kind(path)) return FileKind::kLightField;
  return Error{ErrorCode::kFormat,
               "the folder holds neither event images (event_image_00000.npy ...) nor views of a light field; name "
               "what is in it",
               path.string()};
}

/// Events one by one: records, or rows of t, x, y, p in some order.
bool is_event_list(const NpyArray& array) {
  return !array.fields.empty() || (array.shape.size() == 2 && array.shape[1] == 4);
}

Result<FileKind> array_kind(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const NpyArray array, peek_npy(path));
  if (is_event_list(array)) return FileKind::kRecording;
  return lightfield::detect_kind(path) ? FileKind::kLightField : FileKind::kEventImages;
}

Result<FileKind> archive_kind(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const NpzArrays arrays, peek_npz(path));
  if (capture::holds_images(arrays)) return FileKind::kImages;
  const auto events = arrays.find("events");
  if (events != arrays.end()) {
    return is_event_list(events->second) ? FileKind::kRecording : FileKind::kEventImages;
  }
  return lightfield::detect_kind(path) ? FileKind::kLightField : FileKind::kRecording;
}

/// A MATLAB file before version 7.3; later ones are HDF5 files.
bool holds_event_images(const fs::path& path) {
  const auto names = mat_variables(path);
  return names && std::find(names->begin(), names->end(), "events") != names->end();
}

}  // namespace

const char* kind_text(FileKind kind) {
  switch (kind) {
    case FileKind::kRecording:
      return "a recording";
    case FileKind::kEventImages:
      return "event images";
    case FileKind::kImages:
      return "a measurement with intensity images";
    case FileKind::kLightField:
      return "a light field";
    case FileKind::kCycles:
      return "a folder of cycles";
    case FileKind::kModel:
      return "a model";
  }
  return "a file";
}

Result<FileKind> file_kind(const fs::path& path) {
  if (is_live(path)) return FileKind::kRecording;
  E2LF_RETURN_IF_ERROR(check_readable(path));
  std::error_code error;
  if (fs::is_directory(path, error)) return folder_kind(path);
  const std::string extension = path.extension().string();
  if (extension == ".safetensors") return FileKind::kModel;
  if (extension == ".npz") return archive_kind(path);
  if (extension == ".npy") return array_kind(path);
  if (extension == ".mat" && holds_event_images(path)) return FileKind::kEventImages;
  return lightfield::detect_kind(path) ? FileKind::kLightField : FileKind::kRecording;
}

}  // namespace e2lf::cli
