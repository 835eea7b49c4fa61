// SPDX-License-Identifier: MIT
#pragma once

#include <set>
#include <string>
#include <vector>

#include "e2lf/files/safetensors.h"
#include "e2lf/model/video/video_model.h"

namespace e2lf::model {

/// Makes layers of the tensors of a published checkpoint, and remembers which were read. Functions that add layers
/// return the last one's name; they fail with kNotFound and kShape, naming the tensor.
class CheckpointImporter {
 public:
  /// `prefix` stands before the keys of all tensors.
  CheckpointImporter(const Safetensors& tensors, std::string file, std::string prefix)
      : tensors_(tensors), file_(std::move(file)), prefix_(std::move(prefix)) {}

  [[nodiscard]] bool has(const std::string& key) const { return tensors_.tensors.contains(prefix_ + key); }

  /// The tensor's shape; fails where it has other than `rank` axes or one of them is empty.
  [[nodiscard]] Result<std::vector<size_t>> shape(const std::string& key, size_t rank);

  /// The tensor's values; fails where they are not `size`.
  [[nodiscard]] Result<std::vector<float>> values(const std::string& key, size_t size);

  /// A convolution "<key>.weight", with a bias and batch normalisation "<norm>" where they are there.
  Result<std::string> conv(Layer layer, const std::string& key, const std::string& norm = "");

  /// A linear layer "<key>.weight" [out, in] of each pixel, with its bias: a 1x1 convolution.
  Result<std::string> linear(Layer layer, const std::string& key);

  /// "<key>.weight" and "<key>.bias" of each channel.
  Result<std::string> layer_norm(const std::string& name, const std::string& key, const std::string& input);

  /// A cell: a GRU by its three gates, or an LSTM by its one tensor of gates.
  Result<std::string> cell(const std::string& name, const std::string& key, const std::string& input);

  /// ReLU(conv2(ReLU(conv1(x))) + x).
  Result<std::string> residual_block(const std::string& name, const std::string& key, const std::string& input);

  /// The last convolution; of several channels, the first.
  Result<std::string> picture(const std::string& input);

  std::string add(Layer layer);

  /// A layer with weights that are made of the checkpoint's.
  std::string add(Layer layer, std::vector<float> weight, std::vector<float> bias);

  /// The tensor whose depth is the number of time bins.
  void set_head(std::string key) { head_ = std::move(key); }
  [[nodiscard]] Result<size_t> bins();

  /// Ends the network. Fails where a tensor was not read.
  Result<void> finish(VideoModel& model);

  /// Where a tensor is, for errors.
  [[nodiscard]] std::string location(const std::string& key) const;

 private:
  Result<const Tensor*> find(const std::string& key);
  Result<std::vector<float>> values_or(const std::string& key, size_t size, float otherwise);
  Result<void> append(const std::string& key, std::vector<float>& to);
  Result<void> fold(const std::string& norm, std::vector<float>& weight, std::vector<float>& bias);

  const Safetensors& tensors_;
  std::string file_, prefix_, head_;
  std::set<std::string> read_;
  Network network_;
  Weights weights_;
};

}  // namespace e2lf::model
