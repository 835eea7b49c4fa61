// SPDX-License-Identifier: MIT
#include "e2lf/engine/engine.h"

#include <algorithm>
#include <map>
#include <mutex>

#include "e2lf/base/text.h"
#include "e2lf/engine/stream.h"

namespace e2lf::engine {
namespace {

// Wider images are cut into panels of columns, so that memory does not grow with the width.
constexpr size_t kPanelColumns = 2048;

bool is_supported(Precision precision) {
  return precision == Precision::kBfloat16 ? bfloat16_supported() : precision != Precision::kInt16 || int16_supported();
}

/// The kinds of devices of this process.
struct DeviceKinds {
  std::mutex mutex;
  std::map<std::string, DeviceKind> kinds;
};

DeviceKinds& device_kinds() {
  static DeviceKinds all;
  return all;
}

std::optional<DeviceKind> find_kind(const std::string& name) {
  DeviceKinds& all = device_kinds();
  const std::lock_guard lock(all.mutex);
  const auto found = all.kinds.find(name.substr(0, name.find(':')));
  return found != all.kinds.end() ? std::optional(found->second) : std::nullopt;
}

Error no_such_device(const std::string& name) {
  return fail(ErrorCode::kMissingDependency, "", "there is no device ", name,
              " in this program; use cpu, or a build with torch for cuda");
}

}  // namespace

void add_device_kind(const std::string& kind, DeviceKind devices) {
  DeviceKinds& all = device_kinds();
  const std::lock_guard lock(all.mutex);
  E2LF_REQUIRE(kind != "cpu" && all.kinds.emplace(kind, std::move(devices)).second, "the name of a device is taken");
}

bool is_known_device(const std::string& name) {
  return name == "cpu" || find_kind(name);
}

Result<void> check_device(const std::string& name) {
  if (name == "cpu") return {};
  const auto kind = find_kind(name);
  if (!kind) return no_such_device(name);
  return kind->check(name);
}

Result<Engine> Engine::create(const model::Network& network, const model::Weights& weights,
                              const EngineOptions& options) {
  Engine engine;
  if (options.device != "cpu") {
    const auto kind = find_kind(options.device);
    if (!kind) return no_such_device(options.device);
    E2LF_ASSIGN_OR_RETURN(engine.device_, kind->open(network, weights, options));
    engine.precision_ = engine.device_->precision();
    return engine;
  }
  if (options.precision == Precision::kFloat16) {
    return fail(ErrorCode::kUnsupported, "", "float16 is the precision of other devices; use precision auto");
  }
  if (options.precision == Precision::kBfloat16 && !bfloat16_supported()) {
    return fail(ErrorCode::kUnsupported, "", "this CPU has no bfloat16 instructions; use precision float32");
  }
  if (options.precision == Precision::kInt16 && !int16_supported()) {
    return fail(ErrorCode::kUnsupported, "", "this CPU has no fast products of 16-bit integers; use precision auto");
  }
  engine.precision_ = options.precision;
  if (options.precision == Precision::kAuto) {
    const auto fastest = std::ranges::find_if(options.checked, is_supported);
    engine.precision_ = fastest != options.checked.end() ? *fastest : Precision::kFloat32;
  }
  const bool narrow = engine.precision_ == Precision::kBfloat16;
  E2LF_ASSIGN_OR_RETURN(engine.plan_,
                        make_plan(network, weights, narrow ? ElementType::kBfloat16 : ElementType::kFloat32,
                                  engine.precision_ == Precision::kInt16));
  if (const size_t scale = engine.plan_.tensors.back().scale; scale != 1) {
    return fail(ErrorCode::kShape, cat("layer \"", network.layers.back().name, "\""), "the output has 1/", scale,
                " of the resolution of the input; end with a layer at full resolution");
  }
  engine.num_planes_ = engine.plan_.tensors.back().channels;
  return engine;
}

std::optional<Engine> Engine::with_outputs(std::vector<size_t> channels) const {
  if (device_ || !plan_.states.empty() || !planes_.empty()) return std::nullopt;
  std::optional<Plan> plan = engine::with_outputs(plan_, channels);
  if (!plan) return std::nullopt;
  Engine some = *this;
  some.plan_ = *std::move(plan);
  some.planes_ = std::move(channels);
  return some;
}

Result<void> Engine::run(std::span<const float> input, size_t height, size_t width, std::span<float> output,
                         const ProgressFn& progress) const {
  FrameState at_rest;
  return run_frame(input, height, width, at_rest, output, progress);
}

Result<void> Engine::run_frame(std::span<const float> input, size_t height, size_t width, FrameState& state,
                               std::span<float> output, const ProgressFn& progress) const {
  if (device_) {
    if (progress) progress(0, width * height);
    E2LF_RETURN_IF_ERROR(device_->run(input, height, width, output));
    if (progress) progress(width * height, width * height);
    return {};
  }
  const size_t multiple = plan_.alignment / kTileSize;
  E2LF_REQUIRE(height > 0 && width > 0 && height % multiple == 0 && width % multiple == 0,
               cat("height and width must be multiples of ", multiple));
  E2LF_REQUIRE(input.size() == plan_.tensors.front().channels * height * width, "the input has another size");
  E2LF_REQUIRE(output.size() == num_planes_ * height * width, "the output has another size");
  // States that are carried from frame to frame are as wide as the image.
  const bool is_cut = plan_.states.empty() && !plan_.needs_whole_rows;
  const size_t panels = is_cut ? (width + kPanelColumns - 1) / kPanelColumns : 1;
  const size_t columns = round_up((width + panels - 1) / panels, plan_.alignment);
  for (size_t begin = 0; begin < width; begin += columns) {
    const size_t end = std::min(width, begin + columns);
    Stream stream(plan_, {input, output, height, width, planes_}, begin, end, state);
    bool more = true;
    while (more) {
      if (stop_requested()) {
        return Error{ErrorCode::kCancelled, "the network was not run to the end; run the command again", ""};
      }
      more = stream.advance();
      if (progress) progress(begin * height + stream.rows_done() * (end - begin), width * height);
    }
  }
  state.end_frame();
  return {};
}

std::vector<std::string> Engine::describe() const {
  if (device_) return device_->describe();
  std::vector<std::string> lines;
  for (const Stage& stage : plan_.stages) lines.push_back(cat(stage.name, ": ", stage.kernel->describe()));
  return lines;
}

}  // namespace e2lf::engine
