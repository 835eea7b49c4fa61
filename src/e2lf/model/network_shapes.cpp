// SPDX-License-Identifier: MIT
// Implements infer_shapes() of network.h.
#include <algorithm>
#include <map>
#include <numeric>

#include "e2lf/base/text.h"
#include "e2lf/model/network.h"

namespace e2lf::model {
namespace {

// These bounds keep all products of sizes far from overflow, because files from other sources are checked here.
constexpr size_t kMaxChannels = size_t{1} << 16;
constexpr size_t kMaxKernel = 127;
constexpr size_t kMaxScale = 1024;

/// Infers the shape of one layer and returns the first problem found.
class LayerCheck {
 public:
  LayerCheck(const Layer& layer, const std::map<std::string, LayerShape>& known) : layer_(layer), known_(known) {}

  Result<LayerShape> infer() {
    E2LF_RETURN_IF_ERROR(check_name());
    E2LF_RETURN_IF_ERROR(find_inputs());
    E2LF_ASSIGN_OR_RETURN(const LayerShape shape, infer_output());
    if (shape.channels == 0 || shape.channels > kMaxChannels) {
      return invalid(cat(shape.channels, " channels; use 1 to ", kMaxChannels));
    }
    if (shape.scale > kMaxScale) return invalid(cat("a scale of ", shape.scale, "; use at most ", kMaxScale));
    E2LF_RETURN_IF_ERROR(check_residual(shape));
    return shape;
  }

 private:
  [[nodiscard]] Error invalid(const std::string& message) const {
    return {ErrorCode::kInvalidValue, message, location()};
  }
  [[nodiscard]] Error misfit(const std::string& message) const { return {ErrorCode::kShape, message, location()}; }
  [[nodiscard]] std::string location() const { return cat("layer \"", layer_.name, "\""); }

  [[nodiscard]] Result<void> check_name() const {
    if (layer_.name.empty()) return invalid("a layer without a name; give it one");
    if (known_.contains(layer_.name)) return invalid("the name is taken by an earlier layer; choose another one");
    return {};
  }

  [[nodiscard]] Result<LayerShape> find(const std::string& name) const {
    const auto found = known_.find(name);
    if (found != known_.end()) return found->second;
    std::vector<std::string> names;
    for (const auto& entry : known_) names.push_back(entry.first);
    return invalid(cat("no earlier layer is named \"", name, "\"; ", suggestion(name, names)));
  }

  Result<void> find_inputs() {
    for (const std::string& name : layer_.inputs) {
      E2LF_ASSIGN_OR_RETURN(const LayerShape shape, find(name));
      inputs_.push_back(shape);
    }
    const bool joins = layer_.op == Op::kAdd || layer_.op == Op::kMean || layer_.op == Op::kConcat;
    const size_t wanted = num_inputs();
    if (joins ? inputs_.size() < wanted : inputs_.size() != wanted) {
      return invalid(cat(inputs_.size(), " inputs; this operation takes ", wanted, joins ? " or more" : ""));
    }
    return {};
  }

  [[nodiscard]] size_t num_inputs() const {
    switch (layer_.op) {
      case Op::kPrevious:
        return 0;
      case Op::kAdd:
      case Op::kMean:
      case Op::kConcat:
      case Op::kDynamicFilter:
        return 2;
      case Op::kAttention:
        return 3;
      default:
        return 1;
    }
  }

