// SPDX-License-Identifier: MIT
// The target of model files: the input is one.
#include "e2lf/model/model.h"
#include "e2lf/video/import_event_video.h"
#include "require.h"
#include "scratch.h"

namespace {

/// The same file taken for a model of frames, and for the checkpoint of one.
void read_as_video(const std::filesystem::path& path, const e2lf::fuzz::ScratchFolder& folder) {
  using namespace e2lf::video;
  using e2lf::fuzz::require;
  const auto imported = import_event_video(path);
  require(imported.ok() || !imported.error().message.empty(), "an error says what is wrong");
  const auto model = read_video_model(path);
  if (!model) return;
  require(validate(*model, "input").ok(), "a model that was read is valid");
  (void)summary_json(*model);
  const auto again = folder.path() / "again.safetensors";
  require(write_video_model(again, *model).ok(), "it can be written");
  const auto back = read_video_model(again);
  require(back.ok() && back->weights == model->weights && back->network == model->network, "it comes back as written");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace e2lf::model;
  using e2lf::fuzz::require;
  static const e2lf::fuzz::ScratchFolder folder;
  const auto input = folder.put("input.safetensors", {data, size});
  read_as_video(input, folder);
  const auto model = read_model(input);
  if (!model) {
    require(!model.error().message.empty(), "an error says what is wrong");
    return 0;
  }
  require(validate(*model, "input").ok(), "a model that was read is valid");
  (void)summary_json(*model);
  const auto path = folder.path() / "again.safetensors";
  require(write_model(path, *model).ok(), "it can be written");
  const auto back = read_model(path);
  require(back.ok() && back->weights == model->weights && back->codes == model->codes, "it comes back as written");
  return 0;
}
