// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <csignal>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "e2lf/base/progress.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/cli/flags/event_flags.h"
#include "e2lf/depth/disparity_error.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/pipeline/event_run.h"
#include "e2lf/program/outputs.h"

namespace e2lf::cli {

/// Writes a reconstructed light field to an existing folder: its views in `format` ("png" and "png16": VV_UU.png;
/// "npy": lightfield.npy, not clamped), contact_sheet.png and epi.png. `views` is the orientation of the views; all
/// images are written upright, and `light_field` is upright afterwards. Only lightfield.npy keeps the order of the
/// views, which is that of the patterns.
[[nodiscard]] Result<void> write_reconstruction(const std::filesystem::path& folder,
                                                lightfield::LightField& light_field, const std::string& format,
                                                const capture::Orientation& views, const ProgressFn& progress);

/// Returns the name of the folder of a cycle: cycle_00000, cycle_00001, ...
[[nodiscard]] std::string cycle_name(size_t cycle);

/// The results of one run in a folder: a single one in the folder itself, or each in a folder of its own, which appears
/// complete when it is done, so that it can be used while later ones are computed. The folder itself appears with the
/// first result, so that an input without results replaces nothing, or, if the run is strict, at the end, when it is
/// known that no data were left out.
class ResultParts {
 public:
  ResultParts(ResultFolder folder, bool is_one, bool is_strict)
      : folder_(std::move(folder)), is_one_(is_one), is_strict_(is_strict) {}

  /// Returns the folder to which the next result is written.
  [[nodiscard]] Result<std::filesystem::path> begin(const std::string& name);
  /// Completes this result; `about` is the record of its folder. Fails as the functions of ResultFolder do.
  [[nodiscard]] Result<void> commit(const std::string& name, Json about, const program::RunRecord& run);
  /// Completes the run.
  [[nodiscard]] Result<void> finish(const program::RunRecord& run);

 private:
  ResultFolder folder_;
  bool is_one_, is_strict_, is_in_place_ = false;
};

/// Logs the course of a run from events, and converts it to JSON for the record.
class EventRunLog {
 public:
  /// Logs and records how the run was opened.
  EventRunLog(const pipeline::EventRun& run, std::filesystem::path input, RunRecord& record);

  /// Logs what was found of a result that is complete, and returns what the record states of it, apart from its files.
  [[nodiscard]] Json add(const pipeline::EventResult& result);

  /// Logs and records what the whole run found and left out, and returns it for --json: {"left_out", "findings"}. Fails
  /// if a recording contained no complete cycle.
  [[nodiscard]] Result<Json> finish(const Verb& verb, RunRecord& record);

 private:
  const pipeline::EventRun& run_;
  std::filesystem::path input_;
  LiveLog live_;
  size_t warned_ = 0;
};

/// Returns a line on the difference between the events of a cycle and those that its light field would cause, with the
/// verdict; empty if they were not compared.
[[nodiscard]] std::string event_error_text(const pipeline::EventResult& result);

/// Requests a stop after the given number of seconds. The destructor withdraws the request, so that the exit code does
/// not report a signal.
class Deadline {
 public:
  explicit Deadline(double seconds) {
    if (seconds <= 0) return;
    thread_ = std::jthread([this, seconds](const std::stop_token& is_over) {
      std::mutex mutex;
      std::unique_lock lock(mutex);
      std::condition_variable_any().wait_for(lock, is_over, std::chrono::duration<double>(seconds),
                                             [] { return false; });
      if (is_over.stop_requested() || stop_requested()) return;
      has_passed_ = true;
      request_stop(SIGTERM);
    });
  }
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;
  ~Deadline() {
    thread_ = {};
    if (has_passed_) request_stop(0);
  }

 private:
  bool has_passed_ = false;
  std::jthread thread_;
};

/// Whether this build includes `e2lf view`. Without it, what verbs show in the viewer fails with kMissingDependency.
#ifdef E2LF_NO_VIEWER
inline constexpr bool kHasViewer = false;
#else
inline constexpr bool kHasViewer = true;
#endif
/// Returns the error of what needs it, so that verbs fail before they open anything.
[[nodiscard]] Error no_viewer_error();

/// A light field, with the disparities of its middle view.
struct ComparedLightField {
  const lightfield::LightField& light_field;  ///< limited to [0, 1] for the figures, as its files are
  const lightfield::Image& disparity;
};

/// Writes a self-contained HTML file in which the viewer shows a scene beside its reconstruction, whose disparities
/// have this error. Fails with kIo, and with kUnsupported (a browser would not have enough memory for the views).
[[nodiscard]] Result<void> write_comparison_page(const std::filesystem::path& path, const ComparedLightField& truth,
                                                 const ComparedLightField& reconstruction,
                                                 const std::optional<depth::DisparityError>& error);

}  // namespace e2lf::cli
