// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

/// The help of verbs, and the groups in which it shows options.
namespace e2lf::program {

/// The groups of options; OptionGroup declares them. The word before the colon is that of
/// --help=WORD. Options without a group are those that --help always shows.
inline constexpr char kRunOptions[] = "run: configuration file, number of threads and seed",
                      kNetworkOptions[] = "network: its arithmetic, what computes it, and the brightness of its output",
                      kCycleOptions[] = "cycles: when the patterns of a recording change",
                      kRecordingOptions[] = "recordings: which part of them is read, and their clock",
                      kTableOptions[] = "tables: recordings that do not state their format, sensor or columns",
                      kCameraOptions[] = "cameras: settings of a live camera",
                      kLightFieldOptions[] = "light-fields: which views are read, and how files store them",
                      kOrientationOptions[] = "orientation: turned or mirrored views",
                      kMapOptions[] = "map: view, range and points of disparity maps of light fields",
                      kStreamOptions[] = "stream: simulation event by event, of scenes that move",
                      kSensorOptions[] = "sensor: constants of the paper's event models",
                      kDisplayOptions[] = "display: size and orientation of the patterns on the display";

/// The options that apply to recordings alone, and not to event images.
inline const std::vector<std::string> kOptionsOfRecordings = {kCycleOptions, kRecordingOptions, kTableOptions};

/// While it exists, new options of `app` are in this group.
class OptionGroup {
 public:
  OptionGroup(CLI::App& app, const char* group) : app_(app), before_(app.option_defaults()->get_group()) {
    app.option_defaults()->group(group);
  }
  ~OptionGroup() { app_.option_defaults()->group(before_); }
  OptionGroup(const OptionGroup&) = delete;
  OptionGroup& operator=(const OptionGroup&) = delete;

 private:
  CLI::App& app_;
  std::string before_;
};

/// Returns the words of the groups that the options of `app` have, in the order of their declaration.
[[nodiscard]] std::vector<std::string> help_groups(const CLI::App& app);

/// Returns the text of --help: everything if there are few options, and otherwise those without a group and the list of
/// groups.
[[nodiscard]] std::string short_help(const CLI::App& app);

/// Returns the text of --help-all.
[[nodiscard]] std::string whole_help(const CLI::App& app);

/// Returns the text of --help=WORD, or nothing if no option of `app` has this group.
[[nodiscard]] std::optional<std::string> group_help(const CLI::App& app, const std::string& word);

}  // namespace e2lf::program
