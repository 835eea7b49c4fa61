// SPDX-License-Identifier: MIT
#include "e2lf/learn/data/known_scenes.h"

#include <ATen/CPUGeneratorImpl.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <torch/torch.h>

#include "e2lf/learn/data/dataset.h"
#include "e2lf/learn/data/draws.h"

namespace e2lf::learn {
namespace {

constexpr double kMostView = 3.5;       // view steps from the centre of the aperture
constexpr double kSteepest = 0.1;       // slope of a disparity, by which the points of a view are found in few steps
constexpr double kRoomShare = 0.6;      // of the scenes; the others consist of many surfaces of any outline
constexpr double kFarWallShare = 0.5;   // of the rooms: their walls lie behind what the lens is focused on
constexpr double kChequerShare = 0.05;  // of walls and planes
constexpr double kProceduralShare = 0.4;
constexpr size_t kScenesAhead = 8;
/// Fractions of the largest disparity that limit a scene, with equal probability.
constexpr std::array kLimits = {0.15, 0.3, 0.65, 1.0, 1.0};
/// Shares of the rooms with 0, 1, ... planes besides the wall, and things, and of other scenes with 1, 2, ... surfaces.
constexpr std::array kPlaneShares = {0.35, 0.45, 0.2};
constexpr std::array kThingShares = {0.08, 0.27, 0.3, 0.2, 0.15};
constexpr std::array kClutterShares = {0.06, 0.14, 0.2, 0.2, 0.2, 0.1, 0.06, 0.04};

/// Draws the maps and planes of one scene.
class ScenePainter {
 public:
  ScenePainter(const std::vector<torch::Tensor>& photos, const SynthesiserOptions& options, uint64_t seed,
               torch::Device device)
      : photos_(photos),
        options_(options),
        device_(device),
        draws_(seed, 0),
        generator_(at::detail::createCPUGenerator(mix_seed(seed, 0, 1))),
        side_(options.size + 2 * static_cast<int64_t>(std::ceil(kMostView * options.max_disparity))),
        half_(0.5 * static_cast<double>(side_)),
        x_(torch::arange(side_, torch::device(device).dtype(torch::kFloat)) - 0.5 * static_cast<double>(side_ - 1)),
        y_(x_.unsqueeze(1)) {
    place_between(-0.5, options.max_disparity * kLimits[draws_.below(kLimits.size())]);
  }

  /// Returns surfaces from back to front.
  std::vector<Surface> paint() { return draws_.chance(kRoomShare) ? room() : clutter(); }

 private:
  /// Draws the farthest disparity, above a fraction of the limit, and the nearest one.
  void place_between(double least_high, double limit) {
    high_ = draws_.uniform(least_high, 1) * limit;
    low_ = -limit + (high_ + limit) * draws_.uniform();
  }

  template <size_t kNumber>
  size_t draw_number(const std::array<double, kNumber>& shares) {
    double left = draws_.uniform();
    for (size_t n = 0; n + 1 < kNumber; ++n) {
      if (left < shares[n]) return n;
      left -= shares[n];
    }
    return kNumber - 1;
  }

  double log_uniform_or(double chance, double low, double high, double otherwise) {
    const double drawn = draws_.log_uniform(low, high);
    return draws_.chance(chance) ? drawn : otherwise;
  }

  /// Returns smooth noise of unit variance with features of `feature_px`.
  torch::Tensor noise(double feature_px) { return smooth_noise(side_, feature_px, device_, generator_); }

  torch::Tensor texture() {
    const bool is_photo = !photos_.empty() && !draws_.chance(kProceduralShare);
    auto map =
        is_photo ? photo_texture(photos_, side_, draws_) : procedural_texture(side_, draws_, device_, generator_);
    if (draws_.chance(0.45)) {  // weak
      const double contrast = draws_.log_uniform(0.03, 1);
      const auto mean = map.mean();
      map = mean + contrast * (map - mean) + draws_.uniform(-0.2, 0.5) * (1 - contrast);
    }
    if (draws_.chance(0.3)) {
      const auto slow = noise(draws_.log_uniform(60, 250));
      map = map * torch::exp(slow * draws_.log_uniform(0.05, 0.4));
    }
    return map.clamp(0, 1);
  }

  /// Makes most textures weak, and adds shading and grain as of plaster.
  torch::Tensor shaded(torch::Tensor map) {
    const auto mean = map.mean();
    map = mean + log_uniform_or(0.6, 0.04, 0.6, 1) * (map - mean);
    if (draws_.chance(0.7)) {
      const auto shade = noise(draws_.log_uniform(40, 300));
      map = map * torch::exp(shade * draws_.log_uniform(0.05, 0.5));
    }
    if (draws_.chance(0.5)) {
      const auto grain = noise(draws_.log_uniform(1.5, 6));
      map = map * (1 + grain * draws_.log_uniform(0.01, 0.12));
    }
    return map;
  }

