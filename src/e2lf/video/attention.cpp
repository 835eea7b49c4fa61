// SPDX-License-Identifier: MIT
// Attention between all pixels; see VideoOp::kAttention. The keys are processed in blocks with a running softmax, so
// that a thread needs memory for only a few queries and keys at any image size.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/engine/conv.h"
#include "e2lf/video/operations.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/video/attention.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/kernels/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::video {
namespace HWY_NAMESPACE {
namespace {

using namespace kernels::HWY_NAMESPACE;
using namespace engine;

// The number of queries of a block, which are the lanes of all vectors, and the number of keys at a time, chosen such
// that their scores stay in the first-level cache.
constexpr size_t kQueries = 64;
constexpr size_t kKeys = 8 * kGemmRows;

// The number of queries whose sums are held in registers at a time, and the number of value channels beside them.
constexpr size_t kQueryGroup = kGemmVectors * kLanes;
constexpr size_t kValueRows = 4;
static_assert(kQueries % kQueryGroup == 0);

/// Returns 2^x for x <= 0 with a relative error of at most 2e-7. Below 2^-125, it returns some small value.
HWY_INLINE FloatVec power_of_two(FloatVec x) {
  const FloatTag d;
  const hn::RebindToSigned<FloatTag> di;
  x = hn::Max(x, hn::Set(d, -125.0F));
  const auto whole = hn::NearestInt(x);
  const auto rest = hn::Sub(x, hn::ConvertTo(d, whole));
  // The polynomial of degree 5 that has the smallest relative error on [-1/2, 1/2] among those that are 1 at 0.
  auto y = hn::Set(d, 1.326472731e-3F);
  y = hn::MulAdd(y, rest, hn::Set(d, 9.671512991e-3F));
  y = hn::MulAdd(y, rest, hn::Set(d, 5.550733581e-2F));
  y = hn::MulAdd(y, rest, hn::Set(d, 2.402224243e-1F));
  y = hn::MulAdd(y, rest, hn::Set(d, 6.931470037e-1F));
  y = hn::MulAdd(y, rest, hn::Set(d, 1.0F));
  return hn::BitCast(d, hn::Add(hn::BitCast(di, y), hn::ShiftLeft<23>(whole)));
}

/// The memory of a thread for one block. `size` is the number of channels of a head. The queries are the columns of
/// everything except keys and values.
struct Scratch {
  float *queries, *sums;  ///< [size, kQueries]
  float *keys, *values;   ///< [kKeys, size]
  float* shares;          ///< [kKeys, kQueries]: first the scores, then their powers
  float *tops, *totals;   ///< [kQueries]: the largest score so far, and the sum of powers
  float* factors;         ///< [kQueries]: converts sums relative to the previous top to the new top

  static size_t floats(size_t size) { return (2 * size + kKeys + 3) * kQueries + 2 * kKeys * size; }

  Scratch(std::byte* memory, size_t size) {
    auto* next = reinterpret_cast<float*>(memory);
    const auto take = [&](size_t count) {
      float* const taken = next;
      next += count;
      return taken;
    };
    queries = take(size * kQueries);
    sums = take(size * kQueries);
    shares = take(kKeys * kQueries);
    tops = take(kQueries);
    totals = take(kQueries);
    factors = take(kQueries);
    keys = take(kKeys * size);
    values = take(kKeys * size);
  }
};

/// Computes attention. One block is one head of consecutive pixels of the strip.
template <class Element>
class AttentionKernel final : public Kernel {
 public:
  AttentionKernel(size_t channels, size_t heads)
      : channels_(channels), heads_(heads), size_(channels / heads), step_(padded_channels(channels)) {}

  std::string describe() const override {
    return "attention of " + std::to_string(heads_) + " heads " + hwy::TargetName(HWY_TARGET);
  }
  bool needs_all(size_t input) const override { return input > 0; }
  bool needs_whole_rows() const override { return true; }
  size_t scratch_bytes() const override { return Scratch::floats(size_) * sizeof(float); }
  size_t num_blocks(const Strip& strip) const override { return heads_ * blocks_per_head(strip); }