  [[nodiscard]] Result<LayerShape> infer_output() const {
    const size_t stride = layer_.stride;
    if (stride == 0 || stride > kMaxScale) return invalid(cat("a stride of ", stride, "; use 1 to ", kMaxScale));
    if (layer_.op == Op::kPrevious) {
      E2LF_RETURN_IF_ERROR(check_plain());
      return LayerShape{layer_.out_channels, 1};
    }
    const LayerShape input = inputs_.front();
    switch (layer_.op) {
      case Op::kConv:
        E2LF_RETURN_IF_ERROR(check_conv_kernel());
        return LayerShape{layer_.out_channels, input.scale * stride};
      case Op::kConvTransposed:
        if (layer_.kernel != stride) return invalid("the stride is not the kernel; make them equal");
        return finer(layer_.out_channels);
      case Op::kPixelUnshuffle:
        return LayerShape{input.channels * stride * stride, input.scale * stride};
      case Op::kPixelShuffle:
        if (input.channels % (stride * stride) != 0) {
          return misfit(cat(input.channels, " channels do not divide by ", stride * stride, "; change the stride"));
        }
        return finer(input.channels / (stride * stride));
      case Op::kUpsample:
      case Op::kUpsampleBilinear:
        return finer(input.channels);
      case Op::kSigmoid:
        return input;
      case Op::kTanh:
      case Op::kLayerNorm:
      case Op::kPositionCode:
        E2LF_RETURN_IF_ERROR(check_plain());
        return input;
      case Op::kAttention:
        E2LF_RETURN_IF_ERROR(check_plain());
        return attended();
      case Op::kDynamicFilter:
        E2LF_RETURN_IF_ERROR(check_plain());
        return filtered();
      case Op::kPrevious:
        break;
      case Op::kConvGru:
      case Op::kConvLstm:
        E2LF_RETURN_IF_ERROR(check_cell());
        return LayerShape{layer_.out_channels, input.scale};
      case Op::kAdd:
      case Op::kMean:
      case Op::kConcat:
        return joined();
    }
    return invalid("an unknown operation; use a known one");
  }

  [[nodiscard]] Result<void> check_conv_kernel() const {
    if (layer_.kernel == 0 || layer_.kernel > kMaxKernel) {
      return invalid(cat("a kernel of ", layer_.kernel, "; use 1 to ", kMaxKernel));
    }
    if (layer_.kernel == layer_.stride && layer_.stride > 1) return {};
    if (layer_.kernel % 2 == 0) return invalid("an even kernel that is not the stride; use an odd one");
    if (layer_.kernel < layer_.stride) return invalid("a stride beyond the kernel; use a smaller one");
    return {};
  }

  [[nodiscard]] Result<void> check_cell() const {
    E2LF_RETURN_IF_ERROR(check_plain());
    // The gates have up to four times as many channels.
    if (layer_.out_channels > kMaxChannels / 4) {
      return invalid(cat(layer_.out_channels, " channels; use 1 to ", kMaxChannels / 4));
    }
    return check_conv_kernel();
  }

  [[nodiscard]] Result<void> check_plain() const {
    if (layer_.stride != 1) return invalid("this operation with a stride; use stride 1");
    if (layer_.relu) return invalid("this operation with ReLU; leave it out");
    return {};
  }

  [[nodiscard]] Result<LayerShape> filtered() const {
    E2LF_RETURN_IF_ERROR(check_conv_kernel());
    const LayerShape input = inputs_[0], filters = inputs_[1];
    const size_t taps = layer_.kernel * layer_.kernel;
    if (filters.scale == input.scale && filters.channels % taps == 0) {
      return LayerShape{filters.channels / taps * input.channels, input.scale};
    }
    return misfit(cat("filters of ", filters.channels, " channels at scale ", filters.scale, ", not of a multiple of ",
                      taps, " at ", input.scale, "; make as many as the kernel has taps, of the same resolution"));
  }

  [[nodiscard]] Result<LayerShape> attended() const {
    const size_t channels = inputs_.front().channels;
    if (layer_.heads == 0 || channels % layer_.heads != 0) {
      return invalid(cat(layer_.heads, " heads for ", channels, " channels; use a number that divides them"));
    }
    return joined();
  }

