// SPDX-License-Identifier: MIT
#include "e2lf/learn/data/batches.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/learn/data/conditions.h"

namespace e2lf::learn {
namespace {

enum SeedPurpose : uint64_t { kNoise = 1, kSynthesis = 2, kSamples = 3, kValidation = 4 };
constexpr uint64_t kFirstPool = 32;  // light fields synthesised before the first step

int64_t scene_stride(const DataConfig& data) {
  return static_cast<int64_t>(std::max<uint64_t>(1, data.patch_stride));
}

/// Returns the number of patch positions along `length` px.
uint64_t num_places(int64_t length, int64_t patch, int64_t stride) {
  return static_cast<uint64_t>((length - patch) / stride + 1);
}

/// Returns the time at which each pattern is shown, in cycles of the display before the last one. A cycle also shows
/// the inverses of the codes.
std::vector<double> pattern_times(const PatternConfig& patterns) {
  std::vector<double> times;
  for (uint64_t n = 0; n < patterns.num_patterns; ++n) {
    const auto before_last = static_cast<double>(patterns.num_patterns - 1 - n);
    times.push_back(-before_last / static_cast<double>(2 * patterns.num_codes()));
  }
  return times;
}

/// Collects the samples whose light fields at the time of each pattern are defined.
MovingSamples moving_samples(const std::vector<torch::Tensor>& at_times, const torch::Tensor& gain) {
  std::vector<int64_t> places;
  std::vector<torch::Tensor> moving;
  for (size_t i = 0; i < at_times.size(); ++i) {
    if (!at_times[i].defined()) continue;
    places.push_back(static_cast<int64_t>(i));
    moving.push_back(at_times[i]);
  }
  if (moving.empty()) return {};
  const auto which = torch::tensor(at::ArrayRef<int64_t>(places)).to(gain.device());
  return {which, torch::stack(moving), gain.index_select(0, which) / 255.0};
}

}  // namespace

Result<std::vector<size_t>> scenes_for_training(const DataConfig& data, const Dataset& dataset) {
  using List = std::pair<const char*, const std::vector<std::string>*>;
  for (const auto& [key, names] : {List("data.validation", &data.validation), List("data.exclude", &data.exclude)}) {
    for (const std::string& name : *names) {
      const auto found = dataset.find(name);
      if (!found) return Error{found.error().code, cat(found.error().message, " Or remove it from this list"), key};
    }
  }
  std::vector<size_t> numbers;
  for (size_t i = 0; i < dataset.scenes.size(); ++i) {
    const auto names_it = [&](const auto& names) {
      return std::ranges::find(names, dataset.scenes[i].name) != names.end();
    };
    if (!names_it(data.validation) && !names_it(data.exclude)) numbers.push_back(i);
  }
  return numbers;
}

Result<std::optional<capture::SensorProfile>> camera_for_training(const Config& config) {
  std::optional<capture::SensorProfile> camera;
  if (config.sensor.camera.empty()) return camera;
  E2LF_ASSIGN_OR_RETURN(const auto path, find_file_or_bundled(kBundledCameras, config.sensor.camera));
  E2LF_ASSIGN_OR_RETURN(camera, capture::read_camera(path));
  if (!camera->is_pixel() || !config.patterns.black_first) {
    return fail(ErrorCode::kInvalidValue, config.sensor.camera,
                "training requires a camera of the event model \"pixel\" and a black first pattern; choose another "
                "camera or set patterns.black_first");
  }
  return camera;
}

Result<Batches> Batches::create(const Config& config, Dataset dataset, torch::Device device) {
  Batches batches(config, std::move(dataset), device);
  E2LF_ASSIGN_OR_RETURN(const std::vector<size_t> numbers, scenes_for_training(config.data, batches.dataset_));
  E2LF_ASSIGN_OR_RETURN(batches.camera_, camera_for_training(config));
  const auto patch = static_cast<int64_t>(config.train.patch);
  const int64_t stride = scene_stride(config.data);
  double places = 0;
  for (const size_t i : numbers) {
    const Scene& scene = batches.dataset_.scenes[i];
    if (scene.views.size(1) < patch || scene.views.size(2) < patch) continue;
    batches.scenes_.push_back(i);
    places += static_cast<double>(num_places(scene.views.size(1), patch, stride) *
                                  num_places(scene.views.size(2), patch, stride));
    batches.cumulative_places_.push_back(places);
  }
  if (batches.scenes_.empty() && config.data.synthetic_share < 1.0) {
    return fail(ErrorCode::kInvalidValue, config.data.file,
                "no light field of the data is left to train on; add some or set data.synthetic_share to 1");
  }
  if (config.data.validation.empty()) batches.synthesise_validation();
  return batches;
}

/// Synthesises light fields that are not used for training and are large enough for an evaluation.
void Batches::synthesise_validation() {
  constexpr uint64_t kScenes = 2;
  SynthesiserOptions options = config_.data.synthesiser;
  options.size = std::max<int64_t>(options.size, 64);
  for (uint64_t i = 1; i <= kScenes; ++i) {
    const auto scene = synthesise(dataset_.textures, options, mix_seed(config_.seed, kValidation, i), device_);
    dataset_.scenes.push_back({cat("synthesised ", i), views_last(scene.views)});
    config_.data.validation.push_back(dataset_.scenes.back().name);
  }
}

void Batches::advance_pool(uint64_t step) {
  if (config_.data.synthetic_share <= 0.0) return;
  const auto end = kFirstPool + static_cast<uint64_t>(static_cast<double>(step) * config_.data.pool_per_step);
  pool_end_ = std::max(pool_end_, end - std::min(end, config_.data.pool));
  const std::vector<double> times = pattern_times(config_.patterns);
  for (; pool_end_ < end; ++pool_end_) {
    pool_.push_back(synthesise(dataset_.textures, config_.data.synthesiser,
                               mix_seed(config_.seed, kSynthesis, pool_end_), device_, times));
    pool_.back().views = views_last(pool_.back().views);
    if (pool_.size() > config_.data.pool) pool_.pop_front();
  }
}

MovingScene Batches::random_crop(const MovingScene& scene, int64_t stride, Draws& draws) const {
  const auto patch = static_cast<int64_t>(config_.train.patch);
  const auto random_offset = [&](int64_t length) {
    return stride * static_cast<int64_t>(draws.below(num_places(length, patch, stride)));
  };
  const auto y = random_offset(scene.views.size(1)), x = random_offset(scene.views.size(2));
  const auto cut = [&](const torch::Tensor& views) {
    return views.defined() ? views.slice(-2, y, y + patch).slice(-1, x, x + patch) : views;
  };
  return {cut(scene.views), cut(scene.at_times)};
}

MovingScene Batches::random_patch(Draws& draws) const {
  MovingScene crop;
  if (draws.chance(config_.data.synthetic_share)) {
    crop = random_crop(pool_[draws.below(pool_.size())], 1, draws);
  } else {
    const double pick = draws.uniform(0.0, cumulative_places_.back());
    const auto found = std::upper_bound(cumulative_places_.begin(), cumulative_places_.end() - 1, pick);
    const Scene& scene = dataset_.scenes[scenes_[static_cast<size_t>(found - cumulative_places_.begin())]];
    crop = random_crop({scene.views, {}}, scene_stride(config_.data), draws);
  }
  const unsigned symmetry = draws.below(8);
  std::vector<torch::Tensor> at_times;
  if (crop.at_times.defined()) {
    for (const auto& views : crop.at_times.unbind()) at_times.push_back(transform_views(views, symmetry));
  }
  return {transform_views(crop.views, symmetry), at_times.empty() ? torch::Tensor() : torch::stack(at_times)};
}

Batch Batches::at(uint64_t step, Share share) {
  torch::NoGradGuard no_grad;
  advance_pool(step);
  // Everything is drawn for the whole batch, so that a sample does not depend on the number of shares.
  Draws draws(mix_seed(config_.seed, kSamples, step), 0);
  std::vector<torch::Tensor> patches, moving;
  for (uint64_t i = 0; i < config_.train.batch; ++i) {
    const MovingScene patch = random_patch(draws);
    patches.push_back(patch.views);
    moving.push_back(patch.at_times);
  }
  Conditions conditions = draw_conditions(config_.sensor, config_.train.batch, device_, draws);
  add_conditioning(config_.patterns.num_patterns, conditions);
  if (camera_) {
    // A stream of its own, so that runs without a camera are not affected.
    Draws of_camera(mix_seed(config_.seed, kSamples, step), 1);
    const size_t cycles = of_camera.chance(config_.sensor.cycles_share) ? size_t{2} << of_camera.below(4) : 1;
    apply_camera(config_.sensor, *camera_, {config_.patterns.num_patterns, config_.patterns.num_codes()}, cycles,
                 of_camera, conditions);
  }
  const auto& [gain, most_residue, constants] = conditions;
  torch::manual_seed(mix_seed(config_.seed, kNoise, step));
  const auto size = static_cast<int64_t>(config_.train.batch), patch = static_cast<int64_t>(config_.train.patch);
  const auto kind = model::measurement_of(config_.input).value();
  const auto num_patterns = static_cast<int64_t>(config_.patterns.num_patterns);
  const auto noise = draw_noise(kind, size, num_patterns, patch, patch, device_);
  const auto residue = torch::rand({size, patch, patch}, torch::device(device_)) * most_residue.reshape({-1, 1, 1});

  const int64_t length = size / share.size, first = share.rank * length;
  const auto own = [&](const torch::Tensor& values) { return values.narrow(0, first, length); };
  Batch batch;
  batch.gain = own(gain);
  batch.constants = {own(constants.eps), own(constants.tau), own(constants.sigma_w), own(constants.sigma_z)};
  batch.constants.conditioning = own(constants.conditioning);
  if (camera_) {
    const PixelSamples& pixel = constants.pixel;
    batch.constants.pixel = {own(pixel.is_pixel), own(pixel.constants), own(pixel.transmission), pixel.cycles};
  }
  if (noise.w.defined()) batch.noise = {own(noise.w), own(noise.z), own(residue)};
  if (noise.image.defined()) batch.noise.image = own(noise.image);
  // Stacked with the views last in memory, the layout in which they and the output of the network are used.
  for (auto& field : patches) field = field.permute({1, 2, 0});
  batch.light_field = torch::stack(std::vector(patches.begin() + first, patches.begin() + first + length))
                          .to(torch::kFloat)
                          .permute({0, 3, 1, 2})
                          .mul_((batch.gain / 255.0).reshape({-1, 1, 1, 1}));
  batch.moving = moving_samples({moving.begin() + first, moving.begin() + first + length}, batch.gain);
  return batch;
}

}  // namespace e2lf::learn
