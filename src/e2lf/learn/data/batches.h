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
  torch::Tensor light_field;  ///< float32 [batch, 64, patch, patch], already darkened by `gain`
  torch::Tensor gain;         ///< float32 [batch]
  SampleConstants constants;
  SensorNoise noise;
};

/// Which samples of every batch a process trains on: share `rank` of `size` equal ones.
struct Share {
  int rank = 0, size = 1;
};

/// Training samples. What step k gets depends only on the configuration and k, so a resumed run sees the same data.
class Batches {
 public:
  /// Trains on every scene of the data that is neither validation nor excluded. Fails with kInvalidValue when there is
  /// nothing to train on, kNotFound when a named scene is not in the data, and as read_camera().
  [[nodiscard]] static Result<Batches> create(const Config& config, Dataset dataset, torch::Device device);

  /// A share of the batch of a step; the shares make up the batch whatever their number. The batch size must be a
  /// multiple of share.size. Steps in increasing order are fast: the pool of synthesised light fields moves along.
  [[nodiscard]] Batch at(uint64_t step, Share share = {});

  [[nodiscard]] const Dataset& dataset() const { return dataset_; }

  /// The scenes to evaluate: those of data.validation, or without any two light fields of the synthesiser.
  [[nodiscard]] const std::vector<std::string>& validation() const { return config_.data.validation; }

  /// The camera of sensor.camera; nothing where none is named.
  [[nodiscard]] const std::optional<capture::SensorProfile>& camera() const { return camera_; }

 private:
  Batches(Config config, Dataset dataset, torch::Device device)
      : config_(std::move(config)), dataset_(std::move(dataset)), device_(device) {}
  void synthesise_validation();
  void advance_pool(uint64_t step);
  [[nodiscard]] torch::Tensor random_crop(const torch::Tensor& views, int64_t stride, Draws& draws) const;
  [[nodiscard]] torch::Tensor random_patch(Draws& draws) const;

  struct Conditions {
    torch::Tensor gain, residue;  // [batch]; the latter in thresholds, at most
    SampleConstants constants;
  };
  [[nodiscard]] Conditions random_conditions(Draws& draws) const;
  void tell_traits(Conditions& conditions) const;
  void apply_camera(uint64_t step, Conditions& conditions) const;

  Config config_;
  std::optional<capture::SensorProfile> camera_;
  Dataset dataset_;
  torch::Device device_;
  std::vector<size_t> scenes_;             // indices of those to train on
  std::vector<double> cumulative_places_;  // of patches in the scenes: all are equally likely
  uint64_t pool_end_ = 0;                  // number of light fields synthesised since step 0
  std::deque<torch::Tensor> pool_;
};

}  // namespace e2lf::learn
