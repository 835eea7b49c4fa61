// SPDX-License-Identifier: MIT
// Comparison of pictures at each of a list of disparities; see GeometryOp::kPlaneSweep.
#include <span>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/geometry/operations.h"
#include "e2lf/geometry/shift.h"
#include "e2lf/model/onnx/onnx_export.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/geometry/plane_sweep.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/geometry/planar-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::geometry {
namespace HWY_NAMESPACE {
namespace {

/// Computes C and then E of each disparity, before they are averaged over windows, as planes. One block is one chunk.
class ProductsKernel final : public Kernel {
 public:
  explicit ProductsKernel(Sweep sweep) : sweep_(std::move(sweep)), line_(line_size(sweep_.reach)) {}

  std::string describe() const override { return std::string("plane sweep ") + hwy::TargetName(HWY_TARGET); }
  Reach reach() const override { return {sweep_.reach, sweep_.reach, 1, 1}; }
  size_t scratch_bytes() const override { return sweep_.channels() * line_ * sizeof(float); }
  size_t num_blocks(const Strip& strip) const override { return (strip.end - strip.begin) * chunks_of(strip); }

  void run_block(const Strip& strip, size_t block, std::byte* scratch) const override {
    const Chunk chunk(strip, block);
    auto* const lines = reinterpret_cast<float*>(scratch);
    float* const to = strip.output.row<float>(chunk.y) + chunk.begin;
    for (size_t k = 0; k < sweep_.disparities; ++k) {
      move_down(strip.inputs[0], chunk, k, lines);
      multiply(lines, chunk.count, k, to + k * chunk.width, to + (sweep_.disparities + k) * chunk.width);
    }
  }

 private:
  void move_down(const Rows& input, const Chunk& chunk, size_t k, float* lines) const {
    for (size_t channel = 0; channel < sweep_.channels(); ++channel, lines += line_) {
      const LinearShift& shift = sweep_.down[k * sweep_.pictures + channel / sweep_.features];
      const size_t plane = channel * chunk.width;
      const ptrdiff_t y = chunk.y + shift.first;
      const float* const rows[2] = {input.row<const float>(y) + plane, input.row<const float>(y + 1) + plane};
      blend_rows(rows, shift.weights.data(), chunk, sweep_.reach, /*repeats_edges=*/false, lines);
    }
  }

  void multiply(const float* lines, size_t count, size_t k, float* evidence, float* energy) const {
    const FloatTag d;
    const auto share = hn::Set(d, 1.0F / static_cast<float>(sweep_.features));
    const auto half_share = hn::Set(d, 0.5F / static_cast<float>(sweep_.features));
    for (size_t x = 0; x < count; x += kLanes) {
      auto products = hn::Zero(d), squares = hn::Zero(d);
      for (size_t feature = 0; feature < sweep_.features; ++feature) {
        auto sum = hn::Zero(d), own = hn::Zero(d);
        for (size_t p = 0; p < sweep_.pictures; ++p) {
          const LinearShift& shift = sweep_.across[k * sweep_.pictures + p];
          const float* const from = lines + (p * sweep_.features + feature) * line_ + x +
                                    static_cast<size_t>(static_cast<ptrdiff_t>(sweep_.reach) + shift.first);
          auto value = hn::Mul(hn::Set(d, shift.weights[0]), load_floats(from));
          value = hn::MulAdd(hn::Set(d, shift.weights[1]), load_floats(from + 1), value);
          sum = hn::Add(sum, value);
          own = hn::MulAdd(value, value, own);
        }
        products = hn::Add(products, hn::Sub(hn::Mul(sum, sum), own));
        squares = hn::Add(squares, own);
      }
      store_some(hn::Mul(products, half_share), count - x, evidence + x);
      store_some(hn::Mul(squares, share), count - x, energy + x);
    }
  }

  Sweep sweep_;
  size_t line_;
};

/// Averages C and E over windows with zeros outside of the image, and divides. One block is one chunk.
template <class Element>
class WindowKernel final : public Kernel {
 public:
  WindowKernel(size_t disparities, size_t kernel)
      : disparities_(disparities), kernel_(kernel), radius_(kernel / 2), line_(line_size(radius_)) {}

  std::string describe() const override {
    return "windows of " + std::to_string(kernel_) + " " + hwy::TargetName(HWY_TARGET);
  }
  Reach reach() const override { return {radius_, radius_, 1, 1}; }
  size_t scratch_bytes() const override { return (2 * line_ + disparities_ * kChunk) * sizeof(float); }
  size_t num_blocks(const Strip& strip) const override { return (strip.end - strip.begin) * chunks_of(strip); }

