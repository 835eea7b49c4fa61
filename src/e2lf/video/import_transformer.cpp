// SPDX-License-Identifier: MIT
#include <cmath>

#include "e2lf/base/text.h"
#include "e2lf/model/model_parts.h"
#include "e2lf/video/checkpoint_importer.h"

namespace e2lf::video {
namespace {

constexpr size_t kHeads = 8;

std::string encoder_key(size_t scale, size_t layer) {
  return cat("trans_encoder", scale, ".encoder.layers.", layer);
}

std::string decoder_key(size_t scale, size_t layer) {
  return cat("trans_decoder", scale, ".decoder.layers.", layer);
}

bool has_layer(const CheckpointImporter& importer, const std::string& key) {
  return importer.has(key + ".linear1.weight");
}

/// Adds attention with its linear layers and a skip connection from `sum`. "<key>.in_proj_*" hold the weights of
/// queries, keys and values.
Result<std::string> add_attention(CheckpointImporter& importer, const std::string& name, const std::string& key,
                                  const std::string& queries, const std::string& memory, const std::string& sum) {
  const std::string weight_key = key + ".in_proj_weight";
  E2LF_ASSIGN_OR_RETURN(const std::vector<size_t> shape, importer.shape(weight_key, 2));
  const size_t channels = shape[1];
  if (shape[0] != 3 * channels || channels % kHeads != 0) {
    return Error{ErrorCode::kShape,
                 cat("weights of shape ", shape_text(shape), ", not of queries, keys and values with ", kHeads,
                     " heads; give the published file"),
                 importer.location(weight_key)};
  }
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> weight, importer.values(weight_key, shape[0] * channels));
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> bias, importer.values(key + ".in_proj_bias", shape[0]));
  std::vector<std::string> inputs;
  for (const char* part : {"_query", "_key", "_value"}) {
    const auto first = static_cast<ptrdiff_t>(inputs.size() * channels), count = static_cast<ptrdiff_t>(channels);
    const auto rows = weight.begin() + first * count;
    const Layer layer{
        .name = name + part, .inputs = {inputs.empty() ? queries : memory}, .out_channels = channels, .residual = {}};
    inputs.push_back(
        importer.add(layer, {rows, rows + count * count}, {bias.begin() + first, bias.begin() + first + count}));
  }
  const std::string look = importer.add({.name = name + "_look",
                                         .op = Op::kAttention,
                                         .inputs = inputs,
                                         .attributes = {{"heads", {static_cast<double>(kHeads)}}},
                                         .residual = {}});
  return importer.linear({.name = name, .inputs = {look}, .residual = sum}, key + ".out_proj");
}

/// Adds x + linear2(ReLU(linear1(norm(x)))).
Result<std::string> add_feed_forward(CheckpointImporter& importer, const std::string& name, const std::string& key,
                                     const std::string& norm, const std::string& x) {
  E2LF_ASSIGN_OR_RETURN(const std::string even, importer.layer_norm(cat(name, "_", norm), cat(key, ".", norm), x));
  Layer wide{.name = name + "_wide", .inputs = {even}, .residual = {}, .relu = true};
  E2LF_ASSIGN_OR_RETURN(const std::string inner, importer.linear(std::move(wide), key + ".linear1"));
  return importer.linear({.name = name, .inputs = {inner}, .residual = x}, key + ".linear2");
}

/// Adds self-attention between pixels.
Result<std::string> add_self(CheckpointImporter& importer, const std::string& name, const std::string& key,
                             const std::string& x) {
  E2LF_ASSIGN_OR_RETURN(const std::string even, importer.layer_norm(name + "_norm1", key + ".norm1", x));
  return add_attention(importer, name + "_self", key + ".self_attn", even, even, x);
}

