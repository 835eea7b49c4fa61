// SPDX-License-Identifier: MIT
#include "e2lf/cli/verbs/simulate_stream.h"

#include "e2lf/base/log.h"
#include "e2lf/base/stop.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/event_image_writer.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/cycles/shown_pattern.h"
#include "e2lf/recordings/recording.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

Result<streams::VirtualRig> make_rig(const StreamRun& run, StreamScene scene) {
  streams::RigOptions options;
  options.schedule = cycles::paper_schedule_of(run.codes);
  if (!run.flags.schedule.empty()) {
    E2LF_ASSIGN_OR_RETURN(options.schedule, cycles::read_schedule(run.flags.schedule));
    if (capture::codes_of_whole_cycle(run.codes)) options.schedule = with_all_transitions(std::move(options.schedule));
  }
  options.gain = run.gain;
  options.rise_us = run.flags.rise_us;
  if (!run.has_triggers) options.trigger_channel.reset();
  return streams::VirtualRig::create(run.codes, run.camera, run.stream, options, std::move(scene.scene), scene.height,
                                     scene.width);
}

/// Simulates every cycle. Returns the event images of the first one.
template <typename Use>
Result<capture::EventImages> play(const StreamRun& run, streams::VirtualRig& rig, RunRecord& record, const Use& use) {
  capture::EventImages first;
  uint64_t events = 0;
  ProgressBar bar("simulate", run.is_quiet);
  for (size_t cycle = 0; cycle < run.cycles && !(cycle > 0 && stop_requested()); ++cycle) {
    bar.update(cycle, run.cycles);
    E2LF_ASSIGN_OR_RETURN(const recordings::EventBatch batch, rig.play_cycle());
    if (cycle == 0) first = rig.sum_windows(batch);
    E2LF_RETURN_IF_ERROR(use(batch));
    events += batch.events.size();
  }
  record.note("events", events);
  record.note("events_lost_to_readout", rig.lost_events());
  if (rig.lost_events() > 0) {
    log_warning(cat(rig.lost_events(), " of ", events + rig.lost_events(),
                    " events waited too long for the readout and were lost"));
  }
  return first;
}

}  // namespace

Result<std::unique_ptr<recordings::RecordingWriter>> create_simulated_recording(const fs::path& place,
                                                                                const fs::path& output,
                                                                                const capture::RecordedSetup& setup,
                                                                                size_t height, size_t width,
                                                                                bool has_triggers) {
  recordings::RecordingInfo info;
  info.height = height;
  info.width = width;
  info.header = pipeline::header_of(setup);
  E2LF_ASSIGN_OR_RETURN(auto writer, recordings::create_recording(place, "", info));
  if (has_triggers && !writer->holds_triggers()) {
    log_warning(cat(output.string(), ": this format cannot hold triggers, so they are left out; write .raw, .hdf5 or ",
                    ".dat for them"));
  }
  return writer;
}

Result<capture::EventImages> simulate_stream(const StreamRun& run, const fs::path& place, const fs::path& output,
                                             RunRecord& record) {
  E2LF_ASSIGN_OR_RETURN(StreamScene scene,
                        open_stream_scene(run.input, run.flags, run.scene, run.stream.map_seed, run.is_quiet));
  const size_t height = scene.height, width = scene.width;
  E2LF_ASSIGN_OR_RETURN(streams::VirtualRig rig, make_rig(run, std::move(scene)));
  record.end_step("read");
  if (output.extension() == ".npz") {
    E2LF_ASSIGN_OR_RETURN(capture::EventImageWriter writer, capture::EventImageWriter::create(place));
    writer.keep(run.recorded);
    E2LF_ASSIGN_OR_RETURN(capture::EventImages first, play(run, rig, record, [&](const recordings::EventBatch& batch) {
                            return writer.add(rig.sum_windows(batch));
                          }));
    E2LF_RETURN_IF_ERROR(writer.finish());
    return first;
  }
  E2LF_ASSIGN_OR_RETURN(const auto writer,
                        create_simulated_recording(place, output, run.recorded, height, width, run.has_triggers));
  E2LF_ASSIGN_OR_RETURN(capture::EventImages first, play(run, rig, record, [&](const recordings::EventBatch& batch) {
                          return writer->write(batch);
                        }));
  E2LF_RETURN_IF_ERROR(writer->finish());
  return first;
}

}  // namespace e2lf::cli
