// SPDX-License-Identifier: MIT
// The program e2lf.
#include <cstdio>
#include <string>
#include <vector>

#include "e2lf/base/isa.h"
#include "e2lf/cameras/cameras.h"
#include "e2lf/cli/features.h"
#include "e2lf/cli/verbs.h"
#if E2LF_TORCH_DEVICES
#include "e2lf/device/torch_device.h"
#endif
#include "e2lf/formats/formats.h"
#include "e2lf/info/version.h"
#include "e2lf/video/operations.h"

namespace {

using namespace e2lf::cli;  // the list of verbs

int run_verb(const std::vector<std::string>& arguments) {
  const std::vector<VerbEntry> verbs = {
      {"demo", "simulate a scene, reconstruct its light field, measure it", run_demo},
      {"info", "describe a file or folder", run_info},
      {"convert", "convert between event formats, or between light-field formats", run_convert},
      {"accumulate", "recording -> event images per pattern cycle", run_accumulate},
      {"simulate", "light field -> event images or a recording", run_simulate},
      {"reconstruct", "event images or a recording -> light field", run_reconstruct},
      {"record", "live camera, pipe or socket -> recording, byte for byte", run_record},
      {"camera", "list and check live cameras", run_camera},
      {"check", "recording or camera -> one page on the rig: light, pixels, triggers, patterns", run_check},
      {"video", "recording -> grey frames", run_video},
      {"calibrate", "event images of static scenes -> constants of a camera", run_calibrate},
      {"eval", "compare a reconstruction with the ground truth", run_eval},
      {"compare", "compare methods over scenes, sensors and seeds", run_compare},
      {"depth", "light field -> disparity map", run_depth},
      {"refocus", "light field -> refocused images with a wide aperture", run_refocus},
      {"epi", "light field -> epipolar plane image", run_epi},
      {"animate", "light field -> film with a moving viewpoint or focus", run_animate},
      {"view", "show light fields, events, recordings and models in a browser", run_view},
      {"live", "show light fields while the camera records", run_live},
      {"pack", "light fields and photographs -> one file for training", run_pack},
      {"train", "learn aperture patterns and a network jointly", run_train},
      {"resume", "continue a training run", run_resume},
      {"codes", "show and render aperture patterns", run_codes},
      {"model", "describe, import, store and export model files", run_model},
  };
  return run_subverb("", verbs, arguments);
}

int run(const std::vector<std::string>& arguments) {
  const std::string first = arguments.empty() ? "" : arguments.front();
  if (first == "--version" || first == "version") {
    std::printf("e2lf %s\n%sinstructions: %s\n", e2lf::info::kVersion, kFeatures, e2lf::current_isa().c_str());
    return 0;
  }
  if (first != "complete") return run_verb(arguments);
  // Not in the list of verbs, because only completion.bash uses it.
  set_completing();
  return run_verb({arguments.begin() + 1, arguments.end()});
}

}  // namespace

int main(int argc, char** argv) {
  e2lf::formats::add_formats();
  e2lf::cameras::add_cameras();
  e2lf::video::add_operations();  // any model may have them
#if E2LF_TORCH_DEVICES
  e2lf::device::add_torch_devices();
#endif
  return run_program("e2lf", argc, argv, run);
}
