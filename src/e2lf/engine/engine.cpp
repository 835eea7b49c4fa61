// SPDX-License-Identifier: MIT
#include "e2lf/engine/engine.h"

#include <algorithm>
#include <map>
#include <mutex>

#include "e2lf/base/text.h"
#include "e2lf/engine/conv.h"
#include "e2lf/engine/row_memory.h"
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

Result<std::shared_ptr<const DeviceNetwork>> open_on_device(const model::Network& network,
                                                            const model::Weights& weights,
                                                            const EngineOptions& options) {
  const auto kind = find_kind(options.device);
  if (!kind) return no_such_device(options.device);
  return kind->open(network, weights, options);
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

struct Engine::Impl {
  Plan plan;
  std::shared_ptr<const DeviceNetwork> device = {};  ///< replaces the plan if it is not null
  Precision precision = Precision::kFloat32;
  std::vector<size_t> planes = {};  ///< see with_outputs()
  size_t num_planes = 0;            ///< of the output
};

namespace {

constexpr Choice<Precision> kPrecisions[] = {{"auto", Precision::kAuto},
                                             {"float32", Precision::kFloat32},
                                             {"bfloat16", Precision::kBfloat16},
                                             {"float16", Precision::kFloat16},
                                             {"int16", Precision::kInt16}};

}  // namespace

Result<Precision> precision_from_name(const std::string& name) {
  return choice_of(name, kPrecisions, "precision");
}

const char* precision_name(Precision precision) {
  return word_of(precision, kPrecisions);
}

FrameState::FrameState() : memory_(std::make_unique<FrameMemory>()) {}
FrameState::FrameState(FrameState&&) noexcept = default;
FrameState& FrameState::operator=(FrameState&&) noexcept = default;
FrameState::~FrameState() = default;

Engine::Engine(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Engine::Engine(Engine&&) noexcept = default;
Engine& Engine::operator=(Engine&&) noexcept = default;
Engine::~Engine() = default;

Result<Engine> Engine::create(const model::Network& network, const model::Weights& weights,
                              const EngineOptions& options) {
  if (options.device != "cpu") {
    auto other = std::make_unique<Impl>();
    E2LF_ASSIGN_OR_RETURN(other->device, open_on_device(network, weights, options));
    other->precision = other->device->precision();
    return Engine(std::move(other));
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
  auto impl = std::make_unique<Impl>();
  impl->precision = options.precision;
  if (options.precision == Precision::kAuto) {
    const auto fastest = std::ranges::find_if(options.checked, is_supported);
    impl->precision = fastest != options.checked.end() ? *fastest : Precision::kFloat32;
  }
  const bool narrow = impl->precision == Precision::kBfloat16;
  E2LF_ASSIGN_OR_RETURN(impl->plan, make_plan(network, weights, narrow ? ElementType::kBfloat16 : ElementType::kFloat32,
                                              impl->precision == Precision::kInt16));
  if (const size_t scale = impl->plan.tensors.back().scale; scale != 1) {
    return fail(ErrorCode::kShape, cat("layer \"", network.layers.back().name, "\""), "the output has 1/", scale,
                " of the resolution of the input; end with a layer at full resolution");
  }
  impl->num_planes = impl->plan.tensors.back().channels;
  return Engine(std::move(impl));
}

std::optional<Engine> Engine::with_outputs(std::vector<size_t> channels) const {
  if (impl_->device || !impl_->plan.states.empty() || !impl_->planes.empty()) return std::nullopt;
  std::optional<Plan> plan = engine::with_outputs(impl_->plan, channels);
  if (!plan) return std::nullopt;
  auto some = std::make_unique<Impl>();
  some->plan = *std::move(plan);
  some->precision = impl_->precision;
  some->planes = std::move(channels);
  some->num_planes = impl_->num_planes;
  return Engine(std::move(some));
}

Result<void> Engine::run(std::span<const float> input, size_t height, size_t width, std::span<float> output,
                         const ProgressFn& progress) const {
  FrameState at_rest;
  return run_frame(input, height, width, at_rest, output, progress);
}

Result<void> Engine::run_frame(std::span<const float> input, size_t height, size_t width, FrameState& state,
                               std::span<float> output, const ProgressFn& progress) const {
  if (impl_->device) return impl_->device->run(input, height, width, output);
  const Plan& plan = impl_->plan;
  const size_t multiple = plan.alignment / kTileSize;
  E2LF_REQUIRE(height > 0 && width > 0 && height % multiple == 0 && width % multiple == 0,
               cat("height and width must be multiples of ", multiple));
  E2LF_REQUIRE(input.size() == plan.tensors.front().channels * height * width, "the input has another size");
  E2LF_REQUIRE(output.size() == impl_->num_planes * height * width, "the output has another size");
  // States that are carried from frame to frame are as wide as the image.
  const bool is_cut = plan.states.empty() && !plan.needs_whole_rows;
  const size_t panels = is_cut ? (width + kPanelColumns - 1) / kPanelColumns : 1;
  const size_t columns = round_up((width + panels - 1) / panels, plan.alignment);
  for (size_t begin = 0; begin < width; begin += columns) {
    const size_t end = std::min(width, begin + columns);
    Stream stream(plan, {input, output, height, width, impl_->planes}, begin, end, state.memory_.get());
    bool more = true;
    while (more) {
      more = stream.advance();
      if (progress) progress(begin * height + stream.rows_done() * (end - begin), width * height);
    }
  }
  state.memory_->end_frame();
  return {};
}

Precision Engine::precision() const {
  return impl_->precision;
}

std::vector<std::string> Engine::describe() const {
  if (impl_->device) return impl_->device->describe();
  std::vector<std::string> lines;
  for (const Stage& stage : impl_->plan.stages) lines.push_back(cat(stage.name, ": ", stage.kernel->describe()));
  return lines;
}

}  // namespace e2lf::engine