  /// Returns large squares of two brightnesses without texture.
  torch::Tensor chequers() {
    const double period = draws_.log_uniform(30, 200), angle = draws_.uniform(-0.4, 0.4);
    torch::Tensor inside;
    for (const auto& [across, down] :
         {std::pair(std::cos(angle), std::sin(angle)), std::pair(-std::sin(angle), std::cos(angle))}) {
      const auto position = (x_ * across + y_ * down) / period + draws_.uniform();
      const auto edge = ((0.25 - (position - position.floor() - 0.5).abs()) * period).clamp(-0.5, 0.5) * 2;
      inside = inside.defined() ? inside * edge : edge;
    }
    const double dark = draws_.log_uniform(0.02, 0.6), other = draws_.uniform(0.05, 1);
    return dark + (other - dark) * (0.5 * inside + 0.5);
  }

  /// Returns a smooth deviation of the disparity from a plane.
  torch::Tensor relief() {
    const auto map = noise(draws_.log_uniform(40, 220));
    const auto slope = torch::maximum(map.diff(1, 0).abs().amax(), map.diff(1, 1).abs().amax());
    return (map * (kSteepest / slope).clamp_max(draws_.log_uniform(0.08, 0.9))).contiguous();
  }

  /// Returns the deviation of a round thing: it is nearer in the middle. `inside` is the distance from its outline, px.
  torch::Tensor bulge(const torch::Tensor& inside) {
    const double round_px = draws_.log_uniform(10, 0.6 * static_cast<double>(side_));
    const auto from_edge = (inside / round_px).clamp(0, 1);
    return -from_edge * (2 - from_edge) * std::min(draws_.log_uniform(0.05, 1.5), 0.45 * kSteepest * round_px);
  }

  /// Returns a slope per px for a share of the surfaces, by which the disparity remains within its limits.
  double slope(double centre, double share) {
    const double room = std::max(0.0, options_.max_disparity - std::abs(centre)) / static_cast<double>(options_.size);
    const double drawn = draws_.uniform(-1, 1) * std::min(room, 0.025);
    return draws_.chance(share) ? drawn : 0;
  }

  Plane plane_at(double centre, double slope_share) {
    const double slope_y = slope(centre, slope_share);
    return {.centre = centre, .slope_y = slope_y, .slope_x = slope(centre, slope_share)};
  }

  static void sort_back_to_front(std::vector<Surface>::iterator begin, std::vector<Surface>::iterator end) {
    std::stable_sort(begin, end, [](const Surface& a, const Surface& b) { return a.plane.centre > b.plane.centre; });
  }

  std::vector<Surface> clutter() {
    std::vector<Surface> surfaces;
    for (size_t left = 1 + draw_number(kClutterShares); left > 0; --left) {
      Surface surface{plane_at(draws_.uniform(low_, high_), 0.6), texture(), {}};
      if (draws_.chance(0.35)) surface.relief = relief();
      surface.coverage = coverage(surface.brightness, draws_, generator_);
      surfaces.push_back(std::move(surface));
    }
    sort_back_to_front(surfaces.begin(), surfaces.end());
    surfaces.front().coverage = torch::Tensor();
    return surfaces;
  }

  /// A plane that meets the wall in a line, and whether it is a floor: the distance from the line times a slope is
  /// added to the disparity of the wall.
  struct Side {
    Surface surface;
    bool is_floor = false;
  };

  Side side_of_room(const Plane& wall) {
    const double upright = 0.5 * std::numbers::pi + draws_.uniform(-0.15, 0.15);
    const double any = draws_.uniform(0, 2 * std::numbers::pi);
    const double angle = draws_.chance(0.65) ? upright : any;
    const double offset = draws_.uniform(-0.7, 0.4) * half_, across = std::cos(angle), down = std::sin(angle);
    const double farthest = half_ * (std::abs(across) + std::abs(down)) + offset;
    const double steepness =
        -draws_.uniform(0.15, 1) * std::clamp((wall.centre + options_.max_disparity) / farthest, 0.0005, 0.022);
    Side side;
    side.surface.plane = {.centre = wall.centre + steepness * offset,
                          .slope_y = wall.slope_y + steepness * down,
                          .slope_x = wall.slope_x + steepness * across};
    side.surface.coverage = (x_ * across + y_ * down + offset + 0.5).clamp(0, 1);
    side.is_floor = down > 0.9;
    return side;
  }