  void run_block(const Strip& strip, size_t block, std::byte* scratch) const override {
    const Chunk chunk(strip, block);
    auto* const evidence = reinterpret_cast<float*>(scratch);
    float *const energy = evidence + line_, *const results = energy + line_;
    for (size_t k = 0; k < disparities_; ++k) {
      sum_down(strip.inputs[0], chunk, k, evidence);
      sum_down(strip.inputs[0], chunk, disparities_ + k, energy);
      divide(evidence, energy, chunk.count, results + k * kChunk);
    }
    store_pixels(results, disparities_, chunk, strip.output.row<Element>(chunk.y));
  }

 private:
  void sum_down(const Rows& input, const Chunk& chunk, size_t plane, float* line) const {
    const auto radius = static_cast<ptrdiff_t>(radius_);
    fill_line(chunk, radius_, /*repeats_edges=*/false, line, [&](ptrdiff_t column) HWY_ATTR {
      auto sum = hn::Zero(FloatTag());
      for (ptrdiff_t dy = -radius; dy <= radius; ++dy) {
        sum = hn::Add(sum, load_floats(input.row<const float>(chunk.y + dy) + plane * chunk.width + column));
      }
      return sum;
    });
  }

  void divide(const float* evidence, const float* energy, size_t count, float* to) const {
    const FloatTag d;
    const auto share = hn::Set(d, 1.0F / static_cast<float>(kernel_ * kernel_)), one = hn::Set(d, 1.0F);
    for (size_t x = 0; x < count; x += kLanes) {
      auto products = hn::Zero(d), squares = hn::Zero(d);
      for (size_t dx = 0; dx < kernel_; ++dx) {
        products = hn::Add(products, load_floats(evidence + x + dx));
        squares = hn::Add(squares, load_floats(energy + x + dx));
      }
      store_floats(hn::Div(hn::Mul(products, share), hn::MulAdd(squares, share, one)), to + x);
    }
  }

