// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <torch/types.h>
#include <vector>

#include "e2lf/learn/data/synthesiser.h"

namespace e2lf::learn {

/// A light field whose disparities are known.
struct KnownScene {
  torch::Tensor views;      ///< uint8 [64, size, size]
  torch::Tensor disparity;  ///< of the four central views (3, 3), (3, 4), (4, 3), (4, 4): float32 [4, size, size]
};

/// Synthesises a light field of a room, or of surfaces of any outline, with textures of which many are weak: walls,
/// floors and things with reliefs, light from one side, and shadows. Of the options, `size` and `max_disparity` apply;
/// otherwise as synthesise(), except that torch's generator is not used, so that threads may synthesise at the same
/// time.
[[nodiscard]] KnownScene synthesise_known(const std::vector<torch::Tensor>& textures, const SynthesiserOptions& options,
                                          uint64_t seed, torch::Device device);

/// The scenes 0, 1, 2, ... of a run. A thread synthesises some of them ahead of their use, because on a CPU this takes
/// longer than training.
class KnownScenes {
 public:
  KnownScenes(std::vector<torch::Tensor> textures, SynthesiserOptions options, uint64_t seed, torch::Device device);
  KnownScenes(const KnownScenes&) = delete;
  KnownScenes& operator=(const KnownScenes&) = delete;
  ~KnownScenes();

  /// Returns scene `number`. Numbers are best requested in increasing order.
  [[nodiscard]] KnownScene at(uint64_t number);

 private:
  void restart(uint64_t first);
  void stop();

  std::vector<torch::Tensor> textures_;
  SynthesiserOptions options_;
  uint64_t seed_;
  torch::Device device_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<KnownScene> ahead_;  ///< scenes from first_ on
  uint64_t first_ = 0;
  bool stopped_ = true;
  std::thread thread_;
};

}  // namespace e2lf::learn
