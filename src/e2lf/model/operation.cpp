// SPDX-License-Identifier: MIT
#include "e2lf/model/operation.h"

#include <algorithm>
#include <list>
#include <map>
#include <mutex>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/model/onnx/onnx_export.h"

namespace e2lf::model {
namespace {

using Inputs = std::span<const LayerShape>;

Error invalid(const std::string& message) {
  return fail(ErrorCode::kInvalidValue, "", message);
}

Error misfit(const std::string& message) {
  return fail(ErrorCode::kShape, "", message);
}

// How operations export themselves.

std::string add_convolution(OnnxCall& call) {
  const Layer& layer = call.layer;
  const auto kernel = static_cast<int64_t>(layer.kernel), stride = static_cast<int64_t>(layer.stride);
  OnnxGraph::Attributes attributes = {{"kernel_shape", Integers{kernel, kernel}},
                                      {"strides", Integers{stride, stride}}};
  call.inputs.push_back("weights/" + layer.name + ".weight");
  call.inputs.push_back("weights/" + layer.name + ".bias");
  if (layer.op == Op::kConvTransposed) return call.node("ConvTranspose", attributes);
  attributes.emplace_back("pads", Integers(4, kernel == stride ? 0 : kernel / 2));
  return call.node("Conv", attributes);
}

/// ONNX orders the result with pixels of a block before channels, whereas Op::kPixelUnshuffle has channels first.
std::string add_unshuffle(OnnxCall& call) {
  const size_t channels = call.input_shapes.front().channels, area = call.layer.stride * call.layer.stride;
  Integers order;
  for (size_t c = 0; c < channels; ++c) {
    for (size_t pixel = 0; pixel < area; ++pixel) order.push_back(static_cast<int64_t>(pixel * channels + c));
  }
  const std::string blocks = call.graph.add_node("SpaceToDepth", call.inputs, "blocks/" + call.layer.name,
                                                 {{"blocksize", static_cast<int64_t>(call.layer.stride)}});
  const std::string indices = call.graph.add_constant("orders/" + call.layer.name, order);
  return call.graph.add_node("Gather", {blocks, indices}, call.output, {{"axis", int64_t{1}}});
}

std::string add_shuffle(OnnxCall& call) {
  return call.node("DepthToSpace",
                   {{"blocksize", static_cast<int64_t>(call.layer.stride)}, {"mode", std::string("CRD")}});
}

std::string add_upsampling(OnnxCall& call) {
  return call.resize({{"mode", std::string("nearest")},
                      {"coordinate_transformation_mode", std::string("asymmetric")},
                      {"nearest_mode", std::string("floor")}});
}

// The operations.

Operation conv() {
  return {.name = Op::kConv,
          .takes_stride_and_relu = true,
          .shape = [](const Layer& layer, Inputs inputs) -> Result<LayerShape> {
            E2LF_RETURN_IF_ERROR(check_kernel(layer));
            return LayerShape{layer.out_channels, inputs[0].scale * layer.stride};
          },
          .weights =
              [](const Layer& layer, Inputs inputs) {
                return conv_weights(layer.name, layer.out_channels, inputs[0].channels, layer.kernel);
              },
          // Kernels that are larger than the stride are centred on the first pixel of the output's block.
          .reach =
              [](const Layer& layer) { return layer.kernel == layer.stride ? 0 : layer.kernel / 2 + layer.stride - 1; },
          .onnx = add_convolution};
}

Operation conv_transposed() {
  return {.name = Op::kConvTransposed,
          .takes_stride_and_relu = true,
          .shape = [](const Layer& layer, Inputs inputs) -> Result<LayerShape> {
            if (layer.kernel != layer.stride)
              return invalid("the stride must be equal to the kernel; correct one of them");
            return finer_shape(layer, inputs, layer.out_channels);
          },
          .weights =
              [](const Layer& layer, Inputs inputs) {
                auto tensors = conv_weights(layer.name, inputs[0].channels, layer.out_channels, layer.kernel);
                tensors[1].shape = {layer.out_channels};
                return tensors;
              },
          // Each output pixel is the product of one input pixel.
          .macs = [](const Layer& layer,
                     Inputs inputs) { return static_cast<double>(layer.out_channels * inputs[0].channels); },
          .onnx = add_convolution};
}

Operation pixel_unshuffle() {
  return {.name = Op::kPixelUnshuffle,
          .takes_stride_and_relu = true,
          .shape = [](const Layer& layer, Inputs inputs) -> Result<LayerShape> {
            return LayerShape{inputs[0].channels * layer.stride * layer.stride, inputs[0].scale * layer.stride};
          },
          .onnx = add_unshuffle};
}

Operation pixel_shuffle() {
  return {.name = Op::kPixelShuffle,
          .takes_stride_and_relu = true,
          .shape = [](const Layer& layer, Inputs inputs) -> Result<LayerShape> {
            const size_t area = layer.stride * layer.stride;
            if (inputs[0].channels % area == 0) return finer_shape(layer, inputs, inputs[0].channels / area);
            return misfit(cat(inputs[0].channels, " channels are not a multiple of ", area, "; change the stride"));
          },
          .onnx = add_shuffle};
}

Operation upsample() {
  return {.name = Op::kUpsample,
          .takes_stride_and_relu = true,
          .shape = [](const Layer& layer, Inputs inputs) { return finer_shape(layer, inputs, inputs[0].channels); },
          .onnx = add_upsampling};
}

Operation sum() {
  return {.name = Op::kAdd,
          .min_inputs = 2,
          .max_inputs = kAnyInputs,
          .takes_stride_and_relu = true,
          .shape = equal_shapes,
          .onnx = [](OnnxCall& call) { return call.node("Sum"); }};
}

Operation mean() {
  Operation operation = sum();
  operation.name = Op::kMean;
  operation.onnx = [](OnnxCall& call) { return call.node("Mean"); };
  return operation;
}

Operation concat() {
  return {.name = Op::kConcat,
          .min_inputs = 2,
          .max_inputs = kAnyInputs,
          .takes_stride_and_relu = true,
          .shape = [](const Layer& layer, Inputs inputs) -> Result<LayerShape> {
            LayerShape shape{0, inputs[0].scale};
            for (size_t i = 0; i < inputs.size(); ++i) {
              shape.channels += inputs[i].channels;
              if (inputs[i].scale != shape.scale) {
                return misfit(cat("input \"", layer.inputs[i], "\" is at scale ", inputs[i].scale,
                                  ", but the first one is at ", shape.scale, "; make them equal"));
              }
            }
            return shape;
          },
          .onnx =
              [](OnnxCall& call) {
                return call.node("Concat", {{"axis", int64_t{1}}});
              }};
}

Operation sigmoid() {
  return {.name = Op::kSigmoid, .shape = equal_shapes, .onnx = [](OnnxCall& call) { return call.node("Sigmoid"); }};
}

/// The components whose add_operations() adds operations, for messages.
const std::map<std::string, std::vector<std::string>> kOfComponents = {
    {"geometry", {"plane-sweep", "render-layers", "warp"}},
    {"video",
     {"tanh", "upsample-bilinear", "dynamic-filter", "layer-norm", "position-code", "attention", "previous", "conv-gru",
      "conv-lstm"}}};

/// The operations of this process. Pointers to the elements of a list stay valid.
struct Registry {
  std::mutex mutex;
  std::list<Operation> operations = {conv(), conv_transposed(), pixel_unshuffle(), pixel_shuffle(), upsample(), sum(),
                                     mean(), concat(),          sigmoid()};
};

Registry& registry() {
  static Registry instance;
  return instance;
}

}  // namespace

void add_operation(Operation operation) {
  E2LF_REQUIRE(operation.shape != nullptr, "an operation has a shape");
  E2LF_REQUIRE(find_operation(operation.name) == nullptr, cat("there is an operation \"", operation.name, "\""));
  const std::scoped_lock lock(registry().mutex);
  registry().operations.push_back(std::move(operation));
}

const Operation* find_operation(const std::string& name) {
  const std::scoped_lock lock(registry().mutex);
  const auto& all = registry().operations;
  const auto found = std::find_if(all.begin(), all.end(), [&](const Operation& each) { return each.name == name; });
  return found == all.end() ? nullptr : &*found;
}

Error unknown_operation(const std::string& name, const std::string& location) {
  for (const auto& [component, operations] : kOfComponents) {
    if (std::ranges::find(operations, name) == operations.end()) continue;
    return fail(ErrorCode::kUnsupported, location, "the program has not added the operation \"", name,
                "\"; link the component e2lf::", component, " and call e2lf::", component,
                "::add_operations() before it reads the model");
  }
  const std::scoped_lock lock(registry().mutex);
  std::vector<std::string> known;
  for (const Operation& each : registry().operations) known.push_back(each.name);
  return fail(ErrorCode::kUnsupported, location, "unknown operation \"", name, "\"; known are ", join(known));
}

Result<void> check_kernel(const Layer& layer) {
  if (layer.kernel == 0 || layer.kernel > kMaxKernel) {
    return invalid(cat("the kernel ", layer.kernel, " is out of range; use 1 to ", kMaxKernel));
  }
  if (layer.kernel == layer.stride && layer.stride > 1) return {};
  if (layer.kernel % 2 == 0) return invalid("an even kernel must be equal to the stride; use an odd kernel");
  if (layer.kernel < layer.stride) return invalid("the stride exceeds the kernel; use a smaller stride");
  return {};
}

Result<LayerShape> equal_shapes(const Layer& layer, Inputs inputs) {
  const LayerShape first = inputs[0];
  for (size_t i = 1; i < inputs.size(); ++i) {
    if (inputs[i].scale == first.scale && inputs[i].channels == first.channels) continue;
    return misfit(cat("input \"", layer.inputs[i], "\" has ", inputs[i].channels, " channels at scale ",
                      inputs[i].scale, ", but the first one has ", first.channels, " at ", first.scale,
                      "; make them equal"));
  }
  return first;
}

Result<LayerShape> finer_shape(const Layer& layer, Inputs inputs, size_t channels) {
  const size_t scale = inputs[0].scale;
  if (scale % layer.stride == 0) return LayerShape{channels, scale / layer.stride};
  return misfit(
      cat("the scale ", scale, " is not a multiple of the stride ", layer.stride, "; reduce the resolution first"));
}

std::vector<WeightShape> conv_weights(const std::string& name, size_t out, size_t in, size_t kernel) {
  return {{name + ".weight", {out, in, kernel, kernel}}, {name + ".bias", {out}}};
}

}  // namespace e2lf::model
