// SPDX-License-Identifier: MIT
#include <cmath>

#include "e2lf/base/text.h"
#include "e2lf/model/model_parts.h"
#include "e2lf/video/checkpoint_importer.h"

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
    return Error{
        ErrorCode::kShape,
        cat("bases of shape ", shape_text(shape), " for ", coefficients, " coefficients; give the published file"),
        importer.location(key)};
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
  const Layer layer{
      .name = name, .inputs = {input}, .out_channels = channels, .kernel = kSize, .stride = kSize, .residual = {}};
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
  return importer.add({.name = name, .inputs = {coefficients}, .out_channels = out, .residual = {}}, std::move(weight),
                      std::vector<float>(out));
}

/// The checkpoint orders the inputs as [channel, filter], whereas kDynamicFilter gives [filter, channel].
Result<std::string> add_mix(CheckpointImporter& importer, const std::string& name, const std::string& key,
                            const std::string& input, size_t filters) {
  const std::string weight_key = key + ".compositional_coefficients";
  E2LF_ASSIGN_OR_RETURN(const std::vector<size_t> shape, importer.shape(weight_key, 4));
  const size_t out = shape[0], in = shape[1], channels = in / filters;
  if (in % filters != 0) {
    return Error{ErrorCode::kShape, cat(in, " inputs for ", filters, " filters; give the published file"),
                 importer.location(weight_key)};
  }
  E2LF_ASSIGN_OR_RETURN(const std::vector<float> from, importer.values(weight_key, out * in));
  E2LF_ASSIGN_OR_RETURN(std::vector<float> bias, importer.values(key + ".bias", out));
  std::vector<float> weight(from.size());
  for (size_t i = 0; i < from.size(); ++i) {
    const size_t channel = i % in / filters, filter = i % filters;
    weight[i / in * in + filter * channels + channel] = from[i];
  }
  return importer.add({.name = name, .inputs = {input}, .out_channels = out, .residual = {}, .relu = true},
                      std::move(weight), std::move(bias));
}

}  // namespace

bool is_dynamic_decoder(const CheckpointImporter& importer, const std::string& key) {
  return importer.has(key + ".dynamic_conv.compositional_coefficients");
}

Result<std::string> import_dynamic_decoder(CheckpointImporter& importer, const std::string& name,
                                           const std::string& key, const std::string& input) {
  const auto layer = [](const std::string& layer_name, const char* op, std::vector<std::string> inputs) {
    return Layer{.name = layer_name, .op = op, .inputs = std::move(inputs), .residual = {}};
  };
  E2LF_ASSIGN_OR_RETURN(const size_t bins, importer.bins());
  if (bins > kMaxBins) {
    return Error{ErrorCode::kShape, cat(bins, " time bins; give the published file"), importer.location(key)};
  }
  Layer last = layer(name + "_previous", Op::kPrevious, {});
  last.out_channels = 1;
  std::string x = importer.add(last);
  x = importer.add(layer(name + "_context", Op::kConcat, {"input", x}));
  x = add_quarter(importer, name + "_quarter", x, bins + 1);
  E2LF_ASSIGN_OR_RETURN(x, importer.conv(layer(name + "_fusion", Op::kConv, {x}), key + ".context_fusion.conv"));

  const std::string atoms = key + ".dynamic_atom_generation", net = atoms + ".bases_net.";
  E2LF_ASSIGN_OR_RETURN(x, importer.conv(layer(name + "_hidden", Op::kConv, {x}), net + "0", net + "1"));
  x = importer.add(layer(name + "_hidden_tanh", Op::kTanh, {x}));
  E2LF_ASSIGN_OR_RETURN(x, importer.conv(layer(name + "_weights", Op::kConv, {x}), net + "3", net + "4"));
  x = importer.add(layer(name + "_coefficients", Op::kTanh, {x}));
  E2LF_ASSIGN_OR_RETURN(const std::vector<size_t> last_conv, importer.shape(net + "3.weight", 4));
  E2LF_ASSIGN_OR_RETURN(const Bases bases, read_bases(importer, atoms + ".bases", last_conv[0]));
  x = add_filters(importer, name + "_filters", x, bases);

  Layer filtered = layer(name + "_filtered", Op::kDynamicFilter, {input, x});
  filtered.kernel = bases.kernel;
  x = importer.add(filtered);
  return add_mix(importer, name, key + ".dynamic_conv", x, bases.filters);
}

}  // namespace e2lf::video
