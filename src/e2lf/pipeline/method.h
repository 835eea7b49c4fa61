// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "e2lf/base/choice.h"
#include "e2lf/diagnose/finding.h"
#include "e2lf/pipeline/field_sequence.h"
#include "e2lf/pipeline/recorded_setup.h"

namespace e2lf::pipeline {

/// How events are converted.
enum class Algorithm {
  kNetwork,    ///< to light fields, by a network
  kDepth,      ///< to disparity maps, by a network
  kInversion,  ///< to light fields, in closed form, which needs only the patterns
};
inline constexpr Choice<Algorithm> kAlgorithms[] = {
    {"network", Algorithm::kNetwork}, {"depth", Algorithm::kDepth}, {"inversion", Algorithm::kInversion}};

/// How a method is applied to each measurement.
struct MethodUse {
  size_t passes = 1;        ///< number of passes of the network; see Reconstructor::reconstruct()
  size_t cycles = 1;        ///< number of cycles of a static scene over which counts are summed
  size_t fused_cycles = 1;  ///< largest number of cycles that CycleInput::fuse() averages
};

/// The choice of a method for some events.
struct MethodChoice {
  Algorithm algorithm = Algorithm::kNetwork;
  /// The network; empty = the bundled one for the patterns and the sensor, as choose_bundled_model() chooses it. If the
  /// sensor is unknown, it is one for physical pixels with their default profile.
  std::optional<model::Model> model = {};
  std::optional<capture::Codes> codes = {};                ///< patterns that the caller specifies
  std::optional<capture::SensorProfile> camera = {};       ///< sensor profile that the caller specifies
  std::optional<capture::SensorConstants> constants = {};  ///< empty = those of the model, or else the paper's
  capture::RecordedSetup events = {};                      ///< the setup that the file of the events states
  capture::MeasurementKind measurement = capture::MeasurementKind::kEventImages;
  size_t transitions = 0;            ///< number of event images of a cycle; 0 = unknown
  std::string precision = "auto";    ///< arithmetic of the network
  std::string device = "cpu";        ///< see engine::EngineOptions
  bool prefers_fast = false;         ///< whether to prefer a bundled network that keeps pace with a live source
  bool prefers_conditioned = false;  ///< whether to prefer a bundled network that is told the number of cycles
  bool lit_where_moving = false;     ///< whether to open a second network, OpenedMethod::lit
  MethodUse use = {};                ///< what the method must be capable of
  /// The schedule by which a recording was divided into cycles, null for files. The patterns of the caller are reduced
  /// to those between which a reader with this schedule forms event images.
  const cycles::Schedule* schedule = nullptr;
};

/// A method that is ready for any number of measurements, and the decisions that led to it, which callers log and
/// record.
struct OpenedMethod {
  Algorithm algorithm = Algorithm::kNetwork;
  MethodUse use = {};                                   ///< as it was chosen
  std::shared_ptr<const recon::Reconstructor> network;  ///< null for the inversion
  std::shared_ptr<const recon::Reconstructor> lit;  ///< bundled network of the lit transitions, for cycles with motion
  std::optional<std::filesystem::path> bundled;     ///< file of the bundled network that was chosen by default
  std::optional<KnownCodes> codes;                  ///< empty if no source, not even the model, states the patterns
  bool are_views_of_unstated_patterns = false;      ///< the model does not state for which patterns it was trained
  std::optional<capture::SensorProfile> camera;     ///< profile of the sensor of the events; empty = unknown
  StatedBy camera_stated_by = StatedBy::kNone;
  std::optional<capture::Orientation> views;  ///< orientation of the views, as the profile or the events state it
  std::optional<capture::SensorProfile> models_camera;  ///< profile of the network, if the caller specifies another
  /// What the file of the events states, and where the method does not match the events: patterns that contradict each
  /// other, are assumed or are not those of the network, pixels that it was not trained for, passes that it cannot
  /// make.
  diagnose::Findings findings = {};
  bool is_confirmed = true;  ///< whether the file of the events states no doubt about its cycles

  /// Returns the profile of the sensor, which is that of the network or of the paper if none is stated.
  [[nodiscard]] capture::SensorProfile sensor() const;
  /// Returns true if the method accepts sums over several cycles, and fused ones.
  [[nodiscard]] bool takes_sums() const { return network && model::is_conditioned_on_camera(network->model()); }
  /// Returns true if the results are disparity maps, and light fields otherwise.
  [[nodiscard]] bool gives_disparities() const { return algorithm == Algorithm::kDepth; }
  /// Returns true if the network was trained for the patterns of the events, as far as these are known.
  [[nodiscard]] bool are_patterns_the_models() const;

  /// Returns the patterns, stated or assumed, or nothing.
  [[nodiscard]] std::optional<capture::Codes> known_patterns() const;
  /// Returns these and the profile by which the events are judged: `camera`, or else that of the network if its pixels
  /// are physical. In the dark, right events of such pixels look like inverted ones of the paper's model.
  [[nodiscard]] capture::RecordedSetup known_setup() const;

  /// Completes a tone. An empty black level is replaced by 0, unless the camera has physical pixels and the gain is
  /// empty, too.
  [[nodiscard]] Tone complete(Tone tone) const;

  /// Returns the method for this use. Fails with kInvalidValue if several passes, cycles or fused cycles are requested
  /// from a method that supports only one; the option is "passes", "cycles_per_field" or "fuse".
  [[nodiscard]] Result<recon::Method> ready(const MethodUse& wanted = {}) const;
};

/// Returns the finding that the patterns of the caller, of the events and of the schedule, the first of which are used,
/// contradict each other. Each may be those of a cycle or those of all its transitions.
[[nodiscard]] std::optional<diagnose::Finding> contradicted_codes(const MethodChoice& choice);

/// Opens a method and judges how it matches the events. The sensor profile is that of the caller, or else that of the
/// events, or else that of the network. Fails with kInvalidValue if the measurement requires a network and none is
/// given, if the patterns are unknown, or if the caller specifies a camera for a network that works for one camera only
/// (option "camera"); with kNotFound if no bundled network was trained for the patterns, or if a model contains none;
/// and as Reconstructor::create() and OpenedMethod::ready() do.
[[nodiscard]] Result<OpenedMethod> open_method(MethodChoice choice);

/// Returns the method of a network.
[[nodiscard]] recon::Method method_of(std::shared_ptr<const recon::Reconstructor> network, const MethodUse& use);

/// Starts a sequence of light fields. The tone is completed by OpenedMethod::complete(). Fails as OpenedMethod::ready()
/// does.
[[nodiscard]] Result<FieldSequence> open_sequence(const OpenedMethod& method, Tone tone);

/// Returns the finding that the gain which was determined from a light field is far from 1, so that its brightness is
/// not that of the scenes for which the method was made.
[[nodiscard]] std::optional<diagnose::Finding> gain_finding(const OpenedMethod& method, float gain);

/// Reads a network: a model file, or the folder of the paper's release.
[[nodiscard]] Result<model::Model> read_network(const std::filesystem::path& path);

}  // namespace e2lf::pipeline
