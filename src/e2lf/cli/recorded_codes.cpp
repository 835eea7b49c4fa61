// SPDX-License-Identifier: MIT
#include "e2lf/cli/recorded_codes.h"

#include "e2lf/capture/codes_header.h"
#include "e2lf/capture/codes_io.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

constexpr const char* kNote = "recorded_codes";

/// What tells a recording from another that took its place.
uint64_t size_of(const fs::path& path) {
  std::error_code error;
  const uint64_t bytes = fs::file_size(path, error);
  return error ? 0 : bytes;
}

}  // namespace

void note_recorded_codes(RunRecord& record, const capture::Codes& codes, const fs::path& recording) {
  Json note = capture::codes_to_json(codes);
  note["recording_bytes"] = size_of(recording);
  record.note(kNote, std::move(note));
}

Result<std::optional<capture::Codes>> recorded_codes(const fs::path& recording, const recordings::RecordingInfo& info) {
  E2LF_ASSIGN_OR_RETURN(auto codes, capture::codes_from_header(info.header, recording.string()));
  if (codes) return codes;
  const fs::path path = record_path_beside(recording);
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return codes;
  // A file of this name that is no record of ours tells nothing.
  const auto record = read_json(path);
  if (!record || !record->is_object() || !record->contains("notes") || !record->at("notes").contains(kNote)) {
    return codes;
  }
  Json note = record->at("notes").at(kNote);
  if (!note.is_object() || note.value("recording_bytes", Json()) != Json(size_of(recording))) return codes;
  note.erase("recording_bytes");
  E2LF_ASSIGN_OR_RETURN(codes, capture::codes_from_json(note, path.string()));
  return codes;
}

}  // namespace e2lf::cli
