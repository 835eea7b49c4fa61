// SPDX-License-Identifier: MIT
// e2lf live: shows the light fields of a live source in a browser, at the rate of its pattern cycles
#include <algorithm>
#include <cstdio>

#include "e2lf/base/log.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/cameras/cameras.h"
#include "e2lf/cli/flags/event_flags.h"
#include "e2lf/cli/output/results.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/diagnose/event_images.h"
#include "e2lf/diagnose/event_order.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/live/page/live_page.h"
#include "e2lf/live/session.h"
#include "e2lf/pipeline/event_run.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/outputs.h"
#include "e2lf/program/sibling_program.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

constexpr size_t kUsualFusedCycles = 16;

struct LiveArguments {
  fs::path source, output, last, fine_model, depth_model;
  MethodFlags method;
  std::optional<live::PictureSize> size;
  size_t average = 1, fuse = kUsualFusedCycles;
  bool is_fuse_named = false;
  double seconds = 0;
  bool has_no_page = false, records = false;
  uint16_t port = 0;
  CycleFlags cycles;
  OrientationFlags orientation;
};

struct LiveSetup {
  std::unique_ptr<live::LiveReader> reader;
  std::vector<live::FieldMaker> makers;  ///< from the best network to the fastest
  live::FineMethod fine;
  live::SessionOptions options;
};

/// Returns the method that reconstructs frozen cycles in the best quality: several passes of this network.
live::FineMethod fine_method(recon::Reconstructor network, const capture::Orientation& views) {
  constexpr size_t kPasses = 4;
  return [network = std::move(network), views](const live::LiveField& frozen) -> Result<lightfield::LightField> {
    const auto method = [&](const capture::MeasurementView& counts, const ProgressFn& progress) {
      return network.reconstruct(counts, progress, network.num_passes(kPasses), frozen.cycle.cycles);
    };
    pipeline::FieldSequence sequence(method, {.gain = frozen.gain, .black = frozen.black});
    capture::Measurement measurement(frozen.cycle.images);
    if (model::is_conditioned_on_camera(network.model())) measurement.fused = frozen.cycle.fused;
    E2LF_ASSIGN_OR_RETURN(pipeline::Field field, sequence.next(measurement));
    if (!views.is_upright()) lightfield::orient(field.light_field, views);
    return std::move(field.light_field);
  };
}

/// Returns what makes the result of another network doubtful and is not known from the first one.
diagnose::Findings further_doubts(const diagnose::Findings& known, const diagnose::Findings& of_other) {
  diagnose::Findings further;
  for (const diagnose::Finding& finding : of_other) {
    const bool is_known = std::ranges::find(known, finding.message, &diagnose::Finding::message) != known.end();
    if (!is_known && diagnose::has_doubt({finding})) further.push_back(finding);
  }
  return further;
}

/// Opens the network of disparities: the one that is named, or else the bundled one for the patterns, if there is one.
Result<std::optional<pipeline::OpenedMethod>> open_depth(const LiveArguments& arguments, pipeline::MethodChoice choice,
                                                         const std::optional<pipeline::KnownCodes>& codes,
                                                         RunRecord& record) {
  choice.algorithm = pipeline::Algorithm::kDepth;
  choice.model.reset();
  if (codes) choice.codes = codes->codes;
  const bool is_named = !arguments.depth_model.empty();
  if (is_named) {
    E2LF_ASSIGN_OR_RETURN(choice.model, model::read_model(arguments.depth_model));
    record.add_input(arguments.depth_model);
  }
  auto method = pipeline::naming(arguments.source, pipeline::open_method(std::move(choice)));
  if (!method && !is_named) return std::optional<pipeline::OpenedMethod>();
  if (!method) return method.error();
  return std::optional(*std::move(method));
}

/// Lets the reader fuse cycles, or says why it does not.
void prepare_fusion(const LiveArguments& arguments, const pipeline::OpenedMethod& method, LiveSetup& setup) {
  if (arguments.fuse == 1) {
    setup.options.fuse_obstacle = "--fuse 1 was given";
  } else if (!method.takes_sums()) {
    setup.options.fuse_obstacle = cat(method.network->model().name,
                                      " is not conditioned on the sensor profile; use a network that is, such as "
                                      "e2lf-n4-live");
    log_info(cat("cycles are not fused: ", setup.options.fuse_obstacle));
  } else {
    setup.reader->prepare_fusion(method.sensor(), arguments.fuse);
  }
}

