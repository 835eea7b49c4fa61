// SPDX-License-Identifier: MIT
#include "e2lf/info/file_kind.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"
#include "e2lf/files/options.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/recordings/open/registry.h"

namespace e2lf::info {
namespace fs = std::filesystem;
namespace {

/// Fails if a file or folder does not exist or may not be read.
Result<void> check_readable(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error) && !error) {
    return fail(ErrorCode::kNotFound, path, "there is no such file or folder; check the path");
  }
  if (!error && fs::is_directory(path, error)) fs::directory_iterator(path, error);
  if (!error) return {};
  return fail(ErrorCode::kIo, path, "cannot be opened (", error.message(), "); check its permissions");
}

/// Returns the verb that wrote a run.json, or an empty string if e2lf did not write it.
std::string verb_of(const fs::path& record) {
  const auto json = read_json(record);
  const Json::json_pointer verb("/verb");
  const bool is_ours = is_our_record(record) && json && json->contains(verb) && json->at(verb).is_string();
  return is_ours ? json->at(verb).get<std::string>() : "";
}

bool is_training_run(const fs::path& path) {
  return is_present(path / "config.json") &&
         (is_present(path / "log.csv") || is_present(path / "checkpoint.safetensors"));
}

/// Returns the first names in a folder, ": events.txt, images, ...".
std::string members_text(const fs::path& path) {
  constexpr size_t kMost = 4;
  std::vector<std::string> names;
  for (const fs::path& inner : paths_in(path)) names.push_back(printable(inner.filename().string()));
  const bool is_all = names.size() <= kMost;
  if (!is_all) names.resize(kMost);
  return names.empty() ? "" : cat(": ", join(names), is_all ? "" : ", ...");
}

Result<FileKind> folder_kind(const fs::path& path) {
  if (recordings::is_recording_folder(path)) return FileKind::kRecording;
  if (is_present(path / "event_image_00000.npy")) return FileKind::kEventImages;
  const std::string verb = verb_of(path / "run.json");
  if (verb == "codes render") return FileKind::kDisplay;
  const bool is_depth = verb == "depth";  // in cycles, too
  if (!is_depth && !lightfield::cycle_folders(path).empty()) return FileKind::kCycles;
  const auto kind = lightfield::detect_kind(path);
  if (kind) return FileKind::kLightField;
  if (kind.error().code != ErrorCode::kUnsupported) return kind.error();
  if (is_training_run(path)) return FileKind::kTrainingRun;
  if (!verb.empty()) return FileKind::kResults;
  if (const std::string unread = lightfield::unread_pictures_text(path); !unread.empty()) {
    return fail(ErrorCode::kUnsupported, path, unread);
  }
  return fail(ErrorCode::kFormat, path,
              "the folder contains neither event images (event_image_00000.npy ...) nor views of a light field (PNG "
              "or JPEG images named by row and column, such as 00_00.png or view_0_0.png, or numbered, "
              "input_Cam000.png ...); rename the views, or give a file or folder in it",
              members_text(path));
}

/// Returns whether an array is a list of events: records, or rows or columns of t, x, y, p in some order.
bool is_event_list(const NpyArray& array) {
  return !array.fields.empty() || (array.shape.size() == 2 && (array.shape[1] == 4 || array.shape[0] == 4));
}

/// Returns whether an array contains patterns: [N, 8, 8]. No sensor is as small.
bool are_patterns(const NpyArray& array) {
  return array.shape.size() == 3 && array.shape[1] == 8 && array.shape[2] == 8;
}

Result<FileKind> array_kind(const fs::path& path) {
  // A file with this name may also be another recording, such as text.
  std::array<char, 6> mark{};
  if (!std::ifstream(path, std::ios::binary).read(mark.data(), mark.size()) ||
      std::string_view(mark.data(), mark.size()) != "\x93NUMPY") {
    return FileKind::kRecording;
  }
  E2LF_ASSIGN_OR_RETURN(const NpyArray array, peek_npy(path));
  if (is_event_list(array)) return FileKind::kRecording;
  if (are_patterns(array)) return FileKind::kSettings;
  return lightfield::detect_kind(path) ? FileKind::kLightField : FileKind::kEventImages;
}

Result<FileKind> archive_kind(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const NpzArrays arrays, peek_npz(path));
  const auto events = arrays.find("events");
  if (events != arrays.end() && is_event_list(events->second)) return FileKind::kRecording;
  if (capture::holds_images(arrays)) return FileKind::kImages;
  if (events != arrays.end()) return FileKind::kEventImages;
  if (arrays.contains("codes")) return FileKind::kSettings;
  return lightfield::detect_kind(path) ? FileKind::kLightField : FileKind::kRecording;
}

/// The name of a kind with its article, and what can be done with it where another kind is required.
struct KindText {
  FileKind kind;
  const char *name, *use;
};
constexpr KindText kKindTexts[] = {
    {FileKind::kRecording, "a recording",
     ": `e2lf reconstruct` computes light fields from it, `e2lf accumulate` event images"},
    {FileKind::kEventImages, "event images", ": `e2lf reconstruct` computes a light field from them"},
    {FileKind::kImages, "a measurement with intensity images", ": `e2lf reconstruct` computes a light field from them"},
    {FileKind::kLightField, "a light field", ": `e2lf simulate` generates events from it"},
    {FileKind::kCycles, "a folder of cycles", ": give one of them, e.g. "},  // the first follows
    {FileKind::kModel, "a model", ": models are given with -m"},
    {FileKind::kTrainingRun, "a training run",
     ": its model is a .safetensors in the folder, `e2lf resume` continues it"},
    {FileKind::kDisplay, "the images for an aperture display",
     ": its codes.json is for --codes, its schedule.json for --schedule"},
    {FileKind::kResults, "a folder of results", ": `e2lf info` describes the run that wrote it"},
    {FileKind::kSettings, "a file of settings", ": `e2lf info` describes them"}};

const KindText& text_of(FileKind kind) {
  return *std::find_if(std::begin(kKindTexts), std::end(kKindTexts) - 1,
                       [&](const KindText& text) { return text.kind == kind; });
}

}  // namespace

const char* kind_text(FileKind kind) {
  return text_of(kind).name;
}

Error other_kind_error(const fs::path& path, FileKind kind, const char* wanted) {
  return fail(ErrorCode::kUnsupported, path, "expected ", wanted, ", not ", kind_text(kind), text_of(kind).use,
              kind == FileKind::kCycles ? (path / "cycle_00000").string() : "");
}

Result<FileKind> file_kind(const fs::path& path) {
  if (recordings::is_live_recording(path.string())) return FileKind::kRecording;
  E2LF_RETURN_IF_ERROR(check_readable(path));
  if (is_folder(path)) return folder_kind(path);
  const std::string extension = path.extension().string();
  if (extension == ".safetensors") return FileKind::kModel;
  if (extension == ".bias") return FileKind::kSettings;
  if (extension == ".json" && read_json(path).value_or(Json()).is_object()) return FileKind::kSettings;
  if (extension == ".npz") return archive_kind(path);
  if (extension == ".npy") return array_kind(path);
  return lightfield::detect_kind(path) ? FileKind::kLightField : FileKind::kRecording;
}

fs::path file_or_bundled_model(const fs::path& path) {
  if (is_present(path)) return path;
  return bundled_file_named(kBundledModels, path.string()).value_or(path);
}

}  // namespace e2lf::info
