// SPDX-License-Identifier: MIT
#include "e2lf/engine/conv.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "e2lf/engine/winograd.h"

namespace e2lf::engine {

PackedMatrices::PackedMatrices(ElementType type, size_t count, size_t depth, size_t columns, const Element& element,
                               size_t panel_width)
    : depth_(round_up(depth, 2)),
      columns_(padded_channels(columns)),
      buffer_(count * depth_ * columns_ * element_size(type)) {
  for (size_t matrix = 0; matrix < count; ++matrix) {
    for (size_t row = 0; row < depth; ++row) {
      for (size_t column = 0; column < columns; ++column) {
        const size_t begin = column / panel_width * panel_width;
        const size_t width = std::min(panel_width, columns_ - begin);
        const size_t panel = (matrix * columns_ + begin) * depth_;
        const float value = element(matrix, row, column);
        if (type == ElementType::kFloat32) {
          buffer_.as<float>()[panel + row * width + column - begin] = value;
          continue;
        }
        const size_t in_pairs = panel + row / 2 * 2 * width + (column - begin) * 2 + row % 2;
        if (type == ElementType::kBfloat16) {
          buffer_.as<Bfloat16>()[in_pairs] = to_bfloat16(value);
        } else {
          buffer_.as<int16_t>()[in_pairs] = static_cast<int16_t>(std::lround(value));
        }
      }
    }
  }
}

ScaledWeights pack_int16(size_t count, size_t depth, size_t columns, const PackedMatrices::Element& element,
                         size_t summed, size_t panel_width) {
  std::vector<float> scales(columns);
  ScaledWeights scaled;
  for (size_t column = 0; column < columns; ++column) {
    double sum = 0, largest_sum = 0, largest = 0;
    for (size_t matrix = 0; matrix < count; ++matrix) {
      if (matrix % summed == 0) sum = 0;
      for (size_t row = 0; row < depth; ++row) {
        const double weight = std::abs(element(matrix, row, column));
        sum += weight;
        largest = std::max(largest, weight);
      }
      largest_sum = std::max(largest_sum, sum);
    }
    // Rounding adds a half to each weight at most.
    const double most = 2.0 * INT16_MAX - static_cast<double>(summed * depth);
    scales[column] = largest > 0 ? static_cast<float>(std::min(most / largest_sum, INT16_MAX / largest)) : 1.0F;
    scaled.units.push_back(1 / scales[column]);
  }
  const auto integer = [&](size_t matrix, size_t row, size_t column) {
    return element(matrix, row, column) * scales[column];
  };
  scaled.weights = {ElementType::kInt16, count, depth, columns, integer, panel_width};
  return scaled;
}

namespace {

/// Returns the six values of G g.
std::array<double, kWinogradPoints> transform_weights(double g0, double g1, double g2) {
  constexpr double kA2 = kWinogradA * kWinogradA;
  constexpr double kB2 = kWinogradB * kWinogradB;
  const auto at = [&](double point, double scale) { return (g0 + point * g1 + point * point * g2) / scale; };
  return {at(0, kA2 * kB2),
          at(kWinogradA, 2 * kA2 * (kA2 - kB2)),
          at(-kWinogradA, 2 * kA2 * (kA2 - kB2)),
          at(kWinogradB, 2 * kB2 * (kB2 - kA2)),
          at(-kWinogradB, 2 * kB2 * (kB2 - kA2)),
          g2};
}

/// Transforms the 3x3 part of a kernel that begins at tap (y, x). Taps beyond the kernel are zero.
std::array<float, kWinogradMatrices> transform_part(const ConvSpec& spec, size_t out, size_t in, size_t y, size_t x) {
  const auto tap = [&](size_t dy, size_t dx) -> double {
    return y + dy < spec.kernel && x + dx < spec.kernel ? spec.tap(out, in, y + dy, x + dx) : 0.0F;
  };
  std::array<std::array<double, 3>, kWinogradPoints> half{};
  for (size_t dx = 0; dx < 3; ++dx) {
    const auto column = transform_weights(tap(0, dx), tap(1, dx), tap(2, dx));
    for (size_t i = 0; i < kWinogradPoints; ++i) half[i][dx] = column[i];
  }
  std::array<float, kWinogradMatrices> result{};
  for (size_t i = 0; i < kWinogradPoints; ++i) {
    const auto row = transform_weights(half[i][0], half[i][1], half[i][2]);
    for (size_t j = 0; j < kWinogradPoints; ++j) result[i * kWinogradPoints + j] = static_cast<float>(row[j]);
  }
  return result;
}

// The transforms add about a third to the 36 products per 16 outputs.
double winograd_cost(const ConvSpec& spec) {
  return 36.0 / 16.0 * 1.33 * static_cast<double>(winograd_parts(spec).depth() * padded_channels(spec.out_channels));
}

double direct_cost(const ConvSpec& spec) {
  const size_t taps = spec.transposed ? 1 : spec.kernel * spec.kernel;
  return static_cast<double>(taps * round_up(spec.in_channels, 2) * padded_channels(spec.out_channels)) /
         static_cast<double>(spec.transposed ? 1 : spec.stride * spec.stride);
}

/// Returns the transformed weights of output channel `out` and row `row` of the packed matrices at [row * out_channels
/// + out].
std::vector<std::array<float, kWinogradMatrices>> transform_all(const ConvSpec& spec, const WinogradParts& parts) {
  std::vector<std::array<float, kWinogradMatrices>> transformed(parts.depth() * spec.out_channels);
  for (size_t part = 0; part < parts.parts * parts.parts; ++part) {
    const size_t y = part / parts.parts;
    const size_t x = part % parts.parts;
    for (size_t in = 0; in < spec.in_channels; ++in) {
      const size_t row = y * parts.group + x * spec.in_channels + in;
      for (size_t out = 0; out < spec.out_channels; ++out) {
        transformed[row * spec.out_channels + out] = transform_part(spec, out, in, y * 3, x * 3);
      }
    }
  }
  return transformed;
}

std::string int16_refusal(const ConvSpec& spec) {
  if (!spec.int16_products) return "they are not wanted";
  return spec.in_channels < kChannelMultiple ? "too few input channels to pay for the rounding" : "";
}

}  // namespace

WinogradParts winograd_parts(const ConvSpec& spec) {
  const size_t parts = (spec.kernel + 2) / 3;
  return {parts, padded_channels(parts * spec.in_channels)};
}

PackedMatrices pack_winograd_weights(const ConvSpec& spec, size_t panel_width) {
  const WinogradParts parts = winograd_parts(spec);
  const auto transformed = transform_all(spec, parts);
  return {
      spec.compute,
      kWinogradMatrices,
      parts.depth(),
      spec.out_channels,
      [&](size_t matrix, size_t row, size_t column) { return transformed[row * spec.out_channels + column][matrix]; },
      panel_width};
}

ScaledWeights pack_winograd_int16(const ConvSpec& spec, size_t panel_width) {
  const WinogradParts parts = winograd_parts(spec);
  const auto transformed = transform_all(spec, parts);
  const auto element = [&](size_t matrix, size_t row, size_t column) {
    constexpr size_t kLast = kWinogradPoints - 1;
    const float weight = transformed[row * spec.out_channels + column][matrix];
    return weight / (matrix / kWinogradPoints == kLast ? kInt16LastPoint : 1) /
           (matrix % kWinogradPoints == kLast ? kInt16LastPoint : 1);
  };
  return pack_int16(kWinogradMatrices, parts.depth(), spec.out_channels, element, 1, panel_width);
}

std::string winograd_int16_refusal(const ConvSpec& spec) {
  // With more inputs, the weights would have too few digits.
  constexpr size_t kMostDepth = 256;
  if (const std::string refusal = int16_refusal(spec); !refusal.empty()) return refusal;
  if (winograd_parts(spec).depth() > kMostDepth) return "too many input channels";
  return winograd_refusal(spec);
}

std::string winograd_refusal(const ConvSpec& spec) {
  if (spec.transposed || spec.stride != 1) return "the stride is not 1";
  if (spec.kernel < 3) return "the kernel is 1x1";
  return winograd_cost(spec) < direct_cost(spec) ? "" : "too few input channels to pay for the transforms";
}

double conv_cost(const ConvSpec& spec) {
  return winograd_refusal(spec).empty() ? winograd_cost(spec) : direct_cost(spec);
}

const std::vector<ConvMethod>& conv_methods() {
  static const std::vector<ConvMethod> methods = {
      {"amx", amx_refusal, make_amx},
      {"winograd-int16", winograd_int16_refusal, [](const ConvSpec& spec) { return make_winograd(spec, true); }},
      {"winograd", winograd_refusal, [](const ConvSpec& spec) { return make_winograd(spec); }},
      {"direct-int16", int16_refusal, [](const ConvSpec& spec) { return make_direct(spec, true); }},
      {"direct", [](const ConvSpec&) { return std::string(); },
       [](const ConvSpec& spec) { return make_direct(spec); }}};
  return methods;
}

std::unique_ptr<Kernel> make_conv(const ConvSpec& spec) {
  const std::vector<ConvMethod>& methods = conv_methods();
  const auto first = std::find_if(methods.begin(), methods.end(),
                                  [&](const ConvMethod& method) { return method.refusal(spec).empty(); });
  return first->make(spec);  // the last method never refuses
}

}  // namespace e2lf::engine
