// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>

#include "e2lf/capture/measurement/event_images.h"
#include "e2lf/cli/flags/stream_flags.h"
#include "e2lf/cli/output/run_record.h"
#include "e2lf/pipeline/recorded_setup.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::cli {

/// The inputs and options of an event-by-event simulation.
struct StreamRun {
  std::filesystem::path input;
  StreamFlags flags;
  SceneOptions scene;
  capture::Codes codes;
  capture::SensorProfile camera;
  capture::RecordedSetup recorded;  ///< the setup that is stored in the result
  streams::StreamOptions stream;
  float gain = 1.0F;
  size_t cycles = 1;
  bool has_triggers = true, is_quiet = false;
};

/// Creates the recording that is simulated, with the setup in its header. Warns if the events have triggers that its
/// format cannot hold; `output` is its name in the warning.
[[nodiscard]] Result<std::unique_ptr<recordings::RecordingWriter>> create_simulated_recording(
    const std::filesystem::path& place, const std::filesystem::path& output, const capture::RecordedSetup& setup,
    size_t height, size_t width, bool has_triggers);

/// Writes the recording of a virtual rig to `place`, or, if that is an .npz, the event images of its windows. `output`
/// is its name in messages. Returns the event images of the first cycle. Fails as the rig and the writers do.
[[nodiscard]] Result<capture::EventImages> simulate_stream(const StreamRun& run, const std::filesystem::path& place,
                                                           const std::filesystem::path& output, RunRecord& record);

}  // namespace e2lf::cli