  void run_block(const Strip& strip, size_t block, std::byte* scratch) const override {
    const size_t head = block / blocks_per_head(strip);
    const size_t first = strip.begin * strip.width + block % blocks_per_head(strip) * kQueries;
    const size_t count = HWY_MIN(kQueries, strip.end * strip.width - first);
    const Scratch memory(scratch, size_);
    load_queries(strip, first, count, head, memory);
    std::fill_n(memory.sums, size_ * kQueries, 0.0F);
    std::fill_n(memory.totals, kQueries, 0.0F);
    std::fill_n(memory.tops, kQueries, std::numeric_limits<float>::lowest());
    const size_t pixels = strip.height * strip.width;
    for (size_t key = 0; key < pixels; key += kKeys) {
      const size_t keys = HWY_MIN(kKeys, pixels - key);
      load_pixels(strip.inputs[1], strip.width, key, keys, head, memory.keys);
      load_pixels(strip.inputs[2], strip.width, key, keys, head, memory.values);
      for (size_t query = 0; query < count; query += kQueryGroup) {
        score(keys, query, memory);
        for (size_t j = 0; j < kGemmVectors; ++j) weigh(keys, query + j * kLanes, memory);
        add_values(keys, query, memory);
      }
    }
    store(strip, first, count, head, memory);
  }

 private:
  size_t blocks_per_head(const Strip& strip) const {
    return ((strip.end - strip.begin) * strip.width + kQueries - 1) / kQueries;
  }

  /// Returns the channels of a head of a pixel, given its number in the image.
  template <class Pixel>
  HWY_INLINE Pixel* pixel(const Rows& rows, size_t width, size_t number, size_t head) const {
    return rows.row<Pixel>(static_cast<ptrdiff_t>(number / width)) + number % width * step_ + head * size_;
  }

  /// Transposes the queries and scales them such that scores are exponents of two.
  void load_queries(const Strip& strip, size_t first, size_t count, size_t head, const Scratch& to) const {
    constexpr double kLog2E = 1.4426950408889634;
    const auto scale = static_cast<float>(kLog2E / std::sqrt(static_cast<double>(size_)));
    std::fill_n(to.queries, size_ * kQueries, 0.0F);
    for (size_t i = 0; i < count; ++i) {
      const auto* from = pixel<const Element>(strip.inputs[0], strip.width, first + i, head);
      for (size_t c = 0; c < size_; ++c) to.queries[c * kQueries + i] = scale * to_float(from[c]);
    }
  }

  /// Gathers pixels, which are far apart in memory, so that they do not compete for the same cache sets.
  void load_pixels(const Rows& rows, size_t width, size_t first, size_t count, size_t head, float* to) const {
    for (size_t i = 0; i < count; ++i, to += size_) {
      const auto* from = pixel<const Element>(rows, width, first + i, head);
      for (size_t c = 0; c < size_; ++c) to[c] = to_float(from[c]);
    }
  }

  /// Computes scores. Those of keys after the last one are computed from undefined values and are not read.
  HWY_INLINE void score(size_t keys, size_t query, const Scratch& memory) const {
    for (size_t key = 0; key < keys; key += kGemmRows) {
      FloatVec sums[kGemmRows][kGemmVectors];
      clear(sums);
      multiply_accumulate<FloatProducts>(memory.keys + key * size_, size_, memory.queries + query, kQueries, size_,
                                         sums);
      E2LF_UNROLL
      for (size_t i = 0; i < kGemmRows; ++i) {
        E2LF_UNROLL
        for (size_t j = 0; j < kGemmVectors; ++j) {
          store_floats(sums[i][j], memory.shares + (key + i) * kQueries + query + j * kLanes);
        }
      }
    }
  }

  /// Converts scores to powers relative to the largest score so far.
  HWY_INLINE void weigh(size_t keys, size_t query, const Scratch& memory) const {
    float* const shares = memory.shares + query;
    const auto before = load_floats(memory.tops + query);
    auto top = before;
    for (size_t key = 0; key < keys; ++key) top = hn::Max(top, load_floats(shares + key * kQueries));
    const auto factor = power_of_two(hn::Sub(before, top));
    auto total = hn::Mul(load_floats(memory.totals + query), factor);
    for (size_t key = 0; key < keys; ++key) {
      const auto share = power_of_two(hn::Sub(load_floats(shares + key * kQueries), top));
      store_floats(share, shares + key * kQueries);
      total = hn::Add(total, share);
    }
    store_floats(top, memory.tops + query);
    store_floats(factor, memory.factors + query);
    store_floats(total, memory.totals + query);
  }