  /// The distance from the outline of a compact thing, positive inside, and y of its lowest point, px.
  struct Outline {
    torch::Tensor inside;
    double lowest = 0;
  };

  Outline outline() {
    const double centre_y = draws_.uniform(-0.8, 0.8) * half_, centre_x = draws_.uniform(-0.8, 0.8) * half_;
    const double radius_y = draws_.log_uniform(20, half_), wide = draws_.log_uniform(20, half_);
    const double radius_x = log_uniform_or(0.12, 2, 8, wide);  // rods
    Outline result{{}, centre_y + radius_y};
    if (!draws_.chance(0.65)) {
      const auto blob = noise(draws_.log_uniform(50, 260)) - draws_.uniform(-0.4, 1);
      const auto slopes = blob.diff(1, 0).abs().mean() + blob.diff(1, 1).abs().mean();
      result.inside = blob / (0.7 * slopes + 1e-6);
      return result;
    }
    const auto y = (y_ - centre_y) / radius_y, x = (x_ - centre_x) / radius_x;
    const auto radius = draws_.chance(0.35) ? torch::maximum(x.abs(), y.abs()) : (x * x + y * y + 1e-6).sqrt();
    result.inside = (1 - radius) * std::min(radius_x, radius_y);
    if (draws_.chance(0.5)) {
      const double smooth_px = draws_.log_uniform(20, 100);
      const auto uneven = noise(log_uniform_or(0.25, 2, 8, smooth_px));
      result.inside = result.inside + draws_.log_uniform(1, 10) * uneven;
    }
    return result;
  }

  Surface thing(const Plane& behind, bool has_floor) {
    const Outline outlined = outline();
    const double anywhere = draws_.uniform(low_, high_);
    const double at_lowest = behind.centre + behind.slope_y * std::clamp(outlined.lowest, -half_, half_);
    const bool stands = draws_.chance(0.6) && has_floor;
    const double before = has_floor ? std::min(anywhere, at_lowest) : anywhere;
    const double centre = std::clamp(stands ? at_lowest : before, -options_.max_disparity, options_.max_disparity);
    Surface surface{plane_at(centre, 0.5), {}, {}};
    surface.plane.slope_y *= 0.3;
    surface.plane.slope_x *= 0.3;
    if (draws_.chance(0.5)) surface.relief = 0.6 * relief();
    if (draws_.chance(0.7)) {
      const auto round = bulge(outlined.inside);
      surface.relief = surface.relief.defined() ? surface.relief + round : round;
    }
    const double edge_px = draws_.chance(0.8) ? 1 : draws_.log_uniform(1.5, 6);
    surface.coverage = (outlined.inside / edge_px + 0.5).clamp(0, 1);
    return surface;
  }

  /// Returns a wall, planes that meet it in a line, most often floors, and things before them, in light from one side.
  std::vector<Surface> room() {
    if (draws_.chance(kFarWallShare)) place_between(0.2, options_.max_disparity);
    std::vector<Surface> surfaces = {{plane_at(high_, 0.4), {}, {}}};
    const Plane wall = surfaces.front().plane;
    Plane behind = wall;
    bool has_floor = false;
    for (size_t left = draw_number(kPlaneShares); left > 0; --left) {
      Side side = side_of_room(wall);
      behind = side.surface.plane;
      has_floor = side.is_floor;
      surfaces.push_back(std::move(side.surface));
    }
    const auto things = static_cast<ptrdiff_t>(surfaces.size());
    for (Surface& surface : surfaces) {
      if (draws_.chance(0.15)) surface.relief = relief();
      surface.brightness = shaded(texture());
      if (draws_.chance(kChequerShare)) surface.brightness = chequers();
    }
    for (size_t left = draw_number(kThingShares); left > 0; --left) {
      surfaces.push_back(thing(behind, has_floor));
      surfaces.back().brightness = shaded(texture());
    }
    light(surfaces, things);
    sort_back_to_front(surfaces.begin() + 1, surfaces.begin() + things);
    sort_back_to_front(surfaces.begin() + things, surfaces.end());
    return surfaces;
  }

