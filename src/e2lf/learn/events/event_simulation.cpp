// SPDX-License-Identifier: MIT
#include "e2lf/learn/events/event_simulation.h"

#include <algorithm>
#include <torch/nn/functional/upsampling.h>

#include "e2lf/base/result.h"
#include "e2lf/learn/data/dataset.h"

namespace e2lf::learn {
namespace {

constexpr double kStartAmplitude = 0.4, kStartRadius = 2.0;
constexpr double kMinThreshold = 0.01;  // as in the released simulator

/// Returns the initial parameters of a pattern, [views]: a smooth function that is positive within kStartRadius cells
/// of the centre and negative outside.
torch::Tensor soft_disc(const torch::Tensor& centre) {
  const auto cells = torch::arange(kViewsPerSide, torch::kFloat);
  const auto distance = (cells - centre[0]).square().unsqueeze(1) + (cells - centre[1]).square().unsqueeze(0);
  return (kStartAmplitude * (1.0 - distance / (kStartRadius * kStartRadius)).clamp_min(-1.0)).reshape({kViews});
}

/// Returns a random point of the aperture that is far from earlier ones: the best of a few candidates.
torch::Tensor distant_point(const std::vector<torch::Tensor>& earlier) {
  torch::Tensor best;
  double best_distance = -1;
  for (int candidate = 0; candidate < 8; ++candidate) {
    const auto point = 1.0 + 5.0 * torch::rand({2});
    double nearest = static_cast<double>(kViews);
    for (const auto& other : earlier) nearest = std::min(nearest, (point - other).norm().item<double>());
    if (nearest > best_distance) best = point;
    best_distance = std::max(best_distance, nearest);
  }
  return best;
}

/// Returns the levels of model::InputKind::kLevel, of which only the counts have a gradient.
torch::Tensor levels(const torch::Tensor& events) {
  std::vector<torch::Tensor> signs;
  for (int64_t k = 0; k < events.size(1); ++k) {
    const auto now = torch::sign(events.select(1, k).detach());
    signs.push_back(k == 0 ? now : torch::where(now == 0, signs.back(), now));
  }
  return events.cumsum(1) + 0.5 * torch::stack(signs, 1);
}

/// Computes the views of a lens-array image by bilinear interpolation between the centres of the lenses.
torch::Tensor lens_views(const torch::Tensor& image) {
  namespace functional = torch::nn::functional;
  const std::vector<int64_t> size = {image.size(2), image.size(3)};
  return functional::interpolate(
      torch::pixel_unshuffle(image, capture::kLensPixels),
      functional::InterpolateFuncOptions().size(size).mode(torch::kBilinear).align_corners(false));
}

}  // namespace

SampleConstants repeat_constants(const capture::SensorConstants& constants, int64_t batch, torch::Device device) {
  const auto repeat = [&](float value) { return torch::full({batch, 1, 1}, value, torch::device(device)); };
  return {repeat(constants.eps), repeat(constants.tau), repeat(constants.sigma_w), repeat(constants.sigma_z)};
}

SampleConstants sample_of(const capture::SensorProfile& camera, size_t num_patterns, size_t num_codes, size_t cycles,
                          torch::Device device) {
  SampleConstants sample = repeat_constants(camera.constants, 1, device);
  const auto row = [&](const std::vector<float>& values) {
    return torch::tensor(at::ArrayRef<float>(values)).unsqueeze(0).to(device);
  };
  if (num_patterns >= 2) sample.conditioning = row(capture::conditioning_vector(camera, num_patterns, cycles));
  if (!camera.is_pixel()) return sample;
  std::vector<float> transmission = {1.0F};
  for (size_t n = 0; n + 1 < num_codes; ++n) {
    transmission.push_back(n < camera.transmission.size() ? camera.transmission[n] : 1.0F);
  }
  sample.pixel = {torch::ones({1}, torch::kBool), row({camera.pixel.values.begin(), camera.pixel.values.end()}),
                  row(transmission), static_cast<int64_t>(cycles)};
  return sample;
}

Patterns::Patterns(size_t num_patterns, PatternTie tie, torch::Device device) : tie_(tie) {
  E2LF_REQUIRE(num_patterns >= (tie == PatternTie::kBlackFirst ? 2 : 1), "there is nothing to learn");
  E2LF_REQUIRE(tie != PatternTie::kComplementary || num_patterns % 2 == 0, "complementary patterns come in pairs");
  size_t num_free = num_patterns;
  if (tie == PatternTie::kBlackFirst) num_free = num_patterns - 1;
  if (tie == PatternTie::kComplementary) num_free = num_patterns / 2;
  if (tie == PatternTie::kWholeCycle) num_free = (num_patterns - 1) / 2 - 1;
  std::vector<torch::Tensor> discs, centres;
  for (size_t i = 0; i < num_free; ++i) {
    centres.push_back(distant_point(centres));
    discs.push_back(soft_disc(centres.back()));
  }
  parameters_ = torch::stack(discs).to(device).set_requires_grad(true);
}

void Patterns::start_at(const torch::Tensor& codes) {
  torch::NoGradGuard no_grad;
  const bool skips_black = tie_ == PatternTie::kBlackFirst || tie_ == PatternTie::kWholeCycle;
  const auto free = codes.slice(0, skips_black ? 1 : 0, codes.size(0), tie_ == PatternTie::kComplementary ? 2 : 1);
  parameters_.slice(0, 0, free.size(0)).copy_((free - 0.5) * (2.0 * kStartAmplitude));
}

void Patterns::start_at_noise(double width) {
  torch::NoGradGuard no_grad;
  parameters_.normal_(0.0, width);
}

torch::Tensor Patterns::tied(const torch::Tensor& free) const {
  switch (tie_) {
    case PatternTie::kBlackFirst:
      return torch::cat({torch::zeros_like(free.slice(0, 0, 1)), free});
    case PatternTie::kComplementary:
      return torch::stack({free, 1.0 - free}, 1).flatten(0, 1);
    case PatternTie::kWholeCycle: {
      const auto black = torch::zeros_like(free.slice(0, 0, 1));
      return torch::cat({black, free, 1.0 - black, 1.0 - free, black});
    }
    case PatternTie::kNone:
      break;
  }
  return free;
}

torch::Tensor Patterns::codes(double scale) const {
  return tied(torch::sigmoid(parameters_ * scale));
}

torch::Tensor Patterns::binary_codes() const {
  return tied((parameters_.detach() > 0).to(torch::kFloat));
}

torch::Tensor coded_intensities(const torch::Tensor& light_field, const torch::Tensor& codes) {
  const auto rays = light_field.permute({0, 2, 3, 1});
  return torch::matmul(rays, codes.t() / static_cast<double>(codes.size(1))).permute({0, 3, 1, 2}).contiguous();
}

CodedLight coded_light(const torch::Tensor& light_field, const torch::Tensor& codes, const MovingSamples& moving) {
  CodedLight light{coded_intensities(light_field, codes), light_field.mean(1)};
  if (!moving.places.defined()) return light;
  std::vector<torch::Tensor> intensities, full;
  for (int64_t n = 0; n < codes.size(0); ++n) {
    const auto shown = moving.light_fields.select(1, n).to(torch::kFloat) * moving.scale.reshape({-1, 1, 1, 1});
    intensities.push_back(coded_intensities(shown, codes.slice(0, n, n + 1)));
    full.push_back(shown.mean(1, true));
  }
  light.intensities = light.intensities.index_copy(0, moving.places, torch::cat(intensities, 1));
  light.full = light.full.unsqueeze(1).expand({-1, codes.size(0), -1, -1});
  light.full = light.full.index_copy(0, moving.places, torch::cat(full, 1));
  return light;
}

SensorNoise draw_noise(capture::MeasurementKind measurement, int64_t batch, int64_t num_patterns, int64_t height,
                       int64_t width, torch::Device device) {
  const auto draw = [&](int64_t planes) { return torch::randn({batch, planes, height, width}, torch::device(device)); };
  SensorNoise noise;
  // Events are drawn first, so that measurements without images have the same noise as before images were added.
  if (capture::has_events(measurement)) {
    noise.w = draw(num_patterns - 1);
    noise.z = draw(num_patterns - 1);
  }
  const auto images = static_cast<int64_t>(capture::num_images(measurement, static_cast<size_t>(num_patterns)));
  if (images > 0) noise.image = draw(images);
  return noise;
}

torch::Tensor measure_images(capture::MeasurementKind kind, const torch::Tensor& light_field,
                             const torch::Tensor& intensities, double sigma, const torch::Tensor& noise) {
  switch (kind) {
    case capture::MeasurementKind::kEventImages:
      break;
    case capture::MeasurementKind::kCodedImages:
      return intensities + sigma * noise;
    case capture::MeasurementKind::kHybrid:
      return intensities.sum(1, true) + sigma * noise;
    case capture::MeasurementKind::kLensArray:
      return torch::pixel_shuffle(torch::avg_pool2d(light_field, capture::kLensPixels), capture::kLensPixels) +
             sigma * noise;
  }
  return {};
}

torch::Tensor simulate_events(const torch::Tensor& intensities, const SampleConstants& constants,
                              const SensorNoise& noise, EventModel event_model) {
  const auto log_intensity = torch::log(intensities + constants.eps.unsqueeze(1));
  const bool reference_aware = event_model == EventModel::kReferenceAware;
  auto reference = log_intensity.select(1, 0);
  if (noise.residue.defined()) reference = reference + constants.tau * noise.residue;
  std::vector<torch::Tensor> events;
  for (int64_t n = 1; n < intensities.size(1); ++n) {
    const auto now = log_intensity.select(1, n);
    const auto threshold = (constants.tau + constants.sigma_z * noise.z.select(1, n - 1)).clamp_min(kMinThreshold);
    const auto steps = (now - reference + constants.sigma_w * noise.w.select(1, n - 1)) / threshold;
    // Straight-through estimator: the value is rounded toward zero, the gradient is that of `steps`.
    events.push_back(steps + (steps.trunc() - steps).detach());
    reference = reference_aware ? reference + constants.tau * events.back() : now;
  }
  return torch::stack(events, 1);
}

torch::Tensor to_tensor(const capture::Codes& codes, torch::Device device) {
  return torch::tensor(at::ArrayRef<float>(codes.values))
      .reshape({static_cast<int64_t>(codes.num_patterns), static_cast<int64_t>(codes.pattern_size())})
      .to(device);
}

capture::Codes to_codes(const torch::Tensor& codes, size_t views_y, size_t views_x) {
  capture::Codes result(static_cast<size_t>(codes.size(0)), views_y, views_x);
  const auto values = codes.detach().to(torch::kCPU, torch::kFloat).contiguous();
  std::copy_n(values.data_ptr<float>(), result.values.size(), result.values.begin());
  return result;
}

torch::Tensor form_inputs(const torch::Tensor& events, const std::vector<model::InputGroup>& groups,
                          const SampleConstants& constants, const torch::Tensor& images) {
  std::vector<torch::Tensor> channels;
  for (const model::InputGroup& group : groups) {
    switch (group.kind) {
      case model::InputKind::kCounts:
        channels.push_back(events * group.scale);
        break;
      case model::InputKind::kCumulative:
        channels.push_back(events.cumsum(1) * group.scale);
        break;
      case model::InputKind::kLevel:
        channels.push_back(levels(events) * group.scale);
        break;
      case model::InputKind::kIntensity: {
        const auto eps = constants.eps.unsqueeze(1), tau = constants.tau.unsqueeze(1);
        // A coded intensity is at most 1: the exponential of a noisy count must not dominate its neighbours. Limiting
        // the exponent instead of the result keeps the gradient finite.
        const auto exponent = torch::minimum(tau * levels(events), torch::log1p(eps.reciprocal()));
        channels.push_back(eps * torch::expm1(exponent) * group.scale);
        break;
      }
      case model::InputKind::kCamera: {
        const auto planes = constants.conditioning.unsqueeze(2).unsqueeze(3) * group.scale;
        channels.push_back(planes.expand({-1, -1, events.size(2), events.size(3)}).to(events.scalar_type()));
        break;
      }
      case model::InputKind::kImages:
      case model::InputKind::kImageSum:
        channels.push_back(images * group.scale);
        break;
      case model::InputKind::kLensArray:
        channels.push_back(lens_views(images) * group.scale);
        break;
      case model::InputKind::kMoved:
        E2LF_REQUIRE(false, "a network of moved pictures is trained with one of disparity");
    }
  }
  return torch::cat(channels, 1);
}

std::vector<InputOrigin> input_origins(const model::Model& start, const std::vector<model::InputGroup>& groups,
                                       size_t num_patterns) {
  std::vector<InputOrigin> origins;
  for (const model::InputGroup& group : groups) {
    size_t first = 0;
    auto source = start.input.begin();
    for (; source != start.input.end() && source->kind != group.kind; ++source) {
      first += model::num_input_channels({*source}, start.num_patterns);
    }
    const bool found = source != start.input.end();
    const size_t known = found ? model::num_input_channels({*source}, start.num_patterns) : 0;
    for (size_t k = 0; k < model::num_input_channels({group}, num_patterns); ++k) {
      origins.push_back(k < known ? InputOrigin{first + k, source->scale / group.scale} : InputOrigin{});
    }
  }
  return origins;
}

// The model of physical pixels.
namespace {

using enum capture::PixelConstant;

/// The state of all pixels between patterns.
struct PixelState {
  torch::Tensor inverse_level;  ///< w = exp(-u) for the log intensity u of the photoreceptor
  torch::Tensor level;          ///< level of the amplifier, a log of (I + eps) / eps
  torch::Tensor reference;
};

/// Advances the state by `seconds` at the intensity J = (I + eps) / eps.
void follow(const torch::Tensor& intensity, const torch::Tensor& seconds, const PixelSamples& samples,
            PixelState& state) {
  const auto target = intensity.reciprocal();
  const auto decay = torch::exp(-samples.at(kReceptorRate) * seconds * intensity);
  state.inverse_level = target + (state.inverse_level - target) * decay;
  const auto log_intensity = -torch::log(state.inverse_level);
  const auto amplifier_decay = torch::exp(-samples.at(kAmplifierRate) * seconds);
  state.level = log_intensity + (state.level - log_intensity) * amplifier_decay;
}

/// Computes the events at the end of one pattern and moves the reference accordingly.
torch::Tensor compare(const torch::Tensor& level, const torch::Tensor& on, const torch::Tensor& off,
                      torch::Tensor& reference) {
  const auto difference = level - reference;
  const auto threshold = torch::where(difference > 0, on, off);
  const auto steps = difference / threshold;
  const auto count = steps + (steps.trunc() - steps).detach();
  reference = reference + threshold * count;
  return count;
}

/// Adds spurious events, which are rarer in brighter pixels, to the counts. The reference moves when the pattern ends.
void add_dark_events(const torch::Tensor& intensity, const torch::Tensor& on, const torch::Tensor& off,
                     const PixelSamples& samples, torch::Tensor& reference, torch::Tensor& counts) {
  const auto draw = torch::rand_like(intensity);
  const auto is_off = (draw * intensity < samples.at(kDarkOff)).to(intensity.scalar_type());
  const auto is_on = ((1.0 - draw) * intensity < samples.at(kDarkOn)).to(intensity.scalar_type());
  reference = reference - is_off * off + is_on * on;
  counts = counts + (is_on - is_off);
}

torch::Tensor random_noise(const torch::Tensor& intensity, const PixelSamples& samples) {
  return torch::sqrt(samples.at(kNoise).square() + samples.at(kShotNoise).square() / intensity) *
         torch::randn_like(intensity);
}

/// Returns the light J = (I + eps) / eps of each pattern, followed by that of the last code's inverse.
std::vector<torch::Tensor> shown_light(const torch::Tensor& intensities, const torch::Tensor& full,
                                       const PixelSamples& samples) {
  const int64_t num_patterns = intensities.size(1), num_codes = samples.transmission.size(1);
  const auto eps = samples.at(kEps), leak = samples.at(kLeak);
  const bool is_whole = num_patterns == 2 * num_codes + 1, is_still = full.dim() == 3;
  const auto full_at = [&](int64_t n) { return is_still ? full : full.select(1, n); };
  std::vector<torch::Tensor> codes, inverses;
  for (int64_t n = 0; n < num_codes; ++n) {
    const auto open = intensities.select(1, n), transmission = samples.transmission.select(1, n).reshape({-1, 1, 1});
    const auto passed = open * transmission;
    codes.push_back((passed + leak * (full_at(n) - open)) / eps + 1.0);
    // If the scene moves, the inverse sees it later than the code.
    const int64_t later = num_codes + n;
    const auto blocked =
        is_still || !is_whole ? passed : transmission * (full_at(later) - intensities.select(1, later));
    inverses.push_back((full_at(is_still || !is_whole ? n : later) - blocked).clamp_min(0.0) / eps + 1.0);
  }
  std::vector<torch::Tensor> shown = codes;
  if (is_whole) {
    shown.insert(shown.end(), inverses.begin(), inverses.end());
    shown.push_back(codes.front());
  }
  shown.push_back(inverses.back());
  return shown;
}

}  // namespace

torch::Tensor simulate_pixel_events(const torch::Tensor& intensities, const torch::Tensor& full,
                                    const PixelSamples& samples) {
  const int64_t num_patterns = intensities.size(1), num_codes = samples.transmission.size(1);
  const std::vector<torch::Tensor> shown = shown_light(intensities, full, samples);
  const auto inverse = shown.back();

  const auto common = 1.0 + samples.at(kMismatch) * torch::randn_like(inverse);
  const auto threshold = [&](capture::PixelConstant mean) {
    const auto own = common + samples.at(kMismatchEach) * torch::randn_like(inverse);
    return samples.at(mean) * own.clamp_min(capture::kLeastThreshold);
  };
  const auto on = threshold(kThresholdOn), off = threshold(kThresholdOff);

  PixelState start{inverse.reciprocal(), torch::log(inverse), {}};
  follow(shown[0], samples.at(kBlackTime), samples, start);
  std::vector<torch::Tensor> sums(static_cast<size_t>(num_patterns - 1));
  for (int64_t cycle = 0; cycle < samples.cycles; ++cycle) {
    PixelState state = start;
    state.reference = state.level + off * samples.at(kResetSpan) * torch::rand_like(inverse) - samples.at(kResetOffset);
    for (int64_t n = 1; n < num_patterns; ++n) {
      const auto& intensity = shown[static_cast<size_t>(n)];
      const bool is_to_black = n == 2 * num_codes;
      const auto noise = is_to_black ? -samples.at(kResetOffset) : random_noise(intensity, samples);
      // The black pattern and its inverse are shown longer than the others.
      const auto seconds = samples.at(n % num_codes == 0 ? kBlackTime : kLitTime);
      follow(intensity, seconds, samples, state);
      auto counts = compare(state.level + noise, on, off, state.reference);
      if (!is_to_black) add_dark_events(intensity, on, off, samples, state.reference, counts);
      auto& sum = sums[static_cast<size_t>(n - 1)];
      sum = sum.defined() ? sum + counts : counts;
    }
  }
  return torch::stack(sums, 1) / static_cast<double>(samples.cycles);
}

}  // namespace e2lf::learn
