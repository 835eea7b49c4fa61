// SPDX-License-Identifier: MIT
// Pictures moved to the reference view by a disparity of each pixel; see GeometryOp::kWarp.
#include <utility>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/geometry/operations.h"
#include "e2lf/geometry/shift.h"
#include "e2lf/model/onnx/onnx_export.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/geometry/warp.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/geometry/planar-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::geometry {
namespace HWY_NAMESPACE {
namespace {

/// Two neighbours along an axis and the weight of the second one.
struct Between {
  ptrdiff_t first, second;
  float weight;
};

HWY_INLINE Between neighbours(float place, size_t size) {
  const auto last = static_cast<float>(size - 1);
  place = HWY_MIN(HWY_MAX(place, 0.0F), last);
  const auto first = static_cast<ptrdiff_t>(place);
  return {first, HWY_MIN(first + 1, static_cast<ptrdiff_t>(size) - 1), place - static_cast<float>(first)};
}

/// Inputs are planes of float32: the pictures, and the disparity. One block is one chunk.
template <class Element>
class WarpKernel final : public Kernel {
 public:
  WarpKernel(Warp warp, size_t channels) : warp_(std::move(warp)), channels_(channels) {}

  std::string describe() const override { return "pictures moved by a disparity"; }
  Reach reach() const override { return {warp_.reach, warp_.reach, 1, 1}; }
  size_t scratch_bytes() const override { return channels_ * kChunk * sizeof(float); }
  size_t num_blocks(const Strip& strip) const override { return (strip.end - strip.begin) * chunks_of(strip); }

  void run_block(const Strip& strip, size_t block, std::byte* scratch) const override {
    const Chunk chunk(strip, block);
    auto* const moved = reinterpret_cast<float*>(scratch);
    for (size_t p = 0; p < warp_.pictures(); ++p) move_picture(strip, chunk, p, moved);
    store_pixels(moved, channels_, chunk, strip.output.row<Element>(chunk.y));
  }

 private:
  /// Moves the features of a picture, which are pictures() channels apart.
  void move_picture(const Strip& strip, const Chunk& chunk, size_t p, float* moved) const {
    const float* const disparity = strip.inputs[1].row<const float>(chunk.y) + chunk.begin;
    const auto row = static_cast<float>(warp_.offsets[2 * p]), column = static_cast<float>(warp_.offsets[2 * p + 1]);
    for (size_t x = 0; x < chunk.count; ++x) {
      const float d = HWY_MIN(HWY_MAX(disparity[x], warp_.least), warp_.most);
      const Between down = neighbours(static_cast<float>(chunk.y) + row * d, strip.height);
      const Between across = neighbours(static_cast<float>(chunk.begin + x) + column * d, chunk.width);
      for (size_t c = p; c < channels_; c += warp_.pictures()) {
        const auto read = [&](ptrdiff_t y) {
          const float* const line = strip.inputs[0].row<const float>(y) + c * chunk.width;
          return line[across.first] + across.weight * (line[across.second] - line[across.first]);
        };
        const float above = read(down.first);
        moved[c * kChunk + x] = above + down.weight * (read(down.second) - above);
      }
    }
  }

