// SPDX-License-Identifier: MIT
#include "e2lf/learn/data/depth_batches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <torch/torch.h>

#include "e2lf/learn/data/draws.h"

namespace e2lf::learn {
namespace {

enum DepthPurpose : uint64_t { kDepthNoise = 11, kDepthScenes = 12, kDepthSamples = 13, kDepthValidation = 21 };
/// Numbers of lit patterns, and their shares of the steps.
constexpr std::array<size_t, 6> kNumbersLit = {2, 3, 4, 5, 6, 7};
constexpr std::array kNumberShares = {0.02, 0.72, 0.04, 0.02, 0.02, 0.18};
constexpr double kWholeCycleShare = 0.15;  // of the steps with three lit patterns
constexpr double kTwoPartsShare = 0.6;     // of the steps with several cycles, whose number differs between two parts
constexpr uint64_t kFirstScenes = 16;      // drawn before the first step

size_t draw_number_lit(Draws& draws) {
  double left = draws.uniform();
  for (size_t i = 0; i + 1 < kNumbersLit.size(); ++i) {
    if (left < kNumberShares[i]) return kNumbersLit[i];
    left -= kNumberShares[i];
  }
  return kNumbersLit.back();
}

/// The numbers of cycles of two parts of the pictures, and 1 at the pixels of the second.
struct CycleParts {
  int64_t first = 1, second = 1;
  torch::Tensor is_second;  ///< [batch, y, x]; undefined if there is one part
};

CycleParts draw_cycles(double share, int64_t batch, int64_t size, Draws& draws) {
  CycleParts parts;
  const bool is_averaged = draws.chance(share), has_two = draws.chance(kTwoPartsShare);
  const int64_t first = int64_t{2} << draws.below(4), second = int64_t{1} << draws.below(2);
  if (!is_averaged) return parts;
  parts.first = parts.second = first;
  if (!has_two) return parts;
  parts.second = second;
  const auto field =
      at::upsample_bicubic2d(torch::randn({batch, 1, 6, 6}), {size, size}, /*align_corners=*/false).squeeze(1);
  parts.is_second = field <= 0.4 * torch::randn({batch, 1, 1});
  return parts;
}

SampleConstants select_samples(const SampleConstants& all, const torch::Tensor& which, int64_t cycles) {
  const auto own = [&](const torch::Tensor& values) { return values.index_select(0, which); };
  SampleConstants result{own(all.eps), own(all.tau), own(all.sigma_w), own(all.sigma_z)};
  if (all.pixel.constants.defined()) {
    result.pixel = {all.pixel.is_pixel.index_select(0, which.cpu()), own(all.pixel.constants),
                    own(all.pixel.transmission), cycles};
  }
  return result;
}

/// The mean counts of the paper's model over cycles, each with noise of its own.
torch::Tensor simulate_paper_cycles(const torch::Tensor& intensities, const SampleConstants& constants,
                                    const torch::Tensor& most_residue, int64_t cycles) {
  const int64_t batch = intensities.size(0), height = intensities.size(2), width = intensities.size(3);
  torch::Tensor sum;
  for (int64_t cycle = 0; cycle < cycles; ++cycle) {
    SensorNoise noise = draw_noise(capture::MeasurementKind::kEventImages, batch, intensities.size(1), height, width,
                                   intensities.device());
    noise.residue = torch::rand({batch, height, width}, intensities.options()) * most_residue.reshape({-1, 1, 1});
    const auto events = simulate_events(intensities, constants, noise, EventModel::kReferenceAware);
    sum = sum.defined() ? sum + events : events;
  }
  return sum / static_cast<double>(cycles);
}

/// The events of each sample by its own event model, averaged over one number of cycles.
torch::Tensor simulate_both(const torch::Tensor& intensities, const torch::Tensor& full,
                            const SampleConstants& constants, const torch::Tensor& most_residue, int64_t cycles) {
  const int64_t batch = intensities.size(0);
  const auto device = intensities.device();
  const auto is_pixel =
      constants.pixel.is_pixel.defined() ? constants.pixel.is_pixel : torch::zeros({batch}, torch::kBool);
  auto events =
      torch::empty({batch, intensities.size(1) - 1, intensities.size(2), intensities.size(3)}, intensities.options());
  for (const bool pixel : {false, true}) {
    const auto which = (is_pixel == pixel).nonzero().flatten().to(device);
    if (which.numel() == 0) continue;
    const auto own = select_samples(constants, which, cycles);
    const auto light = intensities.index_select(0, which);
    events.index_copy_(0, which,
                       pixel ? simulate_pixel_events(light, full.index_select(0, which), own.pixel)
                             : simulate_paper_cycles(light, own, most_residue.index_select(0, which), cycles));
  }
  return events;
}

}  // namespace

std::pair<torch::Tensor, torch::Tensor> transform_scene(const KnownScene& scene, unsigned symmetry) {
  // The view that takes the place of view (4, 4) was on the other side of the middle along each axis that is flipped.
  const auto view = 2 * ((symmetry & 1U) != 0 ? 0 : 1) + ((symmetry & 2U) != 0 ? 0 : 1);
  auto disparity = scene.disparity[view];
  if ((symmetry & 1U) != 0) disparity = disparity.flip({0});
  if ((symmetry & 2U) != 0) disparity = disparity.flip({1});
  if ((symmetry & 4U) != 0) disparity = disparity.t();
  return {transform_views(scene.views, symmetry), disparity};
}

torch::Tensor simulate_cycles(const torch::Tensor& views, const std::vector<capture::Codes>& codes,
                              const SampleConstants& constants, const torch::Tensor& most_residue,
                              const torch::Tensor& cycles) {
  std::vector<torch::Tensor> each;
  for (const capture::Codes& own : codes) each.push_back(to_tensor(own, views.device()));
  const auto patterns = torch::stack(each) / static_cast<double>(kViews);
  const auto intensities =
      torch::bmm(patterns, views.flatten(2)).unflatten(2, {views.size(2), views.size(3)}).contiguous();
  const auto full = views.mean(1);
  const auto least = cycles.min().item<double>(), most = cycles.max().item<double>();
  auto events = simulate_both(intensities, full, constants, most_residue, static_cast<int64_t>(most));
  if (least == most) return events;
  return torch::where((cycles == least).unsqueeze(1),
                      simulate_both(intensities, full, constants, most_residue, static_cast<int64_t>(least)), events);
}

KnownScene scaled_part(const Scene& scene, int64_t size, Draws& draws) {
  const int64_t height = scene.views.size(1), width = scene.views.size(2);
  const auto wanted = static_cast<int64_t>(std::lround(static_cast<double>(size) / draws.log_uniform(0.7, 2.0)));
  const int64_t part = std::min({wanted, height, width});
  const auto below = [&](int64_t bound) { return static_cast<int64_t>(draws.below(static_cast<uint64_t>(bound))); };
  const int64_t y = below(height - part + 1), x = below(width - part + 1);
  const auto cut = [&](const torch::Tensor& maps) {
    return maps.narrow(1, y, part).narrow(2, x, part).to(torch::kFloat).contiguous().unsqueeze(0);
  };
  const auto views = cut(scene.views);
  const auto scaled = part > size ? at::_upsample_bilinear2d_aa(views, {size, size}, /*align_corners=*/false)
                                  : at::upsample_bilinear2d(views, {size, size}, /*align_corners=*/false);
  const double magnification = static_cast<double>(size) / static_cast<double>(part);
  return {scaled[0].round_().clamp_(0.0, 255.0).to(torch::kByte),
          at::upsample_nearest2d(cut(scene.disparity), {size, size})[0] * magnification};
}

DepthBatches::DepthBatches(const Config& config, capture::Codes codes, Dataset dataset, torch::Device device)
    : SampleSource(config, std::move(dataset), device),
      codes_(std::move(codes)),
      synthesised_(std::make_unique<KnownScenes>(dataset_.textures, config.data.synthesiser,
                                                 mix_seed(config.seed, kDepthScenes, 0), device)) {}

Result<DepthBatches> DepthBatches::create(const Config& config, capture::Codes codes, Dataset dataset,
                                          torch::Device device) {
  DepthBatches batches(config, std::move(codes), std::move(dataset), device);
  for (const std::string& name : config.patterns.known) {
    E2LF_ASSIGN_OR_RETURN(auto known, read_pattern_set(name));
    batches.known_.push_back(std::move(known));
  }
  E2LF_ASSIGN_OR_RETURN(const std::vector<size_t> numbers, batches.prepare());
  for (const size_t i : numbers) {
    const torch::Tensor& maps = batches.dataset_.scenes[i].disparity;
    if (maps.defined() && maps.isfinite().flatten(1).any(1).all().item<bool>()) batches.scenes_.push_back(i);
  }
  if (batches.scenes_.empty() && config.data.synthetic_share < 1.0) {
    return fail(ErrorCode::kInvalidValue, config.data.file,
                "no light field with disparities is left to train on; pack some with `e2lf pack --disparity`, or set "
                "data.synthetic_share to 1");
  }
  batches.add_validation([&](uint64_t i) {
    const KnownScene scene = synthesise_known(batches.dataset_.textures, config.data.synthesiser,
                                              mix_seed(config.seed, kDepthValidation, i), device);
    return Scene{"", views_last(scene.views), scene.disparity};
  });
  return batches;
}

KnownScene DepthBatches::random_scene(Draws& draws) const {
  if (draws.chance(config_.data.synthetic_share)) return pool_[draws.below(pool_.size())];
  return scaled_part(dataset_.scenes[scenes_[draws.below(scenes_.size())]], config_.data.synthesiser.size, draws);
}

std::vector<capture::Codes> DepthBatches::draw_codes(Draws& draws) const {
  if (!config_.patterns.drawn) return std::vector(config_.train.batch, codes_);
  const size_t num_lit = draw_number_lit(draws);
  const bool is_whole = draws.chance(kWholeCycleShare) && num_lit == 3 && !config_.reads_moved_pictures();
  std::vector<capture::Codes> drawn;
  for (uint64_t i = 0; i < config_.train.batch; ++i) {
    drawn.push_back(draw_patterns(num_lit, known_, draws));
    if (is_whole) drawn.back() = capture::whole_cycle(drawn.back());
  }
  return drawn;
}

DepthBatch DepthBatches::at(uint64_t step, Share share) {
  torch::NoGradGuard no_grad;
  advance(pool_, kFirstScenes, step, [&](uint64_t number) { return synthesised_->at(number); });
  // All but the noise is drawn for the whole batch, so that a sample does not depend on the number of shares.
  Draws draws(mix_seed(config_.seed, kDepthSamples, step), 0);
  const uint64_t batch = config_.train.batch;
  std::vector<torch::Tensor> views, disparities;
  for (uint64_t i = 0; i < batch; ++i) {
    const KnownScene scene = random_scene(draws);
    auto [light_field, disparity] = transform_scene(scene, draws.below(8));
    views.push_back(light_field.permute({1, 2, 0}));
    disparities.push_back(disparity);
  }
  DepthBatch result;
  result.codes = draw_codes(draws);
  const PatternNumbers numbers = numbers_of(result.codes.front());
  Conditions conditions = draw_conditions(config_.sensor, batch, device_, draws);
  add_conditioning(numbers.all, conditions);
  if (camera_) apply_camera(config_.sensor, *camera_, numbers, 1, draws, conditions);

  torch::manual_seed(mix_seed(config_.seed, kDepthNoise, step));
  const auto size = config_.data.synthesiser.size, all = static_cast<int64_t>(batch);
  const CycleParts parts = draw_cycles(config_.sensor.cycles_share, all, size, draws);
  auto cycles = torch::full({all, size, size}, static_cast<double>(parts.first), torch::kFloat);
  if (parts.is_second.defined()) cycles.masked_fill_(parts.is_second, static_cast<double>(parts.second));

  const int64_t length = all / share.size, first = share.rank * length;
  const auto own = torch::arange(first, first + length, torch::device(device_).dtype(torch::kLong));
  result.codes = {result.codes.begin() + first, result.codes.begin() + first + length};
  result.constants = select_samples(conditions.constants, own, 1);
  result.constants.conditioning = conditions.constants.conditioning.index_select(0, own);
  result.cycles = cycles.narrow(0, first, length).to(device_);
  result.disparity = torch::stack(disparities).narrow(0, first, length).contiguous();
  result.gain = conditions.gain.narrow(0, first, length);
  result.views = torch::stack(std::vector(views.begin() + first, views.begin() + first + length))
                     .to(torch::kFloat)
                     .permute({0, 3, 1, 2});
  result.views.mul_((result.gain / 255.0).reshape({-1, 1, 1, 1}));
  torch::manual_seed(mix_seed(config_.seed, kDepthNoise, step) + static_cast<uint64_t>(share.rank));
  result.events = simulate_cycles(result.views, result.codes, result.constants,
                                  conditions.residue.narrow(0, first, length), result.cycles);
  return result;
}

}  // namespace e2lf::learn
