// SPDX-License-Identifier: MIT
#pragma once

#include <deque>
#include <optional>
#include <torch/types.h>
#include <vector>

#include "e2lf/learn/data/dataset.h"
#include "e2lf/learn/data/draws.h"
#include "e2lf/learn/events/event_simulation.h"
#include "e2lf/learn/run/config.h"

namespace e2lf::learn {

struct Batch {
  torch::Tensor light_field;  ///< float32 [batch, 64, patch, patch], already multiplied by `gain`
  torch::Tensor gain;         ///< float32 [batch]
  SampleConstants constants;
  SensorNoise noise;
  MovingSamples moving;
};

/// The part of every batch on which a process trains: part `rank` of `size` equal ones.
struct Share {
  int rank = 0, size = 1;
};

/// Returns the numbers of the scenes on which a run may train: those that data.validation and data.exclude do not name.
/// Fails with kNotFound if one of these lists names a scene that is not in the data.
[[nodiscard]] Result<std::vector<size_t>> scenes_for_training(const DataConfig& data, const Dataset& dataset);

/// Reads the camera of sensor.camera; nothing if none is set. Fails with kInvalidValue if it cannot be trained with,
/// and as read_camera() does.
[[nodiscard]] Result<std::optional<capture::SensorProfile>> camera_for_training(const Config& config);

/// Training samples. The batch of step k depends only on the configuration and k, so that a resumed run sees the same
/// data.
class Batches {
 public:
  /// Trains on scenes_for_training() that are not smaller than a patch. Fails with kInvalidValue (nothing to train on),
  /// and as scenes_for_training() and camera_for_training() do.
  [[nodiscard]] static Result<Batches> create(const Config& config, Dataset dataset, torch::Device device);

  /// Returns a share of the batch of a step. The batch does not depend on the number of shares. The batch size must be
  /// a multiple of share.size. Steps are best requested in increasing order, because the pool of synthesised light
  /// fields advances with them.
  [[nodiscard]] Batch at(uint64_t step, Share share = {});

  [[nodiscard]] const Dataset& dataset() const { return dataset_; }

  /// Returns the names of the scenes for evaluation: those of data.validation, or two synthesised light fields if there
  /// are none.
  [[nodiscard]] const std::vector<std::string>& validation() const { return config_.data.validation; }

  /// Returns the camera of sensor.camera, or nothing if none is set.
  [[nodiscard]] const std::optional<capture::SensorProfile>& camera() const { return camera_; }

 private:
  Batches(Config config, Dataset dataset, torch::Device device)
      : config_(std::move(config)), dataset_(std::move(dataset)), device_(device) {}
  void synthesise_validation();
  void advance_pool(uint64_t step);
  [[nodiscard]] MovingScene random_crop(const MovingScene& scene, int64_t stride, Draws& draws) const;
  [[nodiscard]] MovingScene random_patch(Draws& draws) const;

  Config config_;
  std::optional<capture::SensorProfile> camera_;
  Dataset dataset_;
  torch::Device device_;
  std::vector<size_t> scenes_;             // indices of the scenes for training
  std::vector<double> cumulative_places_;  // patch positions up to each scene; all are equally likely
  uint64_t pool_end_ = 0;                  // number of light fields synthesised since step 0
  std::deque<MovingScene> pool_;
};

}  // namespace e2lf::learn
