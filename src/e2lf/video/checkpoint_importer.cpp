// SPDX-License-Identifier: MIT
#include "e2lf/video/checkpoint_importer.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/text.h"

namespace e2lf::video {

std::string CheckpointImporter::location(const std::string& key) const {
  return cat(file_, ": ", prefix_, key);
}

Result<std::vector<size_t>> CheckpointImporter::shape(const std::string& key, size_t rank) {
  E2LF_ASSIGN_OR_RETURN(const Tensor* tensor, find(key));
  if (tensor->shape.size() == rank && tensor->num_elements() > 0) return tensor->shape;
  return fail(ErrorCode::kShape, location(key), "the values have shape ", shape_text(tensor->shape), " instead of ",
              rank, " axes, none of them empty; give the published file");
}

Result<std::vector<float>> CheckpointImporter::values(const std::string& key, size_t size) {
  E2LF_ASSIGN_OR_RETURN(const Tensor* tensor, find(key));
  if (tensor->num_elements() != size) {
    return fail(ErrorCode::kShape, location(key), "there are ", tensor->num_elements(),
                " values, but the layer requires ", size, "; give the published file");
  }
  return tensor->to_float(location(key));
}

Result<std::string> CheckpointImporter::conv(Layer layer, const std::string& key, const std::string& norm) {
  E2LF_ASSIGN_OR_RETURN(const std::vector<size_t> extents, shape(key + ".weight", 4));
  if (extents[2] != extents[3]) {
    return fail(ErrorCode::kShape, location(key + ".weight"), "the weights have shape ", shape_text(extents),
                ", whose kernel is not square; give the published file");
  }
  layer.out_channels = extents[0];
  layer.kernel = extents[2];
  const size_t size = extents[0] * extents[1] * extents[2] * extents[3];
  E2LF_ASSIGN_OR_RETURN(std::vector<float> weight, values(key + ".weight", size));
  E2LF_ASSIGN_OR_RETURN(std::vector<float> bias, values_or(key + ".bias", layer.out_channels, 0.0F));
  if (!norm.empty() && has(norm + ".running_mean")) E2LF_RETURN_IF_ERROR(fold(norm, weight, bias));
  return add(std::move(layer), std::move(weight), std::move(bias));
}

Result<std::string> CheckpointImporter::linear(Layer layer, const std::string& key) {
  E2LF_ASSIGN_OR_RETURN(const std::vector<size_t> extents, shape(key + ".weight", 2));
  layer.out_channels = extents[0];
  E2LF_ASSIGN_OR_RETURN(std::vector<float> weight, values(key + ".weight", extents[0] * extents[1]));
  E2LF_ASSIGN_OR_RETURN(std::vector<float> bias, values(key + ".bias", extents[0]));
  return add(std::move(layer), std::move(weight), std::move(bias));
}

Result<std::string> CheckpointImporter::layer_norm(const std::string& name, const std::string& key,
                                                   const std::string& input) {
  E2LF_ASSIGN_OR_RETURN(const std::vector<size_t> extents, shape(key + ".weight", 1));
  E2LF_ASSIGN_OR_RETURN(std::vector<float> weight, values(key + ".weight", extents[0]));
  E2LF_ASSIGN_OR_RETURN(std::vector<float> bias, values(key + ".bias", extents[0]));
  return add({.name = name, .op = Op::kLayerNorm, .inputs = {input}, .residual = {}}, std::move(weight),
             std::move(bias));
}

Result<std::string> CheckpointImporter::cell(const std::string& name, const std::string& key,
                                             const std::string& input) {
  const bool is_lstm = has(key + ".Gates.weight");
  E2LF_ASSIGN_OR_RETURN(const Tensor* tensor, find(key + (is_lstm ? ".Gates.weight" : ".out_gate.weight")));
  Layer layer{.name = name, .op = is_lstm ? Op::kConvLstm : Op::kConvGru, .inputs = {input}, .residual = {}};
  if (tensor->shape.size() == 4) {
    layer.out_channels = tensor->shape[0] / (is_lstm ? 4 : 1);
    layer.kernel = tensor->shape[2];
  }
  for (const std::string part : {".weight", ".bias"}) {
    if (is_lstm) {
      E2LF_RETURN_IF_ERROR(append(key + ".Gates" + part, weights_[name + ".gates" + part]));
    } else {
      E2LF_RETURN_IF_ERROR(append(key + ".update_gate" + part, weights_[name + ".gates" + part]));
      E2LF_RETURN_IF_ERROR(append(key + ".reset_gate" + part, weights_[name + ".gates" + part]));
      E2LF_RETURN_IF_ERROR(append(key + ".out_gate" + part, weights_[name + ".candidate" + part]));
    }
  }
  return add(std::move(layer));
}

Result<std::string> CheckpointImporter::residual_block(const std::string& name, const std::string& key,
                                                       const std::string& input) {
  Layer first{.name = name + "a", .inputs = {input}, .residual = {}, .relu = true};
  E2LF_ASSIGN_OR_RETURN(const std::string inner, conv(std::move(first), key + ".conv1", key + ".bn1"));
  Layer second{.name = name + "b", .inputs = {inner}, .residual = input, .relu = true};
  return conv(std::move(second), key + ".conv2", key + ".bn2");
}

Result<std::string> CheckpointImporter::picture(const std::string& input) {
  const Layer layer{.name = "picture", .inputs = {input}, .residual = {}};
  E2LF_ASSIGN_OR_RETURN(std::string name, conv(layer, "pred.conv2d", "pred.norm_layer"));
  Layer& added = network_.layers.back();
  std::vector<float>& weight = weights_["picture.weight"];
  weight.resize(weight.size() / added.out_channels);
  weights_["picture.bias"].resize(1);
  added.out_channels = 1;
  return name;
}

std::string CheckpointImporter::add(Layer layer) {
  network_.layers.push_back(std::move(layer));
  return network_.layers.back().name;
}

std::string CheckpointImporter::add(Layer layer, std::vector<float> weight, std::vector<float> bias) {
  weights_[layer.name + ".weight"] = std::move(weight);
  weights_[layer.name + ".bias"] = std::move(bias);
  return add(std::move(layer));
}

Result<size_t> CheckpointImporter::bins() {
  E2LF_ASSIGN_OR_RETURN(const Tensor* head, find(head_));
  return head->shape.size() == 4 ? head->shape[1] : 0;
}

Result<void> CheckpointImporter::finish(VideoModel& model) {
  for (const auto& entry : tensors_.tensors) {
    if (read_.contains(entry.first) || entry.first.ends_with(".num_batches_tracked")) continue;
    return fail(ErrorCode::kFormat, cat(file_, ": ", entry.first),
                "the tensor is of a layer that this network does not have; give the published file");
  }
  E2LF_ASSIGN_OR_RETURN(model.bins, bins());
  network_.input_channels = model.bins;
  model.network = std::move(network_);
  model.weights = std::move(weights_);
  return {};
}

Result<const Tensor*> CheckpointImporter::find(const std::string& key) {
  read_.insert(prefix_ + key);
  return tensors_.find(prefix_ + key, file_);
}

Result<std::vector<float>> CheckpointImporter::values_or(const std::string& key, size_t size, float otherwise) {
  if (!has(key)) return std::vector<float>(size, otherwise);
  return values(key, size);
}

Result<void> CheckpointImporter::append(const std::string& key, std::vector<float>& to) {
  E2LF_ASSIGN_OR_RETURN(const Tensor* tensor, find(key));
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> more, tensor->to_float(location(key)));
  to.insert(to.end(), more.begin(), more.end());
  return {};
}

/// Folds y = (conv - mean) / sqrt(var + eps) * scale + shift into the convolution.
Result<void> CheckpointImporter::fold(const std::string& norm, std::vector<float>& weight, std::vector<float>& bias) {
  constexpr double kEps = 1e-5;  // the value of torch
  const size_t out = bias.size(), taps = weight.size() / out;
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> mean, values(norm + ".running_mean", out));
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> variance, values(norm + ".running_var", out));
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> scale, values_or(norm + ".weight", out, 1.0F));
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> shift, values_or(norm + ".bias", out, 0.0F));
  for (size_t i = 0; i < out; ++i) {
    const double factor = scale[i] / std::sqrt(static_cast<double>(variance[i]) + kEps);
    for (size_t tap = 0; tap < taps; ++tap) {
      weight[i * taps + tap] = static_cast<float>(factor * weight[i * taps + tap]);
    }
    bias[i] = static_cast<float>(factor * (static_cast<double>(bias[i]) - mean[i]) + shift[i]);
  }
  return {};
}

}  // namespace e2lf::video