  size_t disparities_, kernel_, radius_, line_;
};

}  // namespace

Result<void> PlanSweep(PlanBuilder& build, const model::Layer& layer) {
  const TensorSpec input = build.spec(layer.inputs[0]), &output = build.spec(layer.name);
  const Sweep sweep(layer, input.channels);
  const auto planes = [&](size_t channels) { return TensorSpec{channels, input.scale, ElementType::kFloat32}; };
  const size_t rows = build.add_part(layer.name + ".planes", make_planar(input.channels, 0, input.type),
                                     {build.tensor(layer.inputs[0])}, planes(input.channels));
  const size_t sums = build.add_part(layer.name + ".products", std::make_unique<ProductsKernel>(sweep), {rows},
                                     planes(2 * sweep.disparities));
  auto windows = for_element(output.type, [&](auto element) -> std::unique_ptr<Kernel> {
    return std::make_unique<WindowKernel<decltype(element)>>(sweep.disparities, layer.kernel);
  });
  build.set_result(layer, build.add_part(layer.name, std::move(windows), {sums}, output));
  return {};
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::geometry
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::geometry {

using model::Integers, model::Layer, model::LayerShape;

HWY_EXPORT(PlanSweep);

namespace {

Result<LayerShape> sweep_shape(const Layer& layer, std::span<const LayerShape> inputs) {
  E2LF_RETURN_IF_ERROR(model::check_kernel(layer));
  const std::vector<double> offsets = numbers(layer, "offsets"), disparities = numbers(layer, "disparities");
  E2LF_RETURN_IF_ERROR(check_shifts(offsets, disparities));
  if (offsets.size() % 2 != 0 || inputs[0].channels % (offsets.size() / 2) != 0) {
    return fail(ErrorCode::kShape, "", offsets.size(), " offsets for ", inputs[0].channels,
                " channels; give a row and a column for each picture, of which each has as many features");
  }
  return LayerShape{disparities.size(), inputs[0].scale};
}

/// Adds a convolution that moves each channel to all disparities: [picture, feature, disparity].
std::string add_shifts(model::OnnxCall& call, const Sweep& sweep) {
  const size_t side = 2 * sweep.reach + 1, channels = sweep.channels(), outputs = channels * sweep.disparities;
  std::vector<float> kernels(outputs * side * side);
  for (size_t out = 0; out < outputs; ++out) {
    const size_t k = out % sweep.disparities, p = out / sweep.disparities / sweep.features;
    const LinearShift &down = sweep.down[k * sweep.pictures + p], &across = sweep.across[k * sweep.pictures + p];
    for (size_t tap = 0; tap < 4; ++tap) {
      const auto at = [&](ptrdiff_t first, size_t n) {
        return static_cast<size_t>(static_cast<ptrdiff_t>(sweep.reach + n) + first);
      };
      kernels[(out * side + at(down.first, tap / 2)) * side + at(across.first, tap % 2)] +=
          down.weights[tap / 2] * across.weights[tap % 2];
    }
  }
  const std::string name = "shifts/" + call.layer.name;
  const std::vector<size_t> shape = {outputs, 1, side, side};
  const std::string weights = call.graph.add_constant(name + "/kernels", shape, kernels);
  return call.graph.add_node("Conv", {call.inputs[0], weights}, name,
                             {{"group", static_cast<int64_t>(channels)},
                              {"kernel_shape", Integers(2, static_cast<int64_t>(side))},
                              {"pads", Integers(4, static_cast<int64_t>(sweep.reach))}});
}

/// Adds the mean over the features and the window of a tensor [feature, disparity].
std::string add_means(model::OnnxCall& call, const Sweep& sweep, const std::string& from, const std::string& name) {
  std::vector<std::string> features;
  for (size_t feature = 0; feature < sweep.features; ++feature) {
    features.push_back(
        call.slice(from, feature * sweep.disparities, (feature + 1) * sweep.disparities, cat(name, "/", feature)));
  }
  const std::string mean = call.graph.add_node("Mean", features, name + "/features");
  const auto kernel = static_cast<int64_t>(sweep.kernel);
  return call.graph.add_node(
      "AveragePool", {mean}, name,
      {{"kernel_shape", Integers(2, kernel)}, {"pads", Integers(4, kernel / 2)}, {"count_include_pad", int64_t{1}}});
}

std::string export_sweep(model::OnnxCall& call) {
  const Sweep sweep(call.layer, call.input_shapes[0].channels);
  const std::string moved = add_shifts(call, sweep), &name = call.layer.name;
  std::vector<std::string> pictures, squares;
  for (size_t p = 0; p < sweep.pictures; ++p) {
    const size_t planes = sweep.features * sweep.disparities;
    pictures.push_back(call.slice(moved, p * planes, (p + 1) * planes, cat("pictures/", name, "/", p)));
    squares.push_back(call.graph.add_node("Mul", {pictures.back(), pictures.back()}, cat("squares/", name, "/", p)));
  }
  const std::string sum = call.graph.add_node("Sum", pictures, "sums/" + name);
  const std::string own = call.graph.add_node("Sum", squares, "squares/" + name);
  const std::string square = call.graph.add_node("Mul", {sum, sum}, "sums/" + name + "/square");
  const std::string twice = call.graph.add_node("Sub", {square, own}, "products/" + name + "/twice");
  const std::string half = call.graph.add_constant("products/" + name + "/half", 0.5F);
  const std::string products = call.graph.add_node("Mul", {twice, half}, "products/" + name);
  const std::string evidence = add_means(call, sweep, products, "evidence/" + name);
  const std::string energy = add_means(call, sweep, own, "energy/" + name);
  const std::string one = call.graph.add_constant("energy/" + name + "/one", 1.0F);
  const std::string divisor = call.graph.add_node("Add", {energy, one}, "divisors/" + name);
  return call.graph.add_node("Div", {evidence, divisor}, call.output);
}

}  // namespace

engine::Operation plane_sweep() {
  return {.model = {.name = GeometryOp::kPlaneSweep,
                    .attributes = {"offsets", "disparities"},
                    .shape = sweep_shape,
                    // Two shifts, a sum and a square of each channel, and the sums over windows.
                    .macs =
                        [](const Layer& layer, std::span<const LayerShape> inputs) {
                          const double each = 6 * static_cast<double>(inputs[0].channels + layer.kernel);
                          return static_cast<double>(numbers(layer, "disparities").size()) * each;
                        },
                    .reach = [](const Layer& layer) { return Sweep(layer, 0).reach + layer.kernel / 2; },
                    .onnx = export_sweep},
          .plan = [](engine::PlanBuilder& build, const Layer& layer) {
            return HWY_DYNAMIC_DISPATCH(PlanSweep)(build, layer);
          }};
}

}  // namespace e2lf::geometry
#endif
