// SPDX-License-Identifier: MIT
// Views of planes with opacities; see GeometryOp::kRenderLayers.
#include <numeric>
#include <span>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/geometry/operations.h"
#include "e2lf/geometry/shift.h"
#include "e2lf/model/onnx/onnx_export.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/geometry/render_layers.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/geometry/planar-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::geometry {
namespace HWY_NAMESPACE {
namespace {

/// Renders the views with the numbers `views` from planes of opacity and intensity. One block is one chunk.
template <class Element>
class RenderKernel final : public Kernel {
 public:
  RenderKernel(Viewpoints viewpoints, std::vector<size_t> views)
      : viewpoints_(std::move(viewpoints)), views_(std::move(views)), line_(line_size(viewpoints_.reach)) {}

  std::string describe() const override {
    return "views of " + std::to_string(viewpoints_.planes) + " planes " + hwy::TargetName(HWY_TARGET);
  }
  Reach reach() const override { return {viewpoints_.reach, viewpoints_.reach, 1, 1}; }
  size_t scratch_bytes() const override {
    return (2 * viewpoints_.planes * line_ + views_.size() * kChunk) * sizeof(float);
  }
  size_t num_blocks(const Strip& strip) const override { return (strip.end - strip.begin) * chunks_of(strip); }

  std::unique_ptr<Kernel> with_outputs(std::span<const size_t> channels) const override {
    std::vector<size_t> some;
    for (const size_t channel : channels) some.push_back(views_[channel]);
    return std::make_unique<RenderKernel>(viewpoints_, std::move(some));
  }

  void run_block(const Strip& strip, size_t block, std::byte* scratch) const override {
    const Chunk chunk(strip, block);
    auto* const lines = reinterpret_cast<float*>(scratch);
    float* const pictures = lines + 2 * viewpoints_.planes * line_;
    size_t moved_row = viewpoints_.rows;
    for (size_t n = 0; n < views_.size(); ++n) {
      const size_t row = views_[n] / viewpoints_.columns, column = views_[n] % viewpoints_.columns;
      if (row != moved_row) move_down(strip, chunk, row, lines);
      moved_row = row;
      compose(lines, chunk.count, &viewpoints_.across[column * viewpoints_.planes], pictures + n * kChunk);
    }
    store_pixels(pictures, views_.size(), chunk, strip.output.row<Element>(chunk.y));
  }

 private:
  void move_down(const Strip& strip, const Chunk& chunk, size_t view_row, float* lines) const {
    const size_t planes = viewpoints_.planes;
    for (size_t channel = 0; channel < 2 * planes; ++channel, lines += line_) {
      const CubicShift& shift = viewpoints_.down[view_row * planes + channel % planes];
      const float* rows[4];
      for (ptrdiff_t tap = 0; tap < 4; ++tap) {
        const auto last = static_cast<ptrdiff_t>(strip.height) - 1;
        const ptrdiff_t y = std::clamp<ptrdiff_t>(chunk.y + shift.first + tap, 0, last);
        rows[tap] = strip.inputs[0].row<const float>(y) + channel * chunk.width;
      }
      blend_rows(rows, shift.weights.data(), chunk, viewpoints_.reach, /*repeats_edges=*/true, lines);
    }
  }

  HWY_INLINE FloatVec move_across(const float* line, const CubicShift& shift) const {
    const FloatTag d;
    line += static_cast<ptrdiff_t>(viewpoints_.reach) + shift.first;
    auto sum = hn::Mul(hn::Set(d, shift.weights[0]), load_floats(line));
    sum = hn::MulAdd(hn::Set(d, shift.weights[1]), load_floats(line + 1), sum);
    sum = hn::MulAdd(hn::Set(d, shift.weights[2]), load_floats(line + 2), sum);
    return hn::MulAdd(hn::Set(d, shift.weights[3]), load_floats(line + 3), sum);
  }

