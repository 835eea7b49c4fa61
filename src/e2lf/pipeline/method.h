// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "e2lf/pipeline/field_sequence.h"
#include "e2lf/pipeline/patterns.h"
#include "e2lf/pipeline/recorded_setup.h"

namespace e2lf::pipeline {

/// Says how light fields are to be made of measurements.
struct MethodChoice {
  std::string algorithm = "network";                  ///< or "inversion", "regularised", which need patterns alone
  std::optional<model::Model> model = {};             ///< of the network; nothing = the bundled one for the patterns
  std::optional<capture::Codes> codes = {};           ///< patterns that the caller names
  std::optional<capture::SensorProfile> camera = {};  ///< sensor profile that the caller names
  std::optional<capture::SensorConstants> constants = {};  ///< nothing = those of the model, or the paper's
  capture::RecordedSetup events = {};                      ///< what the file of the events tells
  capture::MeasurementKind measurement = capture::MeasurementKind::kEventImages;
  std::string precision = "auto";  ///< of the network
  bool prefers_fast = false;       ///< takes a bundled network that keeps the pace of a live source, if there is one
  bool lit_where_moving = false;   ///< opens a second network beside one of the whole cycle; see OpenedMethod::lit
};

/// Says how a method is used on each measurement.
struct MethodUse {
  size_t passes = 1;               ///< of the network over its pixel grid; see Reconstructor::reconstruct()
  size_t cycles = 1;               ///< number of cycles of a static scene over which counts are summed
  std::string colour_filter = {};  ///< of capture::colour_filter_from_name(); empty = grey
};

/// A method that is ready for any number of measurements, and what was decided on the way to it. Callers log and record
/// these decisions.
struct OpenedMethod {
  std::string algorithm;
  std::shared_ptr<const recon::Reconstructor> network;  ///< null for the other algorithms
  std::shared_ptr<const recon::Reconstructor> lit;  ///< bundled network of the lit transitions, for cycles with motion
  std::optional<std::filesystem::path> bundled;     ///< file of the network that was taken because none was named
  std::optional<KnownCodes> codes;                  ///< nothing if nobody tells the patterns, not even the model
  std::optional<capture::SensorProfile> camera;     ///< whose pixels made the events, or nothing
  ToldBy camera_told_by = ToldBy::kNobody;
  std::optional<capture::Orientation> views;    ///< how they come out, as the caller's profile or the events tell
  std::optional<capture::SensorProfile> rival;  ///< that of the network, if the caller names another one

  /// Returns true if light fields may be made of sums over several cycles.
  [[nodiscard]] bool takes_sums() const { return network && model::is_told_the_camera(network->model()); }
  /// Returns true if the network was trained for the patterns of the events, as far as anybody tells them.
  [[nodiscard]] bool are_patterns_the_models() const;

  /// Returns the patterns from which the signs of the events follow, or nothing. Slow pixels still follow the change to
  /// black when the first pattern is lit: in dim light most of their first events are OFF, so that only the signs of
  /// the paper's event model are known.
  [[nodiscard]] std::optional<capture::Codes> codes_of_signs() const;

  /// Completes a tone: a black level that it leaves open is 0 unless physical pixels leave it open, too, and brightness
  /// is not to be measured.
  [[nodiscard]] Tone complete(Tone tone) const;

  /// Returns the method for such a use. Fails with kInvalidValue if it makes one pass or takes one cycle; the location
  /// is "passes" or "cycles".
  [[nodiscard]] Result<recon::Method> ready(const MethodUse& use = {}) const;
};

/// Prepares a method. The sensor profile is the first of these that there is: that of the caller, that of the events,
/// that of the network. Fails with kInvalidValue if the measurement needs a network that is not named, if nothing tells
/// the patterns, or if the network works for one camera alone and the caller names one (location "camera"); with
/// kNotFound if no bundled network was trained for the patterns, or if a model holds none; and as
/// Reconstructor::create() does.
[[nodiscard]] Result<OpenedMethod> open_method(MethodChoice choice);

/// Begins a sequence of light fields. Each is compared with its events if `is_checked` and somebody tells the patterns,
/// unless it is made of several cycles or in colour; the first is judged if the method knows its camera. The tone is
/// completed by OpenedMethod::complete(). Fails as OpenedMethod::ready() does.
[[nodiscard]] Result<FieldSequence> open_sequence(const OpenedMethod& method, const MethodUse& use, Tone tone,
                                                  bool is_checked);

/// A model, and the file that it was read from.
struct BundledNetwork {
  std::filesystem::path path;
  model::Model model;
};

/// Returns the bundled network for events of such patterns: e2lf-n4-camera or e2lf-n4-cycle-camera if the camera has
/// physical pixels, otherwise e2lf-n4, e2lf-n8 or e2lf-n4-cycle; before them e2lf-n4-live if `prefers_fast`. Returns
/// nothing if none was trained for the patterns. Fails as read_model() does.
[[nodiscard]] Result<std::optional<BundledNetwork>> bundled_network(const capture::Codes& codes,
                                                                    const std::optional<capture::SensorProfile>& camera,
                                                                    bool prefers_fast = false);

/// Reads a network: a model file, or the folder of the paper's release.
[[nodiscard]] Result<model::Model> read_network(const std::filesystem::path& path);

}  // namespace e2lf::pipeline
