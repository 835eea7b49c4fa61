// SPDX-License-Identifier: MIT
#include "e2lf/video/import_event_video.h"

#include <algorithm>
#include <cmath>
#include <optional>

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
  return add({.name = name, .op = VideoOp::kLayerNorm, .inputs = {input}}, std::move(weight), std::move(bias));
}

Result<std::string> CheckpointImporter::cell(const std::string& name, const std::string& key,
                                             const std::string& input) {
  const bool is_lstm = has(key + ".Gates.weight");
  E2LF_ASSIGN_OR_RETURN(const Tensor* tensor, find(key + (is_lstm ? ".Gates.weight" : ".out_gate.weight")));
  Layer layer{.name = name, .op = is_lstm ? VideoOp::kConvLstm : VideoOp::kConvGru, .inputs = {input}};
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
  Layer first{.name = name + "a", .inputs = {input}, .relu = true};
  E2LF_ASSIGN_OR_RETURN(const std::string inner, conv(std::move(first), key + ".conv1", key + ".bn1"));
  Layer second{.name = name + "b", .inputs = {inner}, .residual = input, .relu = true};
  return conv(std::move(second), key + ".conv2", key + ".bn2");
}

Result<std::string> CheckpointImporter::picture(const std::string& input) {
  const Layer layer{.name = "picture", .inputs = {input}};
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

namespace {

enum class Family { kFireNet, kFireNetPlus, kUnet, kDynamicUnet, kTransformer };

/// The properties of a network that its tensors do not determine.
struct Conventions {
  const char* name;
  Family family;
  bool normalises_voxels;
  bool ends_in_sigmoid;
  size_t pad_multiple;  ///< 0: as the layers require
  FrameTone tone;
};

// The configurations of EVREAL. That of FireNet lacks the number of encoders, for which EVREAL then uses four.
constexpr Conventions kConventions[] = {{"firenet", Family::kFireNet, true, false, 16, FrameTone::kNone},
                                        {"firenet+", Family::kFireNetPlus, false, false, 1, FrameTone::kNone},
                                        {"e2vid", Family::kUnet, true, true, 0, FrameTone::kRobust},
                                        {"e2vid+", Family::kUnet, false, false, 0, FrameTone::kNone},
                                        {"ssl-e2vid", Family::kUnet, false, false, 0, FrameTone::kExpRobust},
                                        {"hypere2vid", Family::kDynamicUnet, false, false, 0, FrameTone::kNone},
                                        {"et-net", Family::kTransformer, false, true, 0, FrameTone::kNone}};

constexpr const char* kLastConv = "pred.conv2d.weight";

/// Imports head, cell, block, cell, block and output convolution. `keys` name the first five.
Result<void> import_firenet(CheckpointImporter& importer, const std::vector<std::string>& keys) {
  importer.set_head(keys[0] + ".weight");
  Layer head{.name = "head", .inputs = {"input"}, .relu = true};
  E2LF_ASSIGN_OR_RETURN(std::string x, importer.conv(std::move(head), keys[0]));
  E2LF_ASSIGN_OR_RETURN(x, importer.cell("cell1", keys[1], x));
  E2LF_ASSIGN_OR_RETURN(x, importer.residual_block("block1", keys[2], x));
  E2LF_ASSIGN_OR_RETURN(x, importer.cell("cell2", keys[3], x));
  E2LF_ASSIGN_OR_RETURN(x, importer.residual_block("block2", keys[4], x));
  E2LF_ASSIGN_OR_RETURN(x, importer.picture(x));
  return {};
}

/// Imports the recurrent U-Net: encoders that halve the resolution, each with a cell; residual blocks or transformers;
/// and decoders that double it, to which the outputs of the encoders are added. `encoder` and `decoder` are the
/// prefixes of their keys.
Result<void> import_unet(CheckpointImporter& importer, const std::string& encoder, const std::string& decoder) {
  importer.set_head("head.conv2d.weight");
  const auto conv_layer = [](const std::string& name, const std::string& input, size_t stride = 1) {
    return Layer{.name = name, .inputs = {input}, .stride = stride, .relu = true};
  };
  E2LF_ASSIGN_OR_RETURN(std::string x, importer.conv(conv_layer("head", "input"), "head.conv2d", "head.norm_layer"));
  std::vector<std::string> skips = {x};
  for (size_t i = 0; importer.has(cat(encoder, i, ".conv.conv2d.weight")); ++i) {
    const std::string key = cat(encoder, i), conv = key + ".conv";
    E2LF_ASSIGN_OR_RETURN(x,
                          importer.conv(conv_layer(cat("encoder", i), x, 2), conv + ".conv2d", conv + ".norm_layer"));
    E2LF_ASSIGN_OR_RETURN(x, importer.cell(cat("cell", i), key + ".recurrent_block", x));
    skips.push_back(x);
  }
  if (has_transformers(importer)) {
    E2LF_ASSIGN_OR_RETURN(x, import_transformers(importer, {skips.begin() + 1, skips.end()}));
  }
  for (size_t i = 0; importer.has(cat("resblocks.", i, ".conv1.weight")); ++i) {
    E2LF_ASSIGN_OR_RETURN(x, importer.residual_block(cat("block", i), cat("resblocks.", i), x));
  }
  const auto sum = [&](const std::string& name) {
    const std::string skip = skips.back();
    skips.pop_back();
    return importer.add({.name = name, .op = VideoOp::kAdd, .inputs = {x, skip}});
  };
  for (size_t i = 0; skips.size() > 1; ++i) {
    const std::string key = cat(decoder, i);
    if (importer.has(key + ".transposed_conv2d.weight")) {
      return fail(
          ErrorCode::kUnsupported, key,
          "its decoders are transposed convolutions, which are not supported; give a network that resizes first");
    }
    x = sum(cat("join", i));
    x = importer.add({.name = cat("double", i), .op = VideoOp::kUpsampleBilinear, .inputs = {x}, .stride = 2});
    if (is_dynamic_decoder(importer, key)) {
      E2LF_ASSIGN_OR_RETURN(x, import_dynamic_decoder(importer, cat("decoder", i), key, x));
      continue;
    }
    E2LF_ASSIGN_OR_RETURN(x, importer.conv(conv_layer(cat("decoder", i), x), key + ".conv2d", key + ".norm_layer"));
  }
  x = sum("join");
  E2LF_ASSIGN_OR_RETURN(x, importer.picture(x));
  return {};
}

/// Finds the prefix of all names ("net.", "unetrecurrent.") by means of the last layer, which every network has.
std::optional<std::string> find_prefix(const Safetensors& tensors) {
  for (const auto& entry : tensors.tensors) {
    if (entry.first.ends_with(kLastConv))
      return entry.first.substr(0, entry.first.size() - std::string(kLastConv).size());
  }
  return std::nullopt;
}

std::optional<Family> find_family(const CheckpointImporter& importer) {
  if (importer.has("G1.update_gate.weight")) return Family::kFireNetPlus;
  if (importer.has("head.recurrent_block.update_gate.weight")) return Family::kFireNet;
  if (has_transformers(importer)) return Family::kTransformer;
  if (is_dynamic_decoder(importer, "decoders.0")) return Family::kDynamicUnet;
  if (importer.has("encoders.0.conv.conv2d.weight")) return Family::kUnet;
  return std::nullopt;
}

Result<Conventions> find_conventions(const std::string& as, Family family, bool is_normalised) {
  const std::string name = !as.empty()                      ? as
                           : family == Family::kFireNet     ? "firenet"
                           : family == Family::kFireNetPlus ? "firenet+"
                           : family == Family::kDynamicUnet ? "hypere2vid"
                           : family == Family::kTransformer ? "et-net"
                           : is_normalised                  ? "e2vid"
                                                            : "e2vid+";
  const auto found = std::find_if(std::begin(kConventions), std::end(kConventions),
                                  [&](const Conventions& each) { return each.name == name; });
  if (found == std::end(kConventions)) {
    return fail(ErrorCode::kInvalidValue, "as", "unknown network \"", name, "\"; known are ",
                join(event_video_names()));
  }
  if (found->family != family) {
    return fail(ErrorCode::kInvalidValue, "as", "the file has other layers than ", name,
                "; leave the name out to determine it from the layers");
  }
  return *found;
}

}  // namespace

std::vector<std::string> event_video_names() {
  std::vector<std::string> names;
  for (const Conventions& each : kConventions) names.emplace_back(each.name);
  return names;
}

Result<VideoModel> import_event_video(const std::filesystem::path& path, const std::string& as) {
  const std::string file = path.string();
  E2LF_ASSIGN_OR_RETURN(const Safetensors tensors, read_safetensors(path));
  const Error unknown{ErrorCode::kUnsupported,
                      cat("its tensors are not those of ", join(event_video_names()),
                          "; convert the state dictionary of such a checkpoint to .safetensors, names as they are"),
                      file};
  const std::optional<std::string> prefix = find_prefix(tensors);
  if (!prefix) return unknown;
  CheckpointImporter importer(tensors, file, *prefix);
  const std::optional<Family> family = find_family(importer);
  if (!family) return unknown;
  const bool is_normalised = importer.has("encoders.0.conv.norm_layer.running_mean");
  E2LF_ASSIGN_OR_RETURN(const Conventions conventions, find_conventions(as, *family, is_normalised));
  if (*family == Family::kUnet || *family == Family::kDynamicUnet) {
    E2LF_RETURN_IF_ERROR(import_unet(importer, "encoders.", "decoders."));
  } else if (*family == Family::kTransformer) {
    E2LF_RETURN_IF_ERROR(import_unet(importer, "DownsampleConv.", "UpsampleConv."));
  } else if (*family == Family::kFireNet) {
    E2LF_RETURN_IF_ERROR(import_firenet(importer, {"head.conv.conv2d", "head.recurrent_block", "resblocks.0.conv",
                                                   "resblocks.0.recurrent_block", "resblocks.1"}));
  } else {
    E2LF_RETURN_IF_ERROR(import_firenet(importer, {"head.conv2d", "G1", "R1", "G2", "R2"}));
  }
  if (conventions.ends_in_sigmoid) {
    importer.add({.name = "sigmoid", .op = VideoOp::kSigmoid, .inputs = {"picture"}});
  }
  VideoModel model;
  E2LF_RETURN_IF_ERROR(importer.finish(model));
  model.name = conventions.name;
  model.normalises_voxels = conventions.normalises_voxels;
  model.tone = conventions.tone;
  if (const auto shapes = infer_shapes(model.network); !shapes) {
    return Error{shapes.error().code, shapes.error().message, cat(file, ": ", shapes.error().location)};
  }
  model.pad_multiple = conventions.pad_multiple != 0 ? conventions.pad_multiple : size_multiple(model.network);
  model.provenance = {{"source", cat("published weights of ", conventions.name)},
                      {"conventions", "EVREAL protocol"},
                      {"imported_from", path.filename().string()}};
  E2LF_RETURN_IF_ERROR(validate(model, file));
  return model;
}

}  // namespace e2lf::video