  /// Adds the planes from front to back.
  void compose(const float* lines, size_t count, const CubicShift* shifts, float* picture) const {
    const FloatTag d;
    const auto zero = hn::Zero(d), one = hn::Set(d, 1.0F);
    const size_t planes = viewpoints_.planes;
    for (size_t x = 0; x < count; x += kLanes) {
      auto passed = one, sum = zero;
      for (size_t plane = 0; plane < planes; ++plane) {
        const float* const opacities = lines + plane * line_ + x;
        const auto opacity = hn::Min(hn::Max(move_across(opacities, shifts[plane]), zero), one);
        const auto share = hn::Mul(passed, opacity);
        sum = hn::MulAdd(share, move_across(opacities + planes * line_, shifts[plane]), sum);
        passed = hn::Sub(passed, share);
      }
      store_floats(sum, picture + x);
    }
  }

  Viewpoints viewpoints_;
  std::vector<size_t> views_;
  size_t line_;
};

}  // namespace

Result<void> PlanRender(PlanBuilder& build, const model::Layer& layer) {
  const Viewpoints viewpoints(layer);
  const TensorSpec input = build.spec(layer.inputs[0]), &output = build.spec(layer.name);
  const size_t planes =
      build.add_part(layer.name + ".planes", make_planar(input.channels, viewpoints.planes, input.type),
                     {build.tensor(layer.inputs[0])}, {input.channels, input.scale, ElementType::kFloat32});
  std::vector<size_t> all(viewpoints.views());
  std::iota(all.begin(), all.end(), size_t{0});
  auto views = for_element(output.type, [&](auto element) -> std::unique_ptr<Kernel> {
    return std::make_unique<RenderKernel<decltype(element)>>(viewpoints, std::move(all));
  });
  build.set_result(layer, build.add_part(layer.name, std::move(views), {planes}, output));
  return {};
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::geometry
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::geometry {

using model::Integers, model::Layer, model::LayerShape;

HWY_EXPORT(PlanRender);

namespace {

Result<LayerShape> render_shape(const Layer& layer, std::span<const LayerShape> inputs) {
  const std::vector<double> disparities = numbers(layer, "disparities");
  E2LF_RETURN_IF_ERROR(check_shifts(numbers(layer, "rows"), disparities));
  E2LF_RETURN_IF_ERROR(check_shifts(numbers(layer, "columns"), disparities));
  if (inputs[0].channels != 2 * disparities.size()) {
    return fail(ErrorCode::kShape, "", inputs[0].channels, " channels for ", disparities.size(),
                " planes; give an opacity and an intensity for each");
  }
  return LayerShape{numbers(layer, "rows").size() * numbers(layer, "columns").size(), inputs[0].scale};
}

/// Adds a convolution of each channel with kernels of its own, without padding.
std::string add_moves(model::OnnxCall& call, const std::string& from, const std::vector<CubicShift>& shifts,
                      const std::vector<size_t>& order, size_t groups, bool is_down, const std::string& name) {
  const auto reach = static_cast<ptrdiff_t>(Viewpoints(call.layer).reach);
  const auto side = static_cast<size_t>(2 * reach + 1);
  std::vector<float> kernels(order.size() * side);
  for (size_t out = 0; out < order.size(); ++out) {
    const CubicShift& shift = shifts[order[out]];
    float* const kernel = &kernels[out * side] + reach + shift.first;
    for (size_t tap = 0; tap < 4; ++tap) kernel[tap] += shift.weights[tap];
  }
  const std::vector<size_t> shape = {order.size(), 1, is_down ? side : 1, is_down ? 1 : side};
  const Integers sides = {static_cast<int64_t>(shape[2]), static_cast<int64_t>(shape[3])};
  const std::string weights = call.graph.add_constant(name + "/kernels", shape, kernels);
  return call.graph.add_node("Conv", {from, weights}, name,
                             {{"group", static_cast<int64_t>(groups)}, {"kernel_shape", sides}});
}

/// Adds the opacities, of which the last one is 1, and the intensities, with edges repeated.
std::string add_maps(model::OnnxCall& call, const Viewpoints& viewpoints) {
  model::OnnxGraph& graph = call.graph;
  const std::string name = "planes/" + call.layer.name, &input = call.inputs[0];
  const size_t planes = viewpoints.planes;
  const std::string before = call.slice(input, 0, planes - 1, name + "/before");
  const std::string opacities = graph.add_node("Sigmoid", {before}, name + "/opacities");
  const std::string last = call.slice(input, planes - 1, planes, name + "/last");
  const std::string zero = graph.add_node("Sub", {last, last}, name + "/zero");
  const std::string opaque = graph.add_node("Exp", {zero}, name + "/opaque");
  const std::string intensities = call.slice(input, planes, 2 * planes, name + "/intensities");
  const std::string maps = graph.add_node("Concat", {opacities, opaque, intensities}, name, {{"axis", int64_t{1}}});
  const auto reach = static_cast<int64_t>(viewpoints.reach);
  const std::string pads = graph.add_constant(name + "/pads", Integers{0, 0, reach, reach, 0, 0, reach, reach});
  return graph.add_node("Pad", {maps, pads}, name + "/padded", {{"mode", std::string("edge")}});
}

/// Adds the views of a row from its planes [map, plane, column].
std::string add_row(model::OnnxCall& call, const Viewpoints& viewpoints, const std::string& moved,
                    const std::string& name) {
  model::OnnxGraph& graph = call.graph;
  const size_t planes = viewpoints.planes, columns = viewpoints.columns;
  const std::string zero = graph.add_constant(name + "/zero", 0.0F), one = graph.add_constant(name + "/one", 1.0F);
  std::string sum, passed;
  for (size_t plane = 0; plane < planes; ++plane) {
    const std::string own = cat(name, "/", plane);
    const std::string opacity = call.slice(moved, plane * columns, (plane + 1) * columns, own + "/opacity");
    const std::string intensity =
        call.slice(moved, (planes + plane) * columns, (planes + plane + 1) * columns, own + "/intensity");
    std::string share = graph.add_node("Clip", {opacity, zero, one}, own + "/clipped");
    if (plane > 0) share = graph.add_node("Mul", {share, passed}, own + "/share");
    passed = graph.add_node("Sub", {plane > 0 ? passed : one, share}, own + "/passed");
    const std::string part = graph.add_node("Mul", {share, intensity}, own + "/part");
    sum = plane > 0 ? graph.add_node("Add", {sum, part}, own + "/sum") : part;
  }
  return sum;
}

std::string export_render(model::OnnxCall& call) {
  const Viewpoints viewpoints(call.layer);
  const std::string maps = add_maps(call, viewpoints);
  const size_t planes = viewpoints.planes;
  std::vector<size_t> across;  // [map, plane, column]
  for (size_t map = 0; map < 2 * planes; ++map) {
    for (size_t column = 0; column < viewpoints.columns; ++column) across.push_back(column * planes + map % planes);
  }
  std::vector<std::string> rows;
  for (size_t row = 0; row < viewpoints.rows; ++row) {
    std::vector<size_t> down;
    for (size_t map = 0; map < 2 * planes; ++map) down.push_back(row * planes + map % planes);
    const std::string name = cat("rows/", call.layer.name, "/", row);
    const std::string lower = add_moves(call, maps, viewpoints.down, down, 2 * planes, true, name + "/down");
    const std::string moved = add_moves(call, lower, viewpoints.across, across, 2 * planes, false, name + "/across");
    rows.push_back(add_row(call, viewpoints, moved, name));
  }
  return call.graph.add_node("Concat", rows, call.output, {{"axis", int64_t{1}}});
}

}  // namespace

engine::Operation render_layers() {
  return {
      .model = {.name = GeometryOp::kRenderLayers,
                .attributes = {"disparities", "rows", "columns"},
                .shape = render_shape,
                // Both maps of each plane are moved with four taps, down for each row and across for each view.
                .macs =
                    [](const Layer& layer, std::span<const LayerShape>) {
                      const Viewpoints viewpoints(layer);
                      return static_cast<double>(viewpoints.planes * (8 * viewpoints.rows + 10 * viewpoints.views()));
                    },
                .reach = [](const Layer& layer) { return Viewpoints(layer).reach; },
                .onnx = export_render},
      .plan = [](engine::PlanBuilder& build, const Layer& layer) {
        return HWY_DYNAMIC_DISPATCH(PlanRender)(build, layer);
      }};
}

}  // namespace e2lf::geometry
#endif
