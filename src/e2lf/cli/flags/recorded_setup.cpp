// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/recorded_setup.h"

#include "e2lf/capture/patterns/codes_io.h"
#include "e2lf/capture/profile/profile_record.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

constexpr const char *kCodesNote = "recorded_codes", *kCameraNote = "recorded_camera", *kViewsNote = "recorded_views",
                     *kColourNote = "recorded_colour_filter";
constexpr const char* kSize = "recording_bytes";

/// Returns the size of a recording, which distinguishes it from another that replaced it.
uint64_t size_of(const fs::path& path) {
  std::error_code error;
  const uint64_t bytes = fs::file_size(path, error);
  return error ? 0 : bytes;
}

void note_with_size(RunRecord& record, const char* key, Json note, const fs::path& recording) {
  note[kSize] = size_of(recording);
  record.note(key, std::move(note));
}

/// Returns a note of the run record beside a recording, or nothing if the file with this name is not a record of e2lf
/// or describes another recording.
std::optional<Json> note_beside(const fs::path& recording, const char* key) {
  const fs::path path = record_path_beside(recording);
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  const auto record = read_json(path);
  if (!record || !record->is_object() || !record->contains("notes") || !record->at("notes").contains(key)) {
    return std::nullopt;
  }
  Json note = record->at("notes").at(key);
  if (!note.is_object() || note.value(kSize, Json()) != Json(size_of(recording))) return std::nullopt;
  note.erase(kSize);
  return note;
}

}  // namespace

capture::HeaderLines header_of(const RecordedSetup& setup) {
  capture::HeaderLines header;
  if (setup.codes) header = capture::codes_to_header(*setup.codes);
  const auto add = [&](capture::HeaderLines lines) {
    std::move(lines.begin(), lines.end(), std::back_inserter(header));
  };
  if (setup.camera) add(capture::camera_to_header(*setup.camera));
  if (setup.has_own_views()) add(capture::views_to_header(*setup.views));
  return header;
}

void keep_setup(const RecordedSetup& setup, capture::EventImageWriter& writer) {
  if (setup.codes) writer.set_codes(capture::codes_to_npy(*setup.codes));
  if (setup.camera) writer.set_camera(capture::camera_to_npy(*setup.camera));
  if (setup.has_own_views()) writer.set_views(capture::views_to_npy(*setup.views));
}

void note_setup(RunRecord& record, const RecordedSetup& setup, const fs::path& recording) {
  if (setup.codes) note_with_size(record, kCodesNote, capture::codes_to_json(*setup.codes), recording);
  if (setup.camera) note_with_size(record, kCameraNote, capture::to_json(*setup.camera), recording);
  if (setup.has_own_views())
    note_with_size(record, kViewsNote, {{"views", capture::orientation_name(*setup.views)}}, recording);
}

Result<RecordedSetup> recorded_setup(const fs::path& recording, const recordings::RecordingInfo& info) {
  RecordedSetup setup;
  const std::string beside = record_path_beside(recording).string();
  E2LF_ASSIGN_OR_RETURN(setup.codes, capture::codes_from_header(info.header, recording.string()));
  if (!setup.codes) {
    if (const auto note = note_beside(recording, kCodesNote)) {
      E2LF_ASSIGN_OR_RETURN(setup.codes, capture::codes_from_json(*note, beside));
    }
  }
  E2LF_ASSIGN_OR_RETURN(setup.camera, capture::camera_from_header(info.header, recording.string()));
  if (!setup.camera) {
    if (const auto note = note_beside(recording, kCameraNote)) {
      E2LF_ASSIGN_OR_RETURN(setup.camera, capture::camera_from_json(*note, beside));
    }
  }
  // The record takes precedence: with `e2lf convert --turn-views` it differs from the header, which is copied.
  if (const auto note = note_beside(recording, kViewsNote)) {
    E2LF_ASSIGN_OR_RETURN(setup.views, capture::orientation_from_name(note->value("views", ""), beside));
  } else {
    E2LF_ASSIGN_OR_RETURN(setup.views, capture::views_from_header(info.header, recording.string()));
  }
  if (!setup.views && setup.camera) setup.views = setup.camera->views;
  return setup;
}

Result<RecordedSetup> recorded_setup(const capture::MeasurementFile& file, const fs::path& path) {
  RecordedSetup setup;
  if (file.codes) {
    E2LF_ASSIGN_OR_RETURN(setup.codes, capture::codes_from_npy(*file.codes, path.string()));
  }
  if (file.camera) {
    E2LF_ASSIGN_OR_RETURN(setup.camera, capture::camera_from_npy(*file.camera, path.string() + ": camera"));
    setup.views = setup.camera->views;
  }
  if (file.views) {
    E2LF_ASSIGN_OR_RETURN(setup.views, capture::views_from_npy(*file.views, path.string() + ": views"));
  }
  return setup;
}

std::string recorded_colour_filter(const fs::path& events) {
  const auto note = note_beside(events, kColourNote);
  return note ? note->value("colours", "") : "";
}

void note_colour_filter(RunRecord& record, const std::string& filter, const fs::path& events) {
  if (!filter.empty()) note_with_size(record, kColourNote, {{"colours", filter}}, events);
}

}  // namespace e2lf::cli