/// Returns whether cycles are to be fused. Fails if the number of cycles is stated twice.
Result<bool> wants_fusion(const LiveArguments& arguments) {
  const bool is_fused = arguments.fuse > 1;
  if (is_fused && arguments.is_fuse_named && arguments.average > 1) {
    return fail(ErrorCode::kInvalidValue, "--fuse",
                "the cycles of a light field are summed already; omit --average or this option");
  }
  return is_fused && arguments.average == 1;
}

Result<LiveSetup> make_live_setup(const LiveArguments& arguments, const fs::path& recordings, RunRecord& record) {
  LiveSetup setup;
  E2LF_ASSIGN_OR_RETURN(pipeline::MethodChoice choice, named_choice(arguments.method, record));
  E2LF_ASSIGN_OR_RETURN(choice.prefers_conditioned, wants_fusion(arguments));
  choice.prefers_fast = true;
  CycleFlags flags = arguments.cycles;
  const live::OpenCycles open = [&](const auto& on_batch) {
    flags.events.cycles.on_batch = on_batch;
    return open_cycles(arguments.source, flags, choice);
  };
  E2LF_ASSIGN_OR_RETURN(
      setup.reader,
      live::LiveReader::open(open, {.recordings = recordings,
                                    .is_inverted = flags.events.cycles.invert_polarity,
                                    .max_cycles = flags.events.max_cycles,
                                    .speed = cameras::replay_speed(arguments.source.string()),
                                    .on_finding = [source = arguments.source.string()](const auto& finding) {
                                      diagnose::log_findings(source, {finding});
                                    }}));
  const cycles::CycleReader& cycles = setup.reader->cycles();
  E2LF_ASSIGN_OR_RETURN(choice.events, pipeline::setup_of_cycles(arguments.source, cycles));
  choice.transitions = cycles.schedule().num_images();
  choice.schedule = &cycles.schedule();
  choice.use.fused_cycles = arguments.is_fuse_named ? arguments.fuse : 1;
  E2LF_ASSIGN_OR_RETURN(const pipeline::OpenedMethod method,
                        pipeline::naming(arguments.source, pipeline::open_method(choice)));
  choice.use = {};
  record_method(method, record);
  setup.reader->add_findings(method.findings);
  E2LF_ASSIGN_OR_RETURN(const auto depth, open_depth(arguments, choice, method.codes, record));
  if (depth) {
    setup.options.depth = *depth->network;
    setup.reader->add_findings(further_doubts(method.findings, depth->findings));
  }
  pipeline::OpenedMethod best = method;
  choice.prefers_fast = false;
  if (!arguments.fine_model.empty()) {
    E2LF_ASSIGN_OR_RETURN(choice.model, model::read_model(arguments.fine_model));
    record.add_input(arguments.fine_model);
  }
  if (!arguments.fine_model.empty() || method.bundled) {
    E2LF_ASSIGN_OR_RETURN(best, pipeline::naming(arguments.source, pipeline::open_method(std::move(choice))));
    setup.reader->add_findings(further_doubts(method.findings, best.findings));
  }
  E2LF_ASSIGN_OR_RETURN(const pipeline::Tone tone, tone_of(arguments.method));
  setup.options.tone = method.complete(tone);
  setup.options.size = arguments.size;
  setup.options.views = arguments.orientation.after(method.views).value_or(capture::Orientation{});
  setup.reader->set_average(arguments.average);
  prepare_fusion(arguments, method, setup);
  if (arguments.method.codes.model.empty() && best.network->model().name != method.network->model().name) {
    setup.makers.emplace_back(*best.network);
  }
  setup.makers.emplace_back(*method.network);
  setup.options.check = [method](const capture::EventImages& events, size_t summed, bool is_confirmed) {
    diagnose::Findings findings = diagnose::check_event_images(events, summed);
    if (!findings.empty() || !is_confirmed) return findings;
    if (auto other = diagnose::check_order(events, summed, method.known_setup()))
      return diagnose::Findings{*std::move(other)};
    const auto check = pipeline::FieldCheck::create(method, summed);
    if (!check || !*check) return findings;  // for example, a network that takes no sums
    const auto explained = (*check)->judge_events(events);
    return explained && *explained ? (*explained)->findings : findings;
  };
  setup.options.judge_gain = [method](float gain) { return pipeline::gain_finding(method, gain); };
  setup.fine = fine_method(*best.network, setup.options.views);
  return setup;
}

Json field_json(const live::FieldReport& field) {
  return {{"field", field.serial},
          {"cycle", field.cycle},
          {"begin_us", field.begin_us},
          {"cycles", field.cycles},
          {"fused_cycles", field.fused_cycles},
          {"events", field.events},
          {"confidence", field.confidence},
          {"size", live::size_name(field.level.size)},
          {"reconstruct_s", field.reconstruct_s},
          {"latency_s", field.latency_s}};
}