  [[nodiscard]] Result<LayerShape> finer(size_t channels) const {
    const size_t scale = inputs_.front().scale;
    if (scale % layer_.stride != 0) {
      return misfit(cat("a scale of ", scale, " does not divide by ", layer_.stride, "; reduce the resolution before"));
    }
    return LayerShape{channels, scale / layer_.stride};
  }

  [[nodiscard]] Result<LayerShape> joined() const {
    LayerShape shape = inputs_.front();
    for (size_t i = 1; i < inputs_.size(); ++i) {
      if (inputs_[i].scale != shape.scale || (layer_.op != Op::kConcat && inputs_[i].channels != shape.channels)) {
        return misfit(cat("input \"", layer_.inputs[i], "\" has ", inputs_[i].channels, " channels at scale ",
                          inputs_[i].scale, ", the first one ", shape.channels, " at ", shape.scale,
                          "; make them equal"));
      }
      if (layer_.op == Op::kConcat) shape.channels += inputs_[i].channels;
    }
    return shape;
  }

  [[nodiscard]] Result<void> check_residual(const LayerShape& shape) const {
    if (layer_.residual.empty()) return {};
    if (layer_.op != Op::kConv) return invalid("a residual at another operation than conv; use an add layer");
    E2LF_ASSIGN_OR_RETURN(const LayerShape residual, find(layer_.residual));
    if (residual.channels == shape.channels && residual.scale == shape.scale) return {};
    return misfit(cat("the residual has ", residual.channels, " channels at scale ", residual.scale, ", the output ",
                      shape.channels, " at ", shape.scale, "; make them equal"));
  }

  const Layer& layer_;
  const std::map<std::string, LayerShape>& known_;
  std::vector<LayerShape> inputs_;
};

/// Checks that the output that is fed back to the next frame has the shape that kPrevious states.
Result<void> check_feedback(const Network& network, const LayerShape& output) {
  for (const Layer& layer : network.layers) {
    if (layer.op != Op::kPrevious) continue;
    const std::string location = cat("layer \"", layer.name, "\"");
    if (&layer == &network.layers.back()) {
      return Error{ErrorCode::kInvalidValue, "the last layer would be its own past; add a layer", location};
    }
    if (output.channels == layer.out_channels && output.scale == 1) continue;
    return Error{ErrorCode::kShape,
                 cat(layer.out_channels, " channels, the last layer has ", output.channels, " at scale ", output.scale,
                     "; make them equal at scale 1"),
                 location};
  }
  return {};
}

}  // namespace

Result<std::vector<LayerShape>> infer_shapes(const Network& network) {
  if (network.input_channels == 0 || network.input_channels > kMaxChannels) {
    return Error{ErrorCode::kInvalidValue, cat(network.input_channels, " input channels; use 1 to ", kMaxChannels),
                 "input_channels"};
  }
  if (network.layers.empty()) return Error{ErrorCode::kInvalidValue, "no layers; give at least one", "layers"};
  std::map<std::string, LayerShape> known = {{"input", {network.input_channels, 1}}};
  std::vector<LayerShape> shapes;
  size_t multiple = 1;
  for (const Layer& layer : network.layers) {
    E2LF_ASSIGN_OR_RETURN(const LayerShape shape, LayerCheck(layer, known).infer());
    multiple = std::lcm(multiple, shape.scale);
    if (multiple > kMaxScale) {
      return Error{ErrorCode::kInvalidValue,
                   cat("images would have to be multiples of ", multiple, " pixels; use at most ", kMaxScale),
                   cat("layer \"", layer.name, "\"")};
    }
    known.emplace(layer.name, shape);
    shapes.push_back(shape);
  }
  E2LF_RETURN_IF_ERROR(check_feedback(network, shapes.back()));
  return shapes;
}

size_t size_multiple(const Network& network) {
  size_t multiple = 1;
  for (const LayerShape& shape : infer_shapes(network).value()) multiple = std::lcm(multiple, shape.scale);
  return multiple;
}

}  // namespace e2lf::model
