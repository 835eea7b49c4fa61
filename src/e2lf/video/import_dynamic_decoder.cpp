// SPDX-License-Identifier: MIT
#include <cmath>

#include "e2lf/base/text.h"
#include "e2lf/video/import_event_video.h"

namespace e2lf::video {
namespace {

// This is far above the published network. The limit is needed because files from other sources are read here.
constexpr size_t kMostFilterValues = 4096;

/// The bases from which the filters of each pixel are computed by means of coefficients.
struct Bases {
  size_t count = 0, kernel = 0, filters = 0;
  std::vector<float> values;  ///< [count, kernel^2]

  [[nodiscard]] size_t taps() const { return kernel * kernel; }
};

Result<Bases> read_bases(CheckpointImporter& importer, const std::string& key, size_t coefficients) {
  E2LF_ASSIGN_OR_RETURN(const std::vector<size_t> shape, importer.shape(key, 2));
  Bases bases{.count = shape[0],
              .kernel = static_cast<size_t>(std::lround(std::sqrt(static_cast<double>(shape[1])))),
              .filters = coefficients / shape[0],
              .values = {}};
  const bool fits = bases.taps() == shape[1] && bases.kernel % 2 == 1 && coefficients % bases.count == 0 &&
                    coefficients > 0 && coefficients <= kMostFilterValues &&
                    bases.taps() <= kMostFilterValues / bases.filters;
  if (!fits) {
    return fail(ErrorCode::kShape, importer.location(key), "the bases have shape ", shape_text(shape),
                ", but there are ", coefficients, " coefficients; give the published file");
  }
  E2LF_ASSIGN_OR_RETURN(bases.values, importer.values(key, shape[0] * shape[1]));
  return bases;
}

/// Samples bilinearly at a quarter of the resolution, i.e. between the four central pixels of each 4x4 block.
std::string add_quarter(CheckpointImporter& importer, const std::string& name, const std::string& input,
                        size_t channels) {
  constexpr size_t kSize = 4;
  std::vector<float> weight(channels * channels * kSize * kSize);
  for (size_t c = 0; c < channels; ++c) {
    float* taps = &weight[(c * channels + c) * kSize * kSize];
    for (const size_t middle : {5, 6, 9, 10}) taps[middle] = 0.25F;
  }
  const Layer layer{.name = name, .inputs = {input}, .out_channels = channels, .kernel = kSize, .stride = kSize};
  return importer.add(layer, std::move(weight), std::vector<float>(channels));
}

/// Computes filter m as the sum over k of coefficient [m, k] times basis k.
std::string add_filters(CheckpointImporter& importer, const std::string& name, const std::string& coefficients,
                        const Bases& bases) {
  const size_t out = bases.filters * bases.taps(), in = bases.filters * bases.count;
  std::vector<float> weight(out * in);
  for (size_t i = 0; i < out; ++i) {
    const size_t filter = i / bases.taps(), tap = i % bases.taps();
    for (size_t k = 0; k < bases.count; ++k) {
      weight[i * in + filter * bases.count + k] = bases.values[k * bases.taps() + tap];
    }
  }
  return importer.add({.name = name, .inputs = {coefficients}, .out_channels = out}, std::move(weight),
                      std::vector<float>(out));
}

/// The checkpoint orders the inputs as [channel, filter], whereas kDynamicFilter gives [filter, channel].
Result<std::string> add_mix(CheckpointImporter& importer, const std::string& name, const std::string& key,
                            const std::string& input, size_t filters) {
  const std::string weight_key = key + ".compositional_coefficients";
  E2LF_ASSIGN_OR_RETURN(const std::vector<size_t> shape, importer.shape(weight_key, 4));
  const size_t out = shape[0], in = shape[1], channels = in / filters;
  if (in % filters != 0) {
    return fail(ErrorCode::kShape, importer.location(weight_key), "there are ", in,
                " inputs, which is not a multiple of the ", filters, " filters; give the published file");
  }
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> from, importer.values(weight_key, out * in));
  E2LF_ASSIGN_OR_RETURN(std::vector<float> bias, importer.values(key + ".bias", out));
  std::vector<float> weight(from.size());
  for (size_t i = 0; i < from.size(); ++i) {
    const size_t channel = i % in / filters, filter = i % filters;
    weight[i / in * in + filter * channels + channel] = from[i];
  }
  return importer.add({.name = name, .inputs = {input}, .out_channels = out, .relu = true}, std::move(weight),
                      std::move(bias));
}

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
    return fail(ErrorCode::kShape, importer.location(weight_key), "the weights have shape ", shape_text(shape),
                ", which is not that of queries, keys and values with ", kHeads, " heads; give the published file");
  }
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> weight, importer.values(weight_key, shape[0] * channels));
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> bias, importer.values(key + ".in_proj_bias", shape[0]));
  std::vector<std::string> inputs;
  for (const char* part : {"_query", "_key", "_value"}) {
    const auto first = static_cast<ptrdiff_t>(inputs.size() * channels), count = static_cast<ptrdiff_t>(channels);
    const auto rows = weight.begin() + first * count;
    const Layer layer{.name = name + part, .inputs = {inputs.empty() ? queries : memory}, .out_channels = channels};
    inputs.push_back(
        importer.add(layer, {rows, rows + count * count}, {bias.begin() + first, bias.begin() + first + count}));
  }
  const std::string look = importer.add({.name = name + "_look",
                                         .op = VideoOp::kAttention,
                                         .inputs = inputs,
                                         .attributes = {{"heads", {static_cast<double>(kHeads)}}}});
  return importer.linear({.name = name, .inputs = {look}, .residual = sum}, key + ".out_proj");
}

