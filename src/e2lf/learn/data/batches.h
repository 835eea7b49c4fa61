// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <optional>
#include <torch/types.h>
#include <vector>

#include "e2lf/capture/patterns/codes.h"
#include "e2lf/learn/data/dataset.h"
#include "e2lf/learn/data/draws.h"
#include "e2lf/learn/data/synthesiser.h"
#include "e2lf/learn/events/event_simulation.h"
#include "e2lf/learn/run/config.h"

namespace e2lf::learn {

/// The light and the sensor of each sample of a batch.
struct Conditions {
  torch::Tensor gain;     ///< brightness of the scenes, float32 [batch]
  torch::Tensor residue;  ///< the upper limit of the residual reference offset, in thresholds, float32 [batch]
  SampleConstants constants;
};

/// The numbers of patterns that are shown, and of codes among them, which differ for a whole cycle.
struct PatternNumbers {
  size_t all = 0, codes = 0;
};

/// Returns those of a sequence of patterns.
[[nodiscard]] inline PatternNumbers numbers_of(const capture::Codes& codes) {
  const auto lit = capture::codes_of_whole_cycle(codes);
  return {codes.num_patterns, lit ? lit->num_patterns : codes.num_patterns};
}

/// Draws the conditions of the paper's models from the ranges of a configuration.
[[nodiscard]] Conditions draw_conditions(const SensorConfig& sensor, uint64_t batch, torch::Device device,
                                         Draws& draws);

/// Sets the conditioning vectors of the paper's models; apply_camera() replaces those of physical pixels. A single
/// pattern has no events and no conditioning.
void add_conditioning(size_t num_patterns, Conditions& conditions);

/// Replaces a share of the samples by samples of the camera, whose constants are drawn from their uncertainties.
void apply_camera(const SensorConfig& sensor, const capture::SensorProfile& camera, const PatternNumbers& patterns,
                  size_t cycles, Draws& draws, Conditions& conditions);

/// The part of every batch on which a process trains: part `rank` of `size` equal ones.
struct Share {
  int rank = 0, size = 1;
};

/// What the samples of a run are drawn from.
class SampleSource {
 public:
  [[nodiscard]] const Dataset& dataset() const { return dataset_; }

  /// Returns the names of the scenes for evaluation: those of data.validation, or two synthesised light fields if there
  /// are none.
  [[nodiscard]] const std::vector<std::string>& validation() const { return config_.data.validation; }

  /// Returns the names of the scenes of the data whose parts are samples.
  [[nodiscard]] std::vector<std::string> trained_scenes() const;

  /// Returns the camera of sensor.camera, or nothing if none is set.
  [[nodiscard]] const std::optional<capture::SensorProfile>& camera() const { return camera_; }

 protected:
  SampleSource(Config config, Dataset dataset, torch::Device device)
      : config_(std::move(config)), dataset_(std::move(dataset)), device_(device) {}

  /// Reads the camera, and returns the numbers of the scenes on which a run may train: those that data.validation and
  /// data.exclude do not name. Fails with kNotFound if one of these lists names a scene that is not in the data, with
  /// kInvalidValue if the camera cannot be trained with, and as read_camera() does.
  [[nodiscard]] Result<std::vector<size_t>> prepare();

  /// If data.validation is empty, adds the scenes that `synthesise` makes for the numbers 1 and 2.
  void add_validation(const std::function<Scene(uint64_t)>& synthesise);

  /// Advances a pool of synthesised scenes, of which `first` are there before the first step, to a step. `synthesise`
  /// makes the scene of a number.
  template <typename PoolScene, typename SynthesiseFn>
  void advance(std::deque<PoolScene>& pool, uint64_t first, uint64_t step, const SynthesiseFn& synthesise) {
    if (config_.data.synthetic_share <= 0.0) return;
    const auto end = first + static_cast<uint64_t>(static_cast<double>(step) * config_.data.pool_per_step);
    pool_end_ = std::max(pool_end_, end - std::min(end, config_.data.pool));
    for (; pool_end_ < end; ++pool_end_) {
      pool.push_back(synthesise(pool_end_));
      pool.back().views = views_last(pool.back().views);
      if (pool.size() > config_.data.pool) pool.pop_front();
    }
  }

  Config config_;
  std::optional<capture::SensorProfile> camera_;
  Dataset dataset_;
  std::vector<size_t> scenes_;  ///< numbers of those whose parts are samples
  torch::Device device_;

 private:
  uint64_t pool_end_ = 0;  // number of scenes synthesised since step 0
};

struct Batch {
  torch::Tensor light_field;  ///< float32 [batch, 64, patch, patch], already multiplied by `gain`
  torch::Tensor gain;         ///< float32 [batch]
  SampleConstants constants;
  SensorNoise noise;
  MovingSamples moving;
};

/// Training samples. The batch of step k depends only on the configuration and k, so that a resumed run sees the same
/// data.
class Batches : public SampleSource {
 public:
  /// Trains on scenes that are not smaller than a patch. Fails with kInvalidValue (nothing to train on), and as
  /// SampleSource::prepare() does.
  [[nodiscard]] static Result<Batches> create(const Config& config, Dataset dataset, torch::Device device);

  /// Returns a share of the batch of a step. The batch does not depend on the number of shares. The batch size must be
  /// a multiple of share.size. Steps are best requested in increasing order, because the pool of synthesised light
  /// fields advances with them.
  [[nodiscard]] Batch at(uint64_t step, Share share = {});

 private:
  using SampleSource::SampleSource;
  [[nodiscard]] MovingScene random_crop(const MovingScene& scene, int64_t stride, Draws& draws) const;
  [[nodiscard]] MovingScene random_patch(Draws& draws) const;

  std::vector<double> cumulative_places_;  // patch positions up to each scene; all are equally likely
  std::deque<MovingScene> pool_;
};

}  // namespace e2lf::learn
