// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/recorded_setup.h"

#include "e2lf/cycles/schedule.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/file.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/recordings/open/registry.h"

namespace e2lf::pipeline {

bool are_patterns_stated(const std::optional<KnownCodes>& known) {
  return known && (known->stated_by == StatedBy::kCaller || known->stated_by == StatedBy::kEvents);
}

capture::Codes codes_for(const model::Model& model, const capture::Codes& codes) {
  const bool is_whole = model.num_patterns == 2 * codes.num_patterns + 1 && model.num_patterns != codes.num_patterns;
  return is_whole ? capture::whole_cycle(codes) : codes;
}

std::optional<KnownCodes> known_codes(const std::optional<capture::Codes>& of_caller,
                                      const std::optional<capture::Codes>& of_events, const model::Model* model) {
  KnownCodes known;
  if (model != nullptr) {
    known.constants = model->constants;
    known.event_model = model->event_model;
    known.measurement = model->measurement();
  }
  const auto take = [&](const std::optional<capture::Codes>& codes, StatedBy stated_by) {
    if (!codes || known.stated_by != StatedBy::kNone) return;
    known.codes = model != nullptr ? codes_for(*model, *codes) : *codes;
    known.stated_by = stated_by;
  };
  take(of_caller, StatedBy::kCaller);
  take(of_events, StatedBy::kEvents);
  if (model != nullptr) take(model->codes, StatedBy::kModel);
  if (known.stated_by == StatedBy::kNone) return std::nullopt;
  return known;
}

Result<capture::Codes> usual_patterns() {
  const auto path = bundled_model();
  return path ? read_patterns(*path) : capture::default_codes();
}

Result<capture::Codes> read_patterns(const std::filesystem::path& path) {
  if (path.extension() != kBundledModels.extension) return capture::read_codes(path);
  E2LF_ASSIGN_OR_RETURN(model::Model model, model::read_model(path));
  if (model.codes) return std::move(*model.codes);
  return fail(ErrorCode::kNotFound, path,
              "the model contains no aperture patterns; give a file that does: for those of the paper, the model that "
              "`e2lf model import --release FOLDER` writes");
}

namespace fs = std::filesystem;
namespace {

constexpr const char *kCodesNote = "recorded_codes", *kCameraNote = "recorded_camera", *kViewsNote = "recorded_views";
constexpr const char* kSize = "recording_bytes";

/// Returns the size of a recording, which distinguishes it from another that replaced it.
uint64_t size_of(const fs::path& path) {
  std::error_code error;
  const uint64_t bytes = fs::file_size(path, error);
  return error ? 0 : bytes;
}

Json with_size(Json note, const fs::path& recording) {
  note[kSize] = size_of(recording);
  return note;
}

/// Returns a note of the run record beside a recording, or nothing if the file with this name is not a record of e2lf
/// or describes another recording.
std::optional<Json> note_beside(const fs::path& named, const char* key) {
  const fs::path recording = recordings::file_of_recording(named.string());
  if (recording.empty()) return std::nullopt;
  const fs::path path = path_beside(recording, record_path_beside);
  if (!is_file(path)) return std::nullopt;
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

Json setup_notes(const capture::RecordedSetup& setup, const fs::path& recording) {
  Json notes = Json::object();
  if (setup.codes) notes[kCodesNote] = with_size(capture::codes_to_json(*setup.codes), recording);
  if (setup.camera) notes[kCameraNote] = with_size(capture::to_json(*setup.camera), recording);
  if (setup.has_own_views()) {
    notes[kViewsNote] = with_size({{"views", capture::orientation_name(*setup.views)}}, recording);
  }
  return notes;
}

Result<capture::RecordedSetup> recorded_setup(const fs::path& recording, const recordings::RecordingInfo& info) {
  E2LF_ASSIGN_OR_RETURN(capture::RecordedSetup setup, capture::setup_from_header(info.header, recording.string()));
  const std::string beside = path_beside(recording, record_path_beside).string();
  if (const auto note = note_beside(recording, kCodesNote); note && !setup.codes) {
    E2LF_ASSIGN_OR_RETURN(setup.codes, capture::codes_from_json(*note, beside));
  }
  if (const auto note = note_beside(recording, kCameraNote); note && !setup.camera) {
    E2LF_ASSIGN_OR_RETURN(setup.camera, capture::camera_from_json(*note, beside));
    if (!setup.views) setup.views = setup.camera->views;
  }
  // The record takes precedence: with `e2lf convert --turn-views` it differs from the header, which is copied.
  if (const auto note = note_beside(recording, kViewsNote)) {
    E2LF_ASSIGN_OR_RETURN(setup.views, capture::orientation_from_name(note->value("views", ""), beside));
  }
  return setup;
}

Result<capture::RecordedSetup> setup_of_cycles(const fs::path& recording, const cycles::CycleReader& reader) {
  E2LF_ASSIGN_OR_RETURN(capture::RecordedSetup setup, recorded_setup(recording, reader.recording().info()));
  const cycles::Schedule& schedule = reader.schedule();
  if (schedule.views) setup.views = schedule.views;
  if (!setup.codes) setup.codes = schedule.codes;
  if (!setup.codes) return setup;
  if (auto codes = cycles::codes_of_images(*setup.codes, schedule)) setup.codes = std::move(codes);
  return setup;
}

}  // namespace e2lf::pipeline