/// Adds x + linear2(ReLU(linear1(norm(x)))).
Result<std::string> add_feed_forward(CheckpointImporter& importer, const std::string& name, const std::string& key,
                                     const std::string& norm, const std::string& x) {
  E2LF_ASSIGN_OR_RETURN(const std::string even, importer.layer_norm(cat(name, "_", norm), cat(key, ".", norm), x));
  Layer wide{.name = name + "_wide", .inputs = {even}, .relu = true};
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
  std::string x = importer.add({.name = cat("place", scale), .op = VideoOp::kPositionCode, .inputs = {input}});
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
    return fail(ErrorCode::kUnsupported, importer.location(key),
                "positions are not encoded as sines; give the published file");
  }
  return {};
}

}  // namespace

bool is_dynamic_decoder(const CheckpointImporter& importer, const std::string& key) {
  return importer.has(key + ".dynamic_conv.compositional_coefficients");
}

Result<std::string> import_dynamic_decoder(CheckpointImporter& importer, const std::string& name,
                                           const std::string& key, const std::string& input) {
  const auto layer = [](const std::string& layer_name, const char* op, std::vector<std::string> inputs) {
    return Layer{.name = layer_name, .op = op, .inputs = std::move(inputs)};
  };
  E2LF_ASSIGN_OR_RETURN(const size_t bins, importer.bins());
  if (bins > kMaxBins) {
    return fail(ErrorCode::kShape, importer.location(key), "the network has ", bins,
                " time bins, which is too many; give the published file");
  }
  Layer last = layer(name + "_previous", VideoOp::kPrevious, {});
  last.out_channels = 1;
  std::string x = importer.add(last);
  x = importer.add(layer(name + "_context", VideoOp::kConcat, {"input", x}));
  x = add_quarter(importer, name + "_quarter", x, bins + 1);
  E2LF_ASSIGN_OR_RETURN(x, importer.conv(layer(name + "_fusion", VideoOp::kConv, {x}), key + ".context_fusion.conv"));

  const std::string atoms = key + ".dynamic_atom_generation", net = atoms + ".bases_net.";
  E2LF_ASSIGN_OR_RETURN(x, importer.conv(layer(name + "_hidden", VideoOp::kConv, {x}), net + "0", net + "1"));
  x = importer.add(layer(name + "_hidden_tanh", VideoOp::kTanh, {x}));
  E2LF_ASSIGN_OR_RETURN(x, importer.conv(layer(name + "_weights", VideoOp::kConv, {x}), net + "3", net + "4"));
  x = importer.add(layer(name + "_coefficients", VideoOp::kTanh, {x}));
  E2LF_ASSIGN_OR_RETURN(const std::vector<size_t> last_conv, importer.shape(net + "3.weight", 4));
  E2LF_ASSIGN_OR_RETURN(const Bases bases, read_bases(importer, atoms + ".bases", last_conv[0]));
  x = add_filters(importer, name + "_filters", x, bases);

  Layer filtered = layer(name + "_filtered", VideoOp::kDynamicFilter, {input, x});
  filtered.kernel = bases.kernel;
  x = importer.add(filtered);
  return add_mix(importer, name, key + ".dynamic_conv", x, bases.filters);
}

bool has_transformers(const CheckpointImporter& importer) {
  return has_layer(importer, encoder_key(0, 0));
}

Result<std::string> import_transformers(CheckpointImporter& importer, const std::vector<std::string>& cells) {
  E2LF_RETURN_IF_ERROR(check_positions(importer));
  std::vector<std::string> encoded;
  for (size_t scale = 0; scale < cells.size() && has_layer(importer, encoder_key(scale, 0)); ++scale) {
    std::string x = cells[cells.size() - 1 - scale];
    if (scale > 0) {
      Layer split{.name = cat("split", scale), .inputs = {x}, .stride = size_t{1} << scale};
      E2LF_ASSIGN_OR_RETURN(x, importer.conv(std::move(split), cat("split", scale)));
    }
    E2LF_ASSIGN_OR_RETURN(x, add_encoder(importer, scale, x));
    encoded.push_back(x);
  }
  Layer mean{.name = "mean", .op = VideoOp::kMean, .inputs = encoded};
  for (size_t scale = 0; scale < encoded.size(); ++scale) {
    const std::string& memory = encoded[scale == 0 ? 0 : scale - 1];
    E2LF_ASSIGN_OR_RETURN(std::string x, add_decoder(importer, scale, encoded[scale], memory));
    mean.inputs.push_back(std::move(x));
  }
  return importer.add(std::move(mean));
}

}  // namespace e2lf::video