Result<std::string> add_encoder(CheckpointImporter& importer, size_t scale, const std::string& input) {
  std::string x =
      importer.add({.name = cat("place", scale), .op = Op::kPositionCode, .inputs = {input}, .residual = {}});
  for (size_t i = 0; has_layer(importer, encoder_key(scale, i)); ++i) {
    const std::string name = cat("self", scale, "_", i), key = encoder_key(scale, i);
    E2LF_ASSIGN_OR_RETURN(x, add_self(importer, name, key, x));
    E2LF_ASSIGN_OR_RETURN(x, add_feed_forward(importer, name, key, "norm2", x));
  }
  return x;
}

Result<std::string> add_decoder(CheckpointImporter& importer, size_t scale, const std::string& target,
                                const std::string& memory) {
  std::string x = target;
  for (size_t i = 0; i == 0 || has_layer(importer, decoder_key(scale, i)); ++i) {
    const std::string name = cat("cross", scale, "_", i), key = decoder_key(scale, i);
    E2LF_ASSIGN_OR_RETURN(x, add_self(importer, name, key, x));
    E2LF_ASSIGN_OR_RETURN(const std::string own, importer.layer_norm(name + "_norm21", key + ".norm21", x));
    E2LF_ASSIGN_OR_RETURN(const std::string other, importer.layer_norm(name + "_norm22", key + ".norm22", memory));
    E2LF_ASSIGN_OR_RETURN(x, add_attention(importer, name + "_cross", key + ".cross_attn", own, other, x));
    E2LF_ASSIGN_OR_RETURN(x, add_feed_forward(importer, name, key, "norm3", x));
  }
  return x;
}

/// Checks that a table of positions, if there is one, is that of kPositionCode, so that it need not be imported.
Result<void> check_positions(CheckpointImporter& importer) {
  const std::string key = "position_embedding.pos_table";
  if (!importer.has(key)) return {};
  E2LF_ASSIGN_OR_RETURN(const std::vector<size_t> shape, importer.shape(key, 3));
  const size_t channels = shape[2];
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> table, importer.values(key, shape[0] * shape[1] * channels));
  constexpr double kTolerance = 1e-3;  // for angles in float32
  for (size_t i = 0; i < table.size(); ++i) {
    const size_t c = i % channels;
    const double exponent = static_cast<double>(c / 2 * 2) / static_cast<double>(channels);
    const double angle = static_cast<double>(i / channels) / std::pow(10000.0, exponent);
    if (std::abs(table[i] - (c % 2 == 0 ? std::sin(angle) : std::cos(angle))) < kTolerance) continue;
    return Error{ErrorCode::kUnsupported, "positions are not encoded as sines; give the published file",
                 importer.location(key)};
  }
  return {};
}

}  // namespace

bool has_transformers(const CheckpointImporter& importer) {
  return has_layer(importer, encoder_key(0, 0));
}

Result<std::string> import_transformers(CheckpointImporter& importer, const std::vector<std::string>& cells) {
  E2LF_RETURN_IF_ERROR(check_positions(importer));
  std::vector<std::string> encoded;
  for (size_t scale = 0; scale < cells.size() && has_layer(importer, encoder_key(scale, 0)); ++scale) {
    std::string x = cells[cells.size() - 1 - scale];
    if (scale > 0) {
      Layer split{.name = cat("split", scale), .inputs = {x}, .stride = size_t{1} << scale, .residual = {}};
      E2LF_ASSIGN_OR_RETURN(x, importer.conv(std::move(split), cat("split", scale)));
    }
    E2LF_ASSIGN_OR_RETURN(x, add_encoder(importer, scale, x));
    encoded.push_back(x);
  }
  Layer mean{.name = "mean", .op = Op::kMean, .inputs = encoded, .residual = {}};
  for (size_t scale = 0; scale < encoded.size(); ++scale) {
    const std::string& memory = encoded[scale == 0 ? 0 : scale - 1];
    E2LF_ASSIGN_OR_RETURN(std::string x, add_decoder(importer, scale, encoded[scale], memory));
    mean.inputs.push_back(std::move(x));
  }
  return importer.add(std::move(mean));
}

}  // namespace e2lf::video
