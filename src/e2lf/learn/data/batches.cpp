// SPDX-License-Identifier: MIT
#include "e2lf/learn/data/batches.h"

#include <cmath>

#include "e2lf/base/text.h"
#include "e2lf/files/bundled_files.h"

namespace e2lf::learn {
namespace {

enum SeedPurpose : uint64_t { kSeedOfNoise = 1, kSynthesis = 2, kSamples = 3, kValidation = 4 };
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

/// Draws each constant of the camera from its uncertainty, and sets a transmission for every active pattern.
capture::SensorProfile draw_camera(capture::SensorProfile camera, const SensorConfig& sensor, size_t num_codes,
                                   Draws& draws) {
  const double spread = draws.chance(sensor.camera_nominal_share) ? 0.0 : sensor.camera_spread;
  const auto vary = [&](float value, float uncertainty) {
    return value * static_cast<float>(std::exp(draws.uniform(-1.0, 1.0) * spread * uncertainty));
  };
  for (size_t i = 0; i < camera.pixel.values.size(); ++i) {
    camera.pixel.values[i] = vary(camera.pixel.values[i], camera.uncertainty.values[i]);
  }
  camera.transmission.resize(num_codes - 1, 1.0F);
  for (size_t k = 1; k < camera.transmission.size(); ++k) {
    camera.transmission[k] = vary(camera.transmission[k], camera.transmission_uncertainty);
  }
  using enum capture::PixelConstant;
  camera.constants.eps = camera.pixel[kEps];
  camera.constants.tau = 0.5F * (camera.pixel[kThresholdOn] + camera.pixel[kThresholdOff]);
  return camera;
}

/// Draws a camera that is better than the stated one: each group of its imperfections is unchanged with probability
/// 1/2, and is otherwise reduced, down to none. Rates increase by a factor of up to 1000, which leaves no lag.
capture::SensorProfile draw_wide(capture::SensorProfile camera, Draws& draws) {
  using enum capture::PixelConstant;
  const auto scale = [&](std::initializer_list<capture::PixelConstant> names, double factor) {
    for (const auto name : names) camera.pixel[name] *= static_cast<float>(factor);
  };
  if (draws.chance(0.5)) scale({kReceptorRate, kAmplifierRate}, draws.log_uniform(1.0, 1000.0));
  if (draws.chance(0.5)) scale({kMismatch, kMismatchEach}, draws.uniform(0.0, 1.0));
  if (draws.chance(0.5)) scale({kNoise, kShotNoise, kDarkOff, kDarkOn}, draws.uniform(0.0, 1.0));
  if (draws.chance(0.5)) scale({kLeak}, draws.uniform(0.0, 1.0));
  return camera;
}

/// Draws the transmissions of black and of the active patterns at one position of the image; they deviate from those
/// that the network receives.
std::vector<float> draw_field(const std::vector<float>& stated, double spread, Draws& draws) {
  std::vector<float> passed = {1.0F};
  for (const float share : stated)
    passed.push_back(share * static_cast<float>(std::exp(spread * draws.uniform(-1.0, 1.0))));
  return passed;
}

}  // namespace

Conditions draw_conditions(const SensorConfig& sensor, uint64_t batch, torch::Device device, Draws& draws) {
  std::vector<float> gain, residue, tau, sigma_w, sigma_z;
  for (uint64_t i = 0; i < batch; ++i) {
    const bool nominal = draws.chance(sensor.nominal_share);
    const bool noise_free = draws.chance(sensor.noise_free_share) && !nominal;
    const auto pick = [&](float usual, const std::array<double, 2>& range) {
      const auto drawn = static_cast<float>(draws.uniform(range[0], range[1]));
      return nominal ? usual : drawn;
    };
    const float noise = noise_free ? 0.0F : 1.0F;
    tau.push_back(pick(sensor.nominal.tau, sensor.tau));
    sigma_w.push_back(noise * pick(sensor.nominal.sigma_w, sensor.sigma_w));
    sigma_z.push_back(noise * pick(sensor.nominal.sigma_z, sensor.sigma_z));
    const bool full = draws.chance(sensor.full_gain_share);
    const auto drawn_gain = static_cast<float>(draws.log_uniform(sensor.gain[0], sensor.gain[1]));
    gain.push_back(full ? 1.0F : drawn_gain);
    // Half of the residues are one threshold, as the change to black leaves them, the others a fraction of one.
    const double thresholds = std::min(1.0, draws.uniform(0.0, 2.0));
    residue.push_back(draws.chance(sensor.residue_share) && !nominal ? static_cast<float>(thresholds) : 0.0F);
  }
  const auto on_device = [&](const std::vector<float>& values) {
    return torch::tensor(at::ArrayRef<float>(values)).reshape({-1, 1, 1}).to(device);
  };
  return {on_device(gain).flatten(),
          on_device(residue).flatten(),
          {torch::full({static_cast<int64_t>(gain.size()), 1, 1}, sensor.nominal.eps, torch::device(device)),
           on_device(tau), on_device(sigma_w), on_device(sigma_z)}};
}

void add_conditioning(size_t num_patterns, Conditions& conditions) {
  const auto device = conditions.gain.device();
  if (num_patterns < 2) {
    conditions.constants.conditioning = torch::zeros({conditions.gain.size(0), 0}, torch::device(device));
    return;
  }
  const SampleConstants& constants = conditions.constants;
  const auto value = [](const torch::Tensor& values, int64_t i) { return values.flatten()[i].item<float>(); };
  std::vector<torch::Tensor> rows;
  for (int64_t i = 0; i < conditions.gain.size(0); ++i) {
    const auto conditioning =
        capture::conditioning_vector({.constants = {value(constants.eps, i), value(constants.tau, i),
                                                    value(constants.sigma_w, i), value(constants.sigma_z, i)},
                                      .residue = value(conditions.residue, i)},
                                     num_patterns);
    rows.push_back(torch::tensor(at::ArrayRef<float>(conditioning)));
  }
  conditions.constants.conditioning = torch::stack(rows).to(device);
}

void apply_camera(const SensorConfig& sensor, const capture::SensorProfile& camera, const PatternNumbers& patterns,
                  size_t cycles, Draws& draws, Conditions& conditions) {
  const auto device = conditions.gain.device();
  const auto row = [&](const std::vector<float>& values) { return torch::tensor(at::ArrayRef<float>(values)); };
  std::vector<torch::Tensor> constants, transmissions, is_pixel;
  for (int64_t i = 0; i < conditions.gain.size(0); ++i) {
    capture::SensorProfile drawn = draw_camera(camera, sensor, patterns.codes, draws);
    if (draws.chance(sensor.camera_wide_share)) drawn = draw_wide(std::move(drawn), draws);
    const bool chosen = draws.chance(sensor.camera_share);
    const auto gain = static_cast<float>(draws.log_uniform(sensor.camera_gain[0], sensor.camera_gain[1]));
    is_pixel.push_back(torch::tensor(chosen));
    constants.push_back(row({drawn.pixel.values.begin(), drawn.pixel.values.end()}));
    transmissions.push_back(row(draw_field(drawn.transmission, sensor.camera_field_spread, draws)));
    if (!chosen) continue;
    conditions.gain[i] = gain;
    conditions.constants.eps[i] = drawn.constants.eps;
    conditions.constants.tau[i] = drawn.constants.tau;
    conditions.constants.conditioning[i] = row(capture::conditioning_vector(drawn, patterns.all, cycles)).to(device);
  }
  conditions.constants.pixel = {torch::stack(is_pixel), torch::stack(constants).to(device),
                                torch::stack(transmissions).to(device), static_cast<int64_t>(cycles)};
}

Result<std::vector<size_t>> SampleSource::prepare() {
  const DataConfig& data = config_.data;
  std::vector<const Scene*> left_out;
  using List = std::pair<const char*, const std::vector<std::string>*>;
  for (const auto& [key, names] : {List("data.validation", &data.validation), List("data.exclude", &data.exclude)}) {
    for (const std::string& name : *names) {
      const auto found = dataset_.find(name);
      if (!found) return Error{found.error().code, cat(found.error().message, " Or remove it from this list"), key};
      left_out.push_back(*found);
    }
  }
  std::vector<size_t> numbers;
  for (size_t i = 0; i < dataset_.scenes.size(); ++i) {
    if (std::ranges::find(left_out, &dataset_.scenes[i]) == left_out.end()) numbers.push_back(i);
  }
  if (config_.sensor.camera.empty()) return numbers;
  E2LF_ASSIGN_OR_RETURN(const auto path, find_file_or_bundled(kBundledCameras, config_.sensor.camera));
  E2LF_ASSIGN_OR_RETURN(camera_, capture::read_camera(path));
  if (!camera_->is_pixel() || !config_.patterns.black_first) {
    return fail(ErrorCode::kInvalidValue, config_.sensor.camera,
                "training requires a camera of the event model \"pixel\" and a black first pattern; choose another "
                "camera or set patterns.black_first");
  }
  return numbers;
}

std::vector<std::string> SampleSource::trained_scenes() const {
  std::vector<std::string> names;
  if (config_.data.synthetic_share >= 1.0) return names;
  for (const size_t i : scenes_) names.push_back(dataset_.scenes[i].name);
  return names;
}

void SampleSource::add_validation(const std::function<Scene(uint64_t)>& synthesise) {
  if (!config_.data.validation.empty()) return;
  for (const uint64_t i : {uint64_t{1}, uint64_t{2}}) {
    dataset_.scenes.push_back(synthesise(i));
    dataset_.scenes.back().name = cat("synthesised ", i);
    config_.data.validation.push_back(dataset_.scenes.back().name);
  }
}

Result<Batches> Batches::create(const Config& config, Dataset dataset, torch::Device device) {
  Batches batches(config, std::move(dataset), device);
  E2LF_ASSIGN_OR_RETURN(const std::vector<size_t> numbers, batches.prepare());
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
  // Not used for training, and large enough for an evaluation.
  SynthesiserOptions options = config.data.synthesiser;
  options.size = std::max<int64_t>(options.size, 64);
  batches.add_validation([&](uint64_t i) {
    const uint64_t seed = mix_seed(config.seed, kValidation, i);
    return Scene{"", views_last(synthesise(batches.dataset_.textures, options, seed, device).views)};
  });
  return batches;
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
  const std::vector<double> times = pattern_times(config_.patterns);
  advance(pool_, kFirstPool, step, [&](uint64_t number) {
    return synthesise(dataset_.textures, config_.data.synthesiser, mix_seed(config_.seed, kSynthesis, number), device_,
                      times);
  });
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
  torch::manual_seed(mix_seed(config_.seed, kSeedOfNoise, step));
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
