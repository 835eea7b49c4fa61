// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "e2lf/files/safetensors.h"
#include "e2lf/video/operations.h"
#include "e2lf/video/video_model.h"

namespace e2lf::video {
using model::Layer, model::Network, model::Weights;

/// Converts the tensors of a published checkpoint to layers and records which tensors were read. Functions that add
/// layers return the name of the last one. They fail with kNotFound and kShape, and the location names the tensor.
class CheckpointImporter {
 public:
  /// `prefix` precedes the keys of all tensors.
  CheckpointImporter(const Safetensors& tensors, std::string file, std::string prefix)
      : tensors_(tensors), file_(std::move(file)), prefix_(std::move(prefix)) {
    add_operations();
  }

  [[nodiscard]] bool has(const std::string& key) const { return tensors_.tensors.contains(prefix_ + key); }

  /// Returns the shape of a tensor. Fails if it does not have `rank` axes or if an extent is 0.
  [[nodiscard]] Result<std::vector<size_t>> shape(const std::string& key, size_t rank);

  /// Returns the values of a tensor. Fails if their number is not `size`.
  [[nodiscard]] Result<std::vector<float>> values(const std::string& key, size_t size);

  /// Adds a convolution "<key>.weight", with a bias and the batch normalisation "<norm>" if the checkpoint has them.
  Result<std::string> conv(Layer layer, const std::string& key, const std::string& norm = "");

  /// Adds a linear layer "<key>.weight" [out, in] with its bias, applied to each pixel: a 1x1 convolution.
  Result<std::string> linear(Layer layer, const std::string& key);

  /// Adds a layer normalisation with "<key>.weight" and "<key>.bias" [channels].
  Result<std::string> layer_norm(const std::string& name, const std::string& key, const std::string& input);

  /// Adds a recurrent cell: a GRU if the checkpoint has tensors for its three gates, an LSTM if it has one for all
  /// gates.
  Result<std::string> cell(const std::string& name, const std::string& key, const std::string& input);

  /// Adds a residual block, ReLU(conv2(ReLU(conv1(x))) + x).
  Result<std::string> residual_block(const std::string& name, const std::string& key, const std::string& input);

  /// Adds the last convolution, of which only the first output channel is kept.
  Result<std::string> picture(const std::string& input);

  std::string add(Layer layer);

  /// Adds a layer whose weights were computed from those of the checkpoint.
  std::string add(Layer layer, std::vector<float> weight, std::vector<float> bias);

  /// Names the tensor whose number of input channels is the number of time bins.
  void set_head(std::string key) { head_ = std::move(key); }
  [[nodiscard]] Result<size_t> bins();

  /// Completes the network and moves it to `model`. Fails if a tensor was not read.
  Result<void> finish(VideoModel& model);

  /// Returns the location of a tensor for errors.
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

/// Returns true if the decoder under a key applies filters specific to each pixel, as the first one of HyperE2VID does.
[[nodiscard]] bool is_dynamic_decoder(const CheckpointImporter& importer, const std::string& key);

/// Imports such a decoder, which follows its upsampling. The voxel grid and the previous picture, at a quarter of the
/// resolution, are mapped to coefficients (two 3x3 convolutions with batch normalisation and tanh) that weight fixed
/// bases. The sums are the filters of each pixel. A 1x1 convolution mixes the filtered channels. `input` is at a
/// quarter of the resolution, too. Fails as the importer does, and with kShape if the numbers of bases, coefficients
/// and filters do not fit.
[[nodiscard]] Result<std::string> import_dynamic_decoder(CheckpointImporter& importer, const std::string& name,
                                                         const std::string& key, const std::string& input);

/// Returns true if a checkpoint has the transformers of ET-Net between its encoders and decoders.
[[nodiscard]] bool has_transformers(const CheckpointImporter& importer);

/// Imports these transformers. `cells` are the layers of the encoders, from fine to coarse. The output of each is
/// reduced to the coarsest resolution and gets a position code. Then self-attention (three layers in the published
/// network) and cross-attention to the next coarser encoder (two layers) are applied. The result is the mean of the
/// outputs of both stages. The number of heads, which no tensor determines, is 8. Fails as the importer does, and with
/// kShape and kUnsupported if the tensors belong to another kind of transformer.
[[nodiscard]] Result<std::string> import_transformers(CheckpointImporter& importer,
                                                      const std::vector<std::string>& cells);

/// Returns the names of the published networks whose checkpoints can be read: "firenet" (Scheerlinck et al., WACV
/// 2020), "firenet+", "e2vid+" (Stoffregen et al., ECCV 2020), "e2vid" (Rebecq et al., TPAMI 2021), "ssl-e2vid"
/// (Paredes-Valles and de Croon, CVPR 2021), "hypere2vid" (Ercan et al., TIP 2024) and "et-net" (Weng et al., ICCV
/// 2021).
[[nodiscard]] std::vector<std::string> event_video_names();

/// Imports a published checkpoint as a model. `path` is its state dictionary as a .safetensors file with unchanged
/// tensor names. The layers follow from these names and shapes. Batch normalisation is folded into the preceding
/// convolutions, and if there are several output channels, only the first (the picture) is kept. Properties that no
/// tensor determines (normalisation of the voxels, padding, a final sigmoid, the tone of the frames) follow the EVREAL
/// protocol (Ercan et al., CVPRW 2023) for the network `as`. If it is empty, the network is determined from the tensor
/// names; if two networks share the names, it is "e2vid" if there is batch normalisation and "e2vid+" otherwise. Fails
/// with kUnsupported (unknown tensor names, or transposed convolutions), kNotFound, kShape, kFormat (a tensor that is
/// not used) and kInvalidValue (`as` is unknown or has other layers).
[[nodiscard]] Result<VideoModel> import_event_video(const std::filesystem::path& path, const std::string& as = "");

}  // namespace e2lf::video