void print_field(const live::FieldReport& field, const CommonOptions& common) {
  if (common.json) {
    std::printf("%s\n", field_json(field).dump().c_str());
  } else if (!common.quiet) {
    std::printf("light field %llu of cycle %llu: %s size, reconstructed in %.3f s, latency %.3f s\n",
                static_cast<unsigned long long>(field.serial), static_cast<unsigned long long>(field.cycle),
                live::size_name(field.level.size), field.reconstruct_s, field.latency_s);
  }
  std::fflush(stdout);
}

void print_totals(const Json& totals, const CommonOptions& common) {
  if (common.json) {
    std::printf("%s\n", Json{{"totals", totals}}.dump(-1, ' ', false, Json::error_handler_t::replace).c_str());
  } else if (!common.quiet) {
    std::string sizes;
    for (const auto& [size, count] : totals["fields_of_size"].items()) {
      sizes += cat(sizes.empty() ? " (" : ", ", count.get<size_t>(), " of ", size, " size");
    }
    if (!sizes.empty()) sizes += ")";
    std::printf(
        "%zu cycles in %.1f s: %zu light fields%s, %zu cycles skipped, of which %zu had been late when they were "
        "read; latency %.3f s (median), %.3f s (90 %%)\n",
        totals["cycles"].get<size_t>(), totals["seconds"].get<double>(), totals["fields"].get<size_t>(), sizes.c_str(),
        totals["skipped_cycles"].get<size_t>(), totals["late_cycles"].get<size_t>(),
        totals["latency_s"]["median"].get<double>(), totals["latency_s"]["p90"].get<double>());
  }
}

Result<void> write_last(live::Session& session, OutputFile& output, const RunRecord& record) {
  // What ended the session would also end the network.
  const int ended_by = stop_signal();
  request_stop(0);
  const auto last = session.freeze();
  if (ended_by != 0) request_stop(ended_by);  // or else a signal that has come meanwhile counts
  if (!last) return last.error();
  E2LF_RETURN_IF_ERROR(
      lightfield::write_light_field(output.path(), last->light_field, {.format = lightfield::LightFieldFormat::kNpy}));
  E2LF_RETURN_IF_ERROR(record.write(output.record_path()));
  return output.commit();
}

Result<void> run_session(const LiveArguments& arguments, LiveSetup setup, const Verb& verb, RunRecord& record,
                         OutputFile* last) {
  const CommonOptions& common = verb.common();
  std::vector<std::string> networks;
  for (const live::FieldMaker& maker : setup.makers) networks.push_back(maker.reconstructor().model().name);
  setup.options.on_level = [networks](const live::QualityLevel& level) {
    log_info(cat("the light fields now have ", live::size_name(level.size), " size and are reconstructed by ",
                 networks[level.network], ", to keep pace with the cycles"));
  };
  if (arguments.has_no_page || common.json) {
    setup.options.on_field = [&common](const live::FieldReport& field) { print_field(field, common); };
  }
  live::Session session(std::move(setup.reader), std::move(setup.makers), std::move(setup.options));
  std::optional<live::LivePage> page;
  if (!arguments.has_no_page) {
    E2LF_ASSIGN_OR_RETURN(page, live::start_live_page(session, std::move(setup.fine),
                                                      arguments.cycles.recording.open.camera.running, arguments.port));
    if (common.json) {
      std::printf("%s\n", Json{{"url", page->url}}.dump().c_str());
    } else {
      std::printf("open %s in a browser; press Ctrl-C to end\n", page->url.c_str());
    }
    std::fflush(stdout);
  }
  if (arguments.records) E2LF_RETURN_IF_ERROR(session.reader().recorder().begin());
  session.start();
  std::optional<Deadline> deadline(arguments.seconds);
  const Result<void> ended = session.wait();
  if (page && !stop_requested()) {
    hide_progress();
    std::fprintf(stderr, "the source has ended; the last light field is shown at %s; press Ctrl-C to end\n",
                 page->url.c_str());
  }
  if (page) E2LF_RETURN_IF_ERROR(page->finish());
  deadline.reset();  // it would end the last light field, too
  const cycles::CycleReader& cycles = session.reader().cycles();
  warn_of_losses(arguments.source, cycles.summary());
  verb.set_failed_input(cycles.summary().live.failure);
  const Json totals = session.json();
  record.note("totals", totals);
  print_totals(totals, common);
  if (!ended) return ended;
  if (totals["cycles"] == 0) {
    return no_cycle_error(arguments.source, session.reader().rig(), cycles);
  }

  if (last != nullptr) E2LF_RETURN_IF_ERROR(write_last(session, *last, record));
  const Json recording = session.reader().recorder().json();
  if (recording["error"] == "") return {};
  return fail(ErrorCode::kIo, "", "the recording is incomplete: ", recording["error"].get<std::string>());
}

