// SPDX-License-Identifier: MIT
#include "e2lf/recordings/open/registry.h"

#include <algorithm>
#include <deque>
#include <fstream>
#include <mutex>
#include <string_view>
#include <sys/stat.h>
#include <unistd.h>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/recordings/batch_check.h"
#include "e2lf/recordings/codecs/codecs.h"

namespace e2lf::recordings {
namespace fs = std::filesystem;
namespace {

std::deque<Codec> built_in_codecs() {
  return {
      {.name = "raw", .extensions = {".raw"}, .detect = is_raw_header, .open = open_raw, .create = create_raw},
      {.name = "evt2", .open = open_raw, .create = create_raw},
      {.name = "evt2.1", .open = open_raw, .create = create_raw},
      {.name = "evt3", .open = open_raw, .create = create_raw},
      {.name = "evt4", .open = open_raw},
      {.name = "hdf5",
       .extensions = {".hdf5"},
       .is_table = true,
       .detect = hdf5_events::detect,
       .open = hdf5_events::open,
       .create_file = hdf5_events::create_file},
  };
}

/// Codecs in the table never move, because others point to them.
struct Table {
  std::mutex mutex;
  std::deque<Codec> codecs = built_in_codecs();
};

Table& codec_table() {
  static Table instance;
  return instance;
}

using namespace std::string_view_literals;

/// The first bytes of a kind of file, and its description.
struct Beginning {
  std::string_view bytes;
  size_t offset;
  const char* text;
};

constexpr Beginning kBeginnings[] = {
    {"PK\x03\x04"sv, 0, "a zip archive; unpack it and give the recording in it, or give event images as a file"},
    {"\x1F\x8B"sv, 0, "compressed by gzip; unpack it with `gunzip`, then give the recording in it"},
    {"\x28\xB5\x2F\xFD"sv, 0, "compressed by Zstandard; unpack it with `zstd -d`, then give the recording in it"},
    {"BZh"sv, 0, "compressed by bzip2; unpack it with `bzip2 -d`, then give the recording in it"},
    {"\3757zXZ\0"sv, 0, "compressed by xz; unpack it with `xz -d`, then give the recording in it"},
    {"\x04\x22\x4D\x18"sv, 0, "compressed by lz4; unpack it with `lz4 -d`, then give the recording in it"},
    {"7z\xBC\xAF\x27\x1C"sv, 0, "a 7-Zip archive; unpack it with `7z x`, then give the recording in it"},
    {"ustar"sv, 257, "a tar archive; unpack it with `tar -xf`, then give the recording in it"},
    {"#ROSBAG V"sv, 0, "a bag of ROS 1; convert it to one of ROS 2 with `rosbags-convert` (Python package rosbags)"},
    {"Event Stream"sv, 0, "an Event Stream file (.es); convert it to CSV with `faery`"},
    {"#!AER-DAT4"sv, 0, "an AEDAT4 recording whose header is damaged; record or copy the file again"},
    {"#!AER-DAT2"sv, 0,
     "an AEDAT recording of version 2; convert it with examples/python/aedat2_to_csv.py, or let v2e write its events "
     "with its option dvs_h5"},
    {"#!AER-DAT"sv, 0, "an AEDAT recording of version 1 or 3; convert it to AEDAT4 with the converter of DV"},
    {"[["sv, 0, "JSON; write the events as .csv or .npy"},
    {"[{"sv, 0, "JSON; write the events as .csv or .npy"},
    {"version https://git-lfs"sv, 0, "a pointer of Git LFS and not the file itself; fetch it with `git lfs pull`"},
    {"\x89PNG"sv, 0, "an image (PNG) and not a recording of events"},
    {"\xFF\xD8\xFF"sv, 0, "an image (JPEG) and not a recording of events"},
    {"MATLAB 5.0"sv, 0,
     "a MATLAB file without event images or a light field; write events as .csv with the columns t, x, y, p"},
    {"\x76\x2F\x31\x01"sv, 0, "an OpenEXR image; write views as PNG of 16 bits"},
    {"\x80\x04"sv, 0, "a Python pickle, which may run programs; write its arrays with numpy.savez"},
    {"\x80\x05"sv, 0, "a Python pickle, which may run programs; write its arrays with numpy.savez"},
    {"\x89LFP"sv, 0, "a picture of a Lytro camera; decode it to .mat with the Light Field Toolbox"},
};

/// Describes a file that begins with `head` and is not a readable recording, and what to do with it, e.g. "a zip
/// archive; unpack it, then give the recording in it". Returns nothing if the bytes are not conclusive. Names of files
/// do not matter.
std::optional<std::string> foreign_file_text(std::span<const uint8_t> head) {
  const std::string_view text = as_text(head);
  for (const Beginning& beginning : kBeginnings) {
    if (text.size() < beginning.offset || !text.substr(beginning.offset).starts_with(beginning.bytes)) continue;
    const std::string_view what = beginning.text;
    return what.find(';') != std::string_view::npos
               ? std::string(what)
               : cat(what, "; give a recording, e.g. .raw, .hdf5, .aedat4 or .csv");
  }
  return std::nullopt;
}

const Codec* codec_of_extension(const fs::path& path) {
  const std::string extension = lower_case(path.extension().string());
  if (extension.empty()) return nullptr;
  for (const Codec* codec : codecs()) {
    const auto& known = codec->extensions;
    if (std::ranges::find(known, extension) != known.end()) return codec;
  }
  return nullptr;
}

std::vector<std::string> codec_names(bool to_write = false) {
  std::vector<std::string> names;
  for (const Codec* codec : codecs()) {
    if (!to_write || codec->create != nullptr || codec->create_file != nullptr) names.push_back(codec->name);
  }
  return names;
}

Result<const Codec*> detect_codec(ByteSource& source) {
  E2LF_ASSIGN_OR_RETURN(const std::span<const uint8_t> head, source.fetch(kDetectBytes));
  if (head.empty())
    return fail(ErrorCode::kTruncated, source.name(), "the input is empty; check whether it was written completely");
  for (const Codec* codec : codecs()) {
    if (codec->detect != nullptr && codec->detect(head)) return codec;
  }
  const fs::path path = source.path();
  const Codec* const by_extension = codec_of_extension(path);
  // An archive of arrays without known names is still an archive of arrays.
  const bool is_npz = by_extension != nullptr && by_extension->name == "npz" && head.front() == 'P';
  if (const auto text = foreign_file_text(head); text && !is_npz) {
    return fail(ErrorCode::kUnsupported, source.name(), "this is ", *text);
  }
  if (by_extension != nullptr) return by_extension;
  return Error{ErrorCode::kFormat,
               cat("this is not a recording of a known format; give its format, one of ", join(codec_names())),
               source.name(), "event_format"};
}

Error unsupported(const Codec& codec, const char* action, const std::string& name) {
  return fail(ErrorCode::kUnsupported, name, "cannot ", action, " the format ", codec.name, "; choose another");
}

/// Only formats that may contain several streams list them.
Result<ReaderPtr> check_stream(ReaderPtr reader) {
  const RecordingInfo& info = reader->info();
  if (reader->options().stream.empty() || !info.streams.empty()) return reader;
  return Error{
      ErrorCode::kInvalidValue,
      cat("a recording of the format ", info.format, " contains only one stream of events; leave the option out"),
      reader->name(), "stream"};
}

/// Returns the properties of a new recording: its format is the codec, except that "raw" comprises several.
RecordingInfo info_for(const Codec& codec, RecordingInfo info) {
  if (codec.name != "raw") info.format = codec.name;
  return info;
}

bool is_our_trigger_file(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(fs::symlink_status(path, error))) return false;
  const auto codec = codec_to_write(path, "");
  if (codec && (*codec)->is_side_file != nullptr) return (*codec)->is_side_file(path);
  std::ifstream file(path, std::ios::binary);
  std::string line;
  std::getline(file, line);
  return line == "p,id,t";
}

}  // namespace

