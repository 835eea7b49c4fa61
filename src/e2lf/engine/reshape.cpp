// SPDX-License-Identifier: MIT
#include "e2lf/engine/reshape.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "e2lf/base/result.h"
#include "e2lf/engine/conv.h"

namespace e2lf::engine {
namespace {

using model::Op;

enum class Kind { kUnshuffle, kShuffle, kUpsample, kSum, kMean, kConcat };

constexpr std::pair<const char*, Kind> kKinds[] = {{Op::kPixelUnshuffle, Kind::kUnshuffle},
                                                   {Op::kPixelShuffle, Kind::kShuffle},
                                                   {Op::kUpsample, Kind::kUpsample},
                                                   {Op::kAdd, Kind::kSum},
                                                   {Op::kMean, Kind::kMean},
                                                   {Op::kConcat, Kind::kConcat}};

std::optional<Kind> kind_of(const model::Layer& layer) {
  const auto found = std::ranges::find(kKinds, layer.op, [](const auto& entry) { return entry.first; });
  return found == std::end(kKinds) ? std::nullopt : std::optional(found->second);
}

/// One block is one output row.
template <typename T>
class ReshapeKernel final : public Kernel {
 public:
  ReshapeKernel(const model::Layer& layer, std::vector<size_t> in_channels, size_t out_channels, bool phases_first)
      : name_(layer.op),
        kind_(*kind_of(layer)),
        stride_(layer.stride),
        relu_(layer.relu),
        phases_first_(phases_first),
        in_channels_(std::move(in_channels)),
        out_channels_(out_channels),
        factor_(kind_ == Kind::kMean ? 1.0F / static_cast<float>(in_channels_.size()) : 1.0F) {}

  std::string describe() const override { return name_; }

  Reach reach() const override {
    switch (kind_) {
      case Kind::kUnshuffle:
        return {0, 0, stride_, 1};
      case Kind::kShuffle:
      case Kind::kUpsample:
        return {0, 0, 1, stride_};
      default:
        return {};
    }
  }

  void run_block(const Strip& strip, size_t block, std::byte* /*scratch*/) const override {
    const size_t y = strip.begin + block;
    const size_t step = padded_channels(out_channels_);
    T* output = strip.output.row<T>(static_cast<ptrdiff_t>(y));
    for (size_t x = 0; x < strip.width; ++x) {
      T* pixel = output + x * step;
      fill(strip, y, x, pixel);
      std::fill(pixel + out_channels_, pixel + step, T{});
    }
    if (relu_) {
      for (size_t i = 0; i < strip.width * step; ++i) assign(std::max(to_float(output[i]), 0.0F), output[i]);
    }
  }

 private:
  const T* input(const Strip& strip, size_t index, size_t y, size_t x) const {
    return strip.inputs[index].row<T>(static_cast<ptrdiff_t>(y)) + x * padded_channels(in_channels_[index]);
  }

  void fill(const Strip& strip, size_t y, size_t x, T* pixel) const {
    const size_t s = stride_;
    switch (kind_) {
      case Kind::kUnshuffle:
        for (size_t phase = 0; phase < s * s; ++phase) {
          const T* from = input(strip, 0, y * s + phase / s, x * s + phase % s);
          for (size_t c = 0; c < in_channels_[0]; ++c) pixel[c * s * s + phase] = from[c];
        }
        return;
      case Kind::kShuffle: {
        const T* from = input(strip, 0, y / s, x / s);
        const size_t phase = y % s * s + x % s;
        if (phases_first_) {
          std::copy_n(from + phase * out_channels_, out_channels_, pixel);
        } else {
          for (size_t c = 0; c < out_channels_; ++c) pixel[c] = from[c * s * s + phase];
        }
        return;
      }
      case Kind::kUpsample:
        std::copy_n(input(strip, 0, y / s, x / s), out_channels_, pixel);
        return;
      case Kind::kConcat:
        for (size_t i = 0; i < in_channels_.size(); ++i) {
          pixel = std::copy_n(input(strip, i, y, x), in_channels_[i], pixel);
        }
        return;
      default:
        add(strip, y, x, pixel);
    }
  }

  void add(const Strip& strip, size_t y, size_t x, T* pixel) const {
    for (size_t c = 0; c < out_channels_; ++c) {
      float sum = 0.0F;
      for (size_t i = 0; i < in_channels_.size(); ++i) sum += to_float(input(strip, i, y, x)[c]);
      assign(sum * factor_, pixel[c]);
    }
  }

  std::string name_;
  Kind kind_;
  size_t stride_;
  bool relu_;
  bool phases_first_;
  std::vector<size_t> in_channels_;
  size_t out_channels_;
  float factor_;  ///< by which sums are multiplied
};

}  // namespace

bool is_reshape(const model::Layer& layer) {
  return kind_of(layer).has_value();
}

std::unique_ptr<Kernel> make_reshape(const model::Layer& layer, const std::vector<size_t>& in_channels,
                                     const TensorSpec& output, bool phases_first) {
  return with_element(output.type, [&](auto element) -> std::unique_ptr<Kernel> {
    return std::make_unique<ReshapeKernel<decltype(element)>>(layer, in_channels, output.channels, phases_first);
  });
}

}  // namespace e2lf::engine
