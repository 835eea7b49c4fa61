// SPDX-License-Identifier: MIT
// e2lf-bench: measures speed against the peers in the same run.
#include "bench/program/parts.h"
#include "e2lf/cameras/cameras.h"
#include "e2lf/formats/formats.h"
#include "e2lf/video/operations.h"

namespace e2lf::bench {
namespace {

int run(const std::vector<std::string>& arguments) {
  return program::run_subverb(
      "",
      {{"camera", "what each imperfection of a camera costs, for each model", run_camera},
       {"decode", "RAW recordings, against the scalar reference", run_decode},
       {"depth", "disparity maps, against true ones", run_depth},
       {"motion", "what the whole cycle gains or loses if the scene moves", run_motion},
       {"reconstruct", "the network, against oneDNN, libtorch and the machine's peak", run_reconstruct},
       {"rig", "one cycle from light field to light field, each stage", run_rig},
       {"simulate", "the event simulation, against the scalar reference", run_simulate},
       {"video", "networks that make frames of events, against libtorch", run_video},
       {"train", "training steps and the synthesis of data, against plain libtorch", run_train}},
      arguments);
}

}  // namespace
}  // namespace e2lf::bench

int main(int argc, char** argv) {
  e2lf::formats::add_formats();
  e2lf::cameras::add_cameras();
  e2lf::video::add_operations();  // any model may have them
  return e2lf::program::run_program("e2lf-bench", argc, argv, e2lf::bench::run);
}