std::vector<const Codec*> codecs() {
  const std::lock_guard<std::mutex> lock(codec_table().mutex);
  std::vector<const Codec*> all;
  for (const Codec& codec : codec_table().codecs) all.push_back(&codec);
  return all;
}

void add_codec(Codec codec) {
  const std::lock_guard<std::mutex> lock(codec_table().mutex);
  codec_table().codecs.push_front(std::move(codec));
}

Result<const Codec*> find_codec(const std::string& name) {
  for (const Codec* codec : codecs()) {
    if (codec->name == name) return codec;
  }
  return fail(ErrorCode::kInvalidValue, "", "unknown format \"", name, "\"; ", suggestion(name, codec_names()));
}

Result<const Codec*> codec_to_write(const fs::path& path, const std::string& format) {
  if (!format.empty()) return find_codec(format);
  if (const Codec* codec = codec_of_extension(path)) return codec;
  return Error{
      ErrorCode::kInvalidValue,
      cat("no format has this extension; give a name that ends in one, e.g. .raw or .hdf5",
          // Not all verbs have the option.
          option_hint("format").empty() ? "" : ", or give the format, one of " + join(codec_names(/*to_write=*/true))),
      path.string(), "format"};
}

bool is_recording_folder(const fs::path& path) {
  const auto all = codecs();
  return std::ranges::any_of(all,
                             [&](const Codec* codec) { return codec->is_folder != nullptr && codec->is_folder(path); });
}