  Warp warp_;
  size_t channels_;
};

}  // namespace

Result<void> PlanWarp(PlanBuilder& build, const model::Layer& layer) {
  const TensorSpec& output = build.spec(layer.name);
  std::vector<size_t> planes;
  for (const std::string& name : layer.inputs) {
    const TensorSpec input = build.spec(name);
    planes.push_back(build.add_part(cat(layer.name, ".", name), make_planar(input.channels, 0, input.type),
                                    {build.tensor(name)}, {input.channels, input.scale, ElementType::kFloat32}));
  }
  auto moved = for_element(output.type, [&](auto element) -> std::unique_ptr<Kernel> {
    return std::make_unique<WarpKernel<decltype(element)>>(Warp(layer), output.channels);
  });
  build.set_result(layer, build.add_part(layer.name, std::move(moved), std::move(planes), output));
  return {};
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::geometry
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::geometry {

using model::Layer, model::LayerShape;

HWY_EXPORT(PlanWarp);

namespace {

Result<LayerShape> warp_shape(const Layer& layer, std::span<const LayerShape> inputs) {
  const std::vector<double> offsets = numbers(layer, "offsets"), range = numbers(layer, "disparities");
  E2LF_RETURN_IF_ERROR(check_shifts(offsets, range));
  if (range.size() != 2 || range[0] > range[1]) {
    return fail(ErrorCode::kInvalidValue, "", "expected the least and the largest disparity; give both");
  }
  if (offsets.size() % 2 != 0 || inputs[0].channels % (offsets.size() / 2) != 0) {
    return fail(ErrorCode::kShape, "", offsets.size(), " offsets for ", inputs[0].channels,
                " channels; give a row and a column for each picture, of which each has as many features");
  }
  if (inputs[0].scale == inputs[1].scale) return inputs[0];
  return fail(ErrorCode::kShape, "", "the pictures and the disparity have different sizes; use the same");
}

/// Adds where the pictures are read along an axis, [batch, picture, y, x, 1], from -1 to 1.
std::string add_places(model::OnnxCall& call, const std::string& disparity, size_t axis, const std::string& name) {
  model::OnnxGraph& graph = call.graph;
  const Warp warp(call.layer);
  const std::vector<size_t> shape = {1, warp.pictures(), 1, 1};
  std::vector<float> offsets;
  for (size_t p = 0; p < warp.pictures(); ++p) offsets.push_back(static_cast<float>(warp.offsets[2 * p + axis]));
  const std::string by = graph.add_constant(name + "/offsets", shape, offsets);
  const std::string shift = graph.add_node("Mul", {disparity, by}, name + "/shift");
  // The numbers of the rows or columns are running sums of ones.
  const std::string zero = graph.add_node("Sub", {disparity, disparity}, name + "/zero");
  const std::string ones = graph.add_node("Exp", {zero}, name + "/ones");
  const std::string along = graph.add_constant(name + "/axis", model::Integers{static_cast<int64_t>(2 + axis)});
  const std::string number = graph.add_node("CumSum", {ones, along}, name + "/number", {{"exclusive", int64_t{1}}});
  const std::string last = graph.add_node("ReduceMax", {number}, name + "/last",
                                          {{"axes", model::Integers{2, 3}}, {"keepdims", int64_t{1}}});
  const std::string place = graph.add_node("Add", {number, shift}, name + "/place");
  const std::string half = graph.add_constant(name + "/half", 0.5F), one = graph.add_constant(name + "/one", 1.0F);
  const std::string span = graph.add_node("Mul", {last, half}, name + "/span");
  const std::string relative = graph.add_node("Div", {place, span}, name + "/relative");
  const std::string centred = graph.add_node("Sub", {relative, one}, name + "/centred");
  const std::string at = graph.add_constant(name + "/at", model::Integers{4});
  return graph.add_node("Unsqueeze", {centred, at}, name);
}

std::string export_warp(model::OnnxCall& call) {
  model::OnnxGraph& graph = call.graph;
  const Warp warp(call.layer);
  const std::string name = "moved/" + call.layer.name;
  const size_t pictures = warp.pictures();
  const std::string map = call.slice(call.inputs[1], 0, 1, name + "/map");
  const std::string least = graph.add_constant(name + "/least", warp.least);
  const std::string most = graph.add_constant(name + "/most", warp.most);
  const std::string disparity = graph.add_node("Clip", {map, least, most}, name + "/disparity");
  const std::string down = add_places(call, disparity, 0, name + "/down");
  const std::string across = add_places(call, disparity, 1, name + "/across");
  const std::string places = graph.add_node("Concat", {across, down}, name + "/places", {{"axis", int64_t{4}}});
  std::vector<std::string> moved;
  for (size_t c = 0; c < call.input_shapes[0].channels; ++c) {
    const std::string own = cat(name, "/", c);
    const std::string picture = call.slice(call.inputs[0], c, c + 1, own + "/picture");
    const std::string grid = call.slice(places, c % pictures, c % pictures + 1, own + "/grid");
    const std::string axis = graph.add_constant(own + "/axis", model::Integers{1});
    const std::string flat = graph.add_node("Squeeze", {grid, axis}, own + "/places");
    moved.push_back(graph.add_node(
        "GridSample", {picture, flat}, own,
        {{"align_corners", int64_t{1}}, {"mode", std::string("bilinear")}, {"padding_mode", std::string("border")}}));
  }
  return graph.add_node("Concat", moved, call.output, {{"axis", int64_t{1}}});
}

}  // namespace

engine::Operation warp() {
  return {
      .model = {.name = GeometryOp::kWarp,
                .min_inputs = 2,
                .max_inputs = 2,
                .attributes = {"offsets", "disparities"},
                .shape = warp_shape,
                .macs = [](const Layer&,
                           std::span<const LayerShape> inputs) { return 4 * static_cast<double>(inputs[0].channels); },
                .reach = [](const Layer& layer) { return Warp(layer).reach; },
                .onnx = export_warp},
      .plan = [](engine::PlanBuilder& build, const Layer& layer) {
        return HWY_DYNAMIC_DISPATCH(PlanWarp)(build, layer);
      }};
}

}  // namespace e2lf::geometry
#endif