  HWY_INLINE void add_values(size_t keys, size_t query, const Scratch& memory) const {
    size_t c = 0;
    for (; c + kValueRows <= size_; c += kValueRows) add_value_rows<kValueRows>(keys, query, c, memory);
    for (; c < size_; ++c) add_value_rows<1>(keys, query, c, memory);
  }

  template <size_t kRows>
  HWY_INLINE void add_value_rows(size_t keys, size_t query, size_t c, const Scratch& memory) const {
    const FloatTag d;
    FloatVec sums[kRows][kGemmVectors];
    E2LF_UNROLL
    for (size_t j = 0; j < kGemmVectors; ++j) {
      const auto factor = load_floats(memory.factors + query + j * kLanes);
      E2LF_UNROLL
      for (size_t i = 0; i < kRows; ++i) {
        sums[i][j] = hn::Mul(load_floats(memory.sums + (c + i) * kQueries + query + j * kLanes), factor);
      }
    }
    const float* value = memory.values + c;
    const float* share = memory.shares + query;
    for (size_t key = 0; key < keys; ++key, value += size_, share += kQueries) {
      FloatVec shares[kGemmVectors];
      E2LF_UNROLL
      for (size_t j = 0; j < kGemmVectors; ++j) shares[j] = load_floats(share + j * kLanes);
      E2LF_UNROLL
      for (size_t i = 0; i < kRows; ++i) {
        const auto row = hn::Set(d, value[i]);
        E2LF_UNROLL
        for (size_t j = 0; j < kGemmVectors; ++j) sums[i][j] = hn::MulAdd(row, shares[j], sums[i][j]);
      }
    }
    E2LF_UNROLL
    for (size_t i = 0; i < kRows; ++i) {
      E2LF_UNROLL
      for (size_t j = 0; j < kGemmVectors; ++j) {
        store_floats(sums[i][j], memory.sums + (c + i) * kQueries + query + j * kLanes);
      }
    }
  }

  void store(const Strip& strip, size_t first, size_t count, size_t head, const Scratch& memory) const {
    for (size_t i = 0; i < count; ++i) {
      auto* to = pixel<Element>(strip.output, strip.width, first + i, head);
      const float scale = 1.0F / memory.totals[i];
      for (size_t c = 0; c < size_; ++c) assign(memory.sums[c * kQueries + i] * scale, to[c]);
      if (head + 1 == heads_) std::fill_n(to + size_, step_ - channels_, Element{});
    }
  }

  size_t channels_, heads_, size_, step_;
};

}  // namespace

Result<void> PlanAttention(PlanBuilder& build, const model::Layer& layer) {
  const TensorSpec& spec = build.spec(layer.name);
  build.add(layer, for_element(spec.type, [&](auto element) -> std::unique_ptr<Kernel> {
              return std::make_unique<AttentionKernel<decltype(element)>>(spec.channels, layer.integer("heads", 1));
            }));
  return {};
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::video
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::video {

using model::Layer, model::LayerShape;

HWY_EXPORT(PlanAttention);

namespace {

Result<LayerShape> attention_shape(const Layer& layer, std::span<const LayerShape> inputs) {
  const size_t channels = inputs[0].channels, heads = layer.integer("heads", 1);
  if (heads != 0 && channels % heads == 0) return model::equal_shapes(layer, inputs);
  return fail(ErrorCode::kInvalidValue, "", heads, " heads for ", channels,
              " channels; use a number that divides them");
}

}  // namespace

engine::Operation attention() {
  return {.model = {.name = VideoOp::kAttention,
                    .min_inputs = 3,
                    .max_inputs = 3,
                    .attributes = {"heads"},
                    .shape = attention_shape,
                    .reach = [](const Layer&) { return model::kWholeImage; }},
          .plan = [](engine::PlanBuilder& build, const Layer& layer) {
            return HWY_DYNAMIC_DISPATCH(PlanAttention)(build, layer);
          }};
}

}  // namespace e2lf::video
#endif