  /// Lights all surfaces of a room from one side by a lamp, whose light the things take from the walls and planes.
  void light(std::vector<Surface>& surfaces, ptrdiff_t things) {
    const double angle = draws_.uniform(0, 2 * std::numbers::pi), lamp = log_uniform_or(0.25, 0.08, 1, 1);
    const auto left = light_past({surfaces.begin() + things, surfaces.end()});
    for (size_t i = 0; i < surfaces.size(); ++i) {
      Surface& surface = surfaces[i];
      auto brightness = surface.brightness * (lamp * draws_.log_uniform(0.4, 1));
      if (surface.relief.defined()) {
        const auto slope_y = at::constant_pad_nd(surface.relief.diff(1, 0), {0, 0, 0, 1});
        const auto slope_x = at::constant_pad_nd(surface.relief.diff(1, 1), {0, 1});
        const auto towards = slope_y * std::sin(angle) + slope_x * std::cos(angle);
        brightness = brightness * torch::exp((draws_.log_uniform(1, 12) * towards).clamp(-1.2, 0.5));
      }
      if (static_cast<ptrdiff_t>(i) < things) brightness = brightness * left;
      surface.brightness = brightness.clamp(0, 1).contiguous();
      if (surface.relief.defined()) surface.relief = surface.relief.contiguous();
    }
  }

  /// Returns the share of the light that things leave to what is behind them: soft shadows beside them.
  torch::Tensor light_past(const std::vector<Surface>& things) {
    const double darkness = draws_.uniform(0, 0.85), shift_x = draws_.uniform(-0.2, 0.2),
                 shift_y = draws_.uniform(-0.2, 0.2);
    if (things.empty() || !draws_.chance(0.7)) return torch::ones({1}, torch::device(device_));
    auto shades = torch::zeros_like(things.front().coverage);
    for (const Surface& each : things) shades = shades + each.coverage;
    const int64_t cells = side_ / 8;
    shades = at::adaptive_avg_pool2d(shades.unsqueeze(0).unsqueeze(0), {cells, cells}).clamp(0, 1);
    shades = at::avg_pool2d(shades, 3, 1, 1);
    const auto x = (x_ / half_ + shift_x).expand({side_, side_}), y = (y_ / half_ + shift_y).expand({side_, side_});
    const auto positions = torch::stack({x, y}, -1).unsqueeze(0);
    shades = at::grid_sampler_2d(shades, positions, /*bilinear*/ 0, /*border*/ 1, /*align_corners=*/false)[0][0];
    return 1 - darkness * shades;
  }

  const std::vector<torch::Tensor>& photos_;
  const SynthesiserOptions& options_;
  torch::Device device_;
  Draws draws_;
  at::Generator generator_;
  int64_t side_;
  double half_;
  torch::Tensor x_, y_;        ///< coordinates of the maps from the centre, px: [side], [side, 1]
  double low_ = 0, high_ = 0;  ///< disparities between which the surfaces lie
};

}  // namespace

KnownScene synthesise_known(const std::vector<torch::Tensor>& textures, const SynthesiserOptions& options,
                            uint64_t seed, torch::Device device) {
  torch::NoGradGuard no_grad;
  const std::vector<Surface> surfaces = ScenePainter(textures, options, seed, device).paint();
  const auto views = views_of(surfaces, options.size).mul_(255.0).round_().clamp_(0.0, 255.0).to(torch::kByte);
  std::vector<torch::Tensor> disparities;
  for (const double y : {-0.5, 0.5}) {
    for (const double x : {-0.5, 0.5}) disparities.push_back(disparity_of(surfaces, options.size, {y, x}));
  }
  return {views, torch::stack(disparities)};
}

KnownScenes::KnownScenes(std::vector<torch::Tensor> textures, SynthesiserOptions options, uint64_t seed,
                         torch::Device device)
    : textures_(std::move(textures)), options_(options), seed_(seed), device_(device) {}

KnownScenes::~KnownScenes() {
  stop();
}

void KnownScenes::stop() {
  {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void KnownScenes::restart(uint64_t first) {
  stop();
  ahead_.clear();
  first_ = first;
  stopped_ = false;
  thread_ = std::thread([this, number = first]() mutable {
    for (;; ++number) {
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return stopped_ || ahead_.size() < kScenesAhead; });
        if (stopped_) return;
      }
      KnownScene scene = synthesise_known(textures_, options_, mix_seed(seed_, 0, number), device_);
      {
        const std::scoped_lock lock(mutex_);
        ahead_.push_back(std::move(scene));
      }
      changed_.notify_all();
    }
  });
}

KnownScene KnownScenes::at(uint64_t number) {
  if (stopped_ || number < first_ || number > first_ + kScenesAhead) restart(number);
  std::unique_lock lock(mutex_);
  KnownScene scene;
  do {
    changed_.wait(lock, [this] { return !ahead_.empty(); });
    scene = std::move(ahead_.front());
    ahead_.pop_front();
    changed_.notify_all();
  } while (first_++ < number);
  return scene;
}

}  // namespace e2lf::learn