Result<void> go_live(const LiveArguments& arguments, const Verb& verb) {
  if (!arguments.has_no_page && !kHasViewer) return no_viewer_error();
  E2LF_RETURN_IF_ERROR(require_device(arguments.method.choice.device));
  if (!is_live(arguments.source)) {
    return fail(ErrorCode::kInvalidValue, arguments.source,
                "a file is not a live source; give replay:FILE to play it at its own speed");
  }
  if (arguments.records && arguments.output.empty()) {
    return fail(ErrorCode::kInvalidValue, "--record", "recordings require a folder; set it with -o");
  }
  RunRecord record(verb);
  GrowingFolder folder("live", {});
  if (!arguments.output.empty()) {
    E2LF_RETURN_IF_ERROR(folder.open(arguments.output, output_rules(verb), record.json_so_far()));
  }
  std::optional<OutputFile> last;
  if (!arguments.last.empty()) {
    E2LF_ASSIGN_OR_RETURN(last, open_output(arguments.last, verb, ".npy"));
  }
  Result<void> ran;
  auto setup = make_live_setup(arguments, folder.path(), record);
  if (!setup) {
    ran = setup.error();
  } else {
    ran = run_session(arguments, std::move(*setup), verb, record, last ? &*last : nullptr);
  }
  if (arguments.output.empty()) return ran;
  E2LF_ASSIGN_OR_RETURN(Json about, record.json());
  const Result<void> written = folder.write_record(std::move(about));
  if (!ran) folder.withdraw();
  return ran ? written : ran;
}

}  // namespace

int run_live(const std::vector<std::string>& arguments) {
  Verb verb("live",
            "Show light fields in a browser while the camera records, at the rate of its pattern cycles. The newest "
            "cycle is always reconstructed next; cycles that arrive too fast are skipped and counted.",
            "e2lf live replay:capture.raw");
  LiveArguments live_arguments;
  live_arguments.cycles.recording.open.camera.running = std::make_shared<recordings::RunningCamera>();
  CLI::App& app = verb.app();
  app.add_option("input,-i,--input", live_arguments.source,
                 "camera://NAME, - for standard input, the path of a named pipe, tcp://127.0.0.1:PORT, or replay:FILE "
                 "(a recording at its own speed)")
      ->required();
  add_method_options(app, live_arguments.method, "the source");
  add_tone_options(app, live_arguments.method);
  add_choice(app, "--size", live_arguments.size, live::kPictureSizes,
             "full; half or quarter (each pixel is the sum of a block of 2x2 or 4x4); auto selects the largest that "
             "keeps pace, and a better network if it does so, too");
  add_count(app, "--average", live_arguments.average, 1, live::kMostCycles,
            "number of the last cycles that are summed, for static scenes");
  CLI::Option* const fuse = add_count(
      app, "--fuse", live_arguments.fuse, 1, recon::kMostFusedCycles,
      "average each pixel over up to this number of cycles, but none from before the scene changed there; 1 = "
      "off, as with --average or networks that are not conditioned on the sensor profile");
  add_model_option(
      app, "--fine", live_arguments.fine_model,
      "network that reconstructs a frozen cycle in several passes; default: that of -m, or the best bundled one")
      ->group(kNetworkOptions);
  add_model_option(app, "--depth-model", live_arguments.depth_model,
                   "network that estimates disparities from the events; default: the bundled one for the patterns");
  app.add_option("-o,--output", live_arguments.output, "folder for recordings; without it, recording is not possible");
  app.add_flag("--record", live_arguments.records, "record to -o from the start; the page can switch this on and off");
  app.add_option("--last", live_arguments.last, "write the last light field to this .npy file (float32, upright)");
  app.add_flag("--no-page", live_arguments.has_no_page,
               "serve no page; print a line for each light field and the totals, and end with the source");
  app.add_option("--seconds", live_arguments.seconds, "end after this time; 0 = when the source ends or on Ctrl-C")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  add_count(app, "--port", live_arguments.port, 0, 65535,
            "port of 127.0.0.1 on which the page is served; 0 = a free one");
  add_cycle_options(app, live_arguments.cycles);
  add_orientation_options(app, live_arguments.orientation);
  verb.stop_gently();
  return verb.run(arguments, [&] {
    // A run that is repeated from its record also repeats the default.
    live_arguments.is_fuse_named = fuse->count() > 0 && fuse->results().back() != fuse->get_default_str();
    return go_live(live_arguments, verb);
  });
}

}  // namespace e2lf::cli