Result<ReaderPtr> open_recording(SourcePtr source, const OpenOptions& options) {
  E2LF_ASSIGN_OR_RETURN(const Codec* codec,
                        options.format.empty() ? detect_codec(*source) : find_codec(options.format));
  if (codec->open == nullptr) return unsupported(*codec, "read", source->name());
  if (!codec->is_table) E2LF_RETURN_IF_ERROR(refuse_table_options(options, codec->name, source->name()));
  E2LF_ASSIGN_OR_RETURN(auto reader, codec->open(source, options));
  reader->count_losses([source] { return source->left_out(); });
  return check_stream(std::move(reader));
}

Result<ReaderPtr> open_recording(const fs::path& path, const OpenOptions& options) {
  for (const Codec* codec : codecs()) {
    if (codec->is_folder == nullptr || !codec->is_folder(path)) continue;
    E2LF_ASSIGN_OR_RETURN(auto reader, codec->open_folder(path, options));
    return check_stream(std::move(reader));
  }
  E2LF_ASSIGN_OR_RETURN(auto source, open_file_source(path));
  return open_recording(std::move(source), options);
}

Result<WriterPtr> create_recording(const fs::path& path, const std::string& format, const RecordingInfo& info) {
  E2LF_ASSIGN_OR_RETURN(const Codec* codec, codec_to_write(path, format));
  const bool to_stream = path == "-" || is_stream(path);
  if (to_stream && codec->create == nullptr && codec->create_file != nullptr) {
    return fail(ErrorCode::kUnsupported, path, "the format ", codec->name,
                " requires seeking, which a pipe or device does not support; give a file");
  }
  if (!to_stream && codec->create_file != nullptr) return codec->create_file(path, info_for(*codec, info));
  if (codec->create == nullptr) return unsupported(*codec, "write", path.string());
  E2LF_ASSIGN_OR_RETURN(auto sink, open_file_sink(path));
  return codec->create(std::move(sink), info_for(*codec, info));
}

Result<WriterPtr> create_recording(SinkPtr sink, const std::string& format, const RecordingInfo& info) {
  E2LF_ASSIGN_OR_RETURN(const Codec* codec, find_codec(format));
  if (codec->create == nullptr) return unsupported(*codec, "stream", sink->name());
  return codec->create(std::move(sink), info_for(*codec, info));
}

fs::path file_of_recording(const std::string& name) {
  std::error_code error;
  const fs::path path = name == "-"            ? fs::canonical("/proc/self/fd/0", error)
                        : is_camera_name(name) ? path_of_camera(name)
                                               : fs::path(name);
  return fs::is_regular_file(path, error) || fs::is_directory(path, error) ? path : fs::path();
}

Result<ReaderPtr> open_named_recording(const std::string& name, const OpenOptions& options) {
  struct stat input {};
  const bool is_pipe =
      name == "-" && ::fstat(STDIN_FILENO, &input) == 0 && (S_ISFIFO(input.st_mode) || S_ISSOCK(input.st_mode));
  const bool is_live = is_pipe || (name != "-" && is_live_recording(name));
  if (is_live && (is_camera_name(name) || has_cameras())) {
    E2LF_ASSIGN_OR_RETURN(auto source, open_live_bytes(name, options.camera));
    return open_recording(SourcePtr(std::move(source)), options);
  }
  if (has_settings(options.camera)) {
    return fail(ErrorCode::kInvalidValue, name, "camera settings do not apply to a file; leave them out");
  }
  return open_recording(fs::path(name), options);
}

OutputRules output_rules(const std::vector<fs::path>& inputs, bool overwrite) {
  OutputRules rules;
  rules.overwrite = overwrite;
  rules.is_live = !inputs.empty() && file_of_recording(inputs.front().string()).empty();
  for (const fs::path& input : inputs) {
    if (input.empty()) continue;
    const fs::path file = file_of_recording(input.string());
    rules.inputs.push_back(file.empty() ? input : file);
    if (!is_file(file)) continue;
    rules.read_beside.push_back(path_beside(file, record_path_beside));
    const auto codec = codec_to_write(file, "");
    if (codec && (*codec)->side_file != nullptr) rules.read_beside.push_back(path_beside(file, (*codec)->side_file));
  }
  return rules;
}

OutputRules recording_output_rules(const std::vector<fs::path>& inputs, bool overwrite, const Codec& codec) {
  OutputRules rules = output_rules(inputs, overwrite);
  rules.streams = codec.create != nullptr;
  rules.side = {codec.side_file, is_our_trigger_file};
  return rules;
}

}  // namespace e2lf::recordings
