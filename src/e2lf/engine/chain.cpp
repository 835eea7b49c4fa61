// SPDX-License-Identifier: MIT
#include <algorithm>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/engine/conv.h"

namespace e2lf::engine {
namespace {

// The number of columns of a strip that one block computes; with 8 rows, these are two blocks of Winograd tiles.
constexpr size_t kBlockColumns = 48;

/// Half-open ranges of pixels.
struct Region {
  size_t y_begin = 0, y_end = 0, x_begin = 0, x_end = 0;

  [[nodiscard]] bool empty() const { return y_begin >= y_end || x_begin >= x_end; }
  [[nodiscard]] size_t height() const { return y_end - y_begin; }
  [[nodiscard]] size_t width() const { return x_end - x_begin; }
};

/// The taps and bias of `second` after `first`, in double precision.
struct Map {
  size_t in = 0, out = 0, kernel = 1;
  std::vector<double> weight, bias;
};

Map compose_two(const Map& first, const ConvSpec& second) {
  Map map{first.in, second.out_channels, first.kernel + second.kernel - 1, {}, {}};
  map.weight.assign(map.out * map.in * map.kernel * map.kernel, 0.0);
  map.bias.assign(second.bias.begin(), second.bias.end());
  const size_t k = first.kernel;
  for (size_t out = 0; out < map.out; ++out) {
    for (size_t mid = 0; mid < first.out; ++mid) {
      for (size_t tap = 0; tap < second.kernel * second.kernel; ++tap) {
        const size_t dy = tap / second.kernel;
        const size_t dx = tap % second.kernel;
        const double scale = second.tap(out, mid, dy, dx);
        map.bias[out] += scale * first.bias[mid];
        for (size_t row = 0; row < first.in * k; ++row) {
          const double* from = &first.weight[(mid * first.in * k + row) * k];
          double* to = &map.weight[((out * map.in + row / k) * map.kernel + row % k + dy) * map.kernel + dx];
          for (size_t x = 0; x < k; ++x) to[x] += scale * from[x];
        }
      }
    }
  }
  return map;
}

/// The rows of a tensor shifted horizontally: x = 0 refers to pixel `x`.
class ShiftedRows {
 public:
  ShiftedRows(const Rows& rows, ptrdiff_t begin, ptrdiff_t end, size_t x, size_t pixel_bytes) : first_(begin) {
    for (ptrdiff_t y = begin; y < end; ++y) pointers_.push_back(rows.row<std::byte>(y) + x * pixel_bytes);
  }
  [[nodiscard]] Rows rows() const { return {pointers_.data(), first_}; }

 private:
  std::vector<std::byte*> pointers_;
  ptrdiff_t first_;
};

size_t input_pixel_bytes(const ConvSpec& spec) {
  return padded_channels(spec.in_channels) * element_size(spec.compute);
}

size_t output_pixel_bytes(const ConvSpec& spec) {
  return padded_channels(spec.out_channels) * element_size(spec.output);
}

void run_all(const Kernel& kernel, const Strip& strip, std::byte* scratch) {
  for (size_t block = 0; block < kernel.num_blocks(strip); ++block) kernel.run_block(strip, block, scratch);
}

class ChainKernel final : public Kernel {
 public:
  explicit ChainKernel(const std::vector<ConvSpec>& chain)
      : chain_(chain), frame_(frame_width(chain)), inner_(make_conv(compose(chain))) {
    for (ConvSpec& spec : chain_) {
      layers_.push_back(make_direct(spec));
      spec.weight = {};  // it is packed in the kernel
    }
  }

  std::string describe() const override {
    return cat(chain_.size(), " layers composed: ", inner_->describe(), "; ", frame_,
               " pixels at the border one by one");
  }

  Reach reach() const override { return inner_->reach(); }

  size_t scratch_bytes() const override { return inner_->scratch_bytes(); }

  size_t num_blocks(const Strip& strip) const override { return (strip.width + kBlockColumns - 1) / kBlockColumns; }

  void run_block(const Strip& strip, size_t block, std::byte* scratch) const override {
    const size_t begin = block * kBlockColumns;
    const Region all{strip.begin, strip.end, begin, std::min(strip.width, begin + kBlockColumns)};
    run_inner(strip, all, scratch);
    const size_t bottom = strip.height > frame_ ? strip.height - frame_ : 0;
    const size_t right = strip.width > frame_ ? strip.width - frame_ : 0;
    // The parts of the frame in this block: rows at the top and bottom, and columns at the sides of the rows in
    // between.
    const Region top{all.y_begin, std::min(all.y_end, frame_), all.x_begin, all.x_end};
    const Region below{std::max({all.y_begin, bottom, frame_}), all.y_end, all.x_begin, all.x_end};
    const size_t y_begin = std::max(all.y_begin, frame_);
    const size_t y_end = std::min(all.y_end, bottom);
    const Region left{y_begin, y_end, all.x_begin, std::min(all.x_end, frame_)};
    const Region beside{y_begin, y_end, std::max({all.x_begin, right, frame_}), all.x_end};
    for (const Region& part : {top, below, left, beside}) {
      if (!part.empty()) run_layers(strip, part);
    }
  }

 private:
  void run_inner(const Strip& strip, const Region& region, std::byte* scratch) const {
    const Reach reach = inner_->reach();
    const auto begin = static_cast<ptrdiff_t>(region.y_begin);
    const auto end = static_cast<ptrdiff_t>(round_up(region.y_end, kTileSize));
    const ShiftedRows input(strip.inputs[0], begin - static_cast<ptrdiff_t>(reach.before),
                            end + static_cast<ptrdiff_t>(reach.after), region.x_begin,
                            input_pixel_bytes(chain_.front()));
    const ShiftedRows output(strip.output, begin, static_cast<ptrdiff_t>(region.y_end), region.x_begin,
                             output_pixel_bytes(chain_.back()));
    run_all(*inner_, part_of(strip, region, input.rows(), output.rows()), scratch);
  }

  static Strip part_of(const Strip& strip, const Region& region, const Rows& input, const Rows& output) {
    Strip part;
    part.inputs = {input};
    part.output = output;
    part.begin = region.y_begin;
    part.end = region.y_end;
    part.width = region.width();
    part.height = strip.height;
    return part;
  }

  /// Returns the region that layer `layer` must compute for the outputs of the chain in `region`.
  Region needed(const Strip& strip, const Region& region, size_t layer) const {
    size_t radius = 0;
    for (size_t i = layer + 1; i < chain_.size(); ++i) radius += chain_[i].kernel / 2;
    return {region.y_begin > radius ? region.y_begin - radius : 0, std::min(strip.height, region.y_end + radius),
            region.x_begin > radius ? region.x_begin - radius : 0, std::min(strip.width, region.x_end + radius)};
  }

  void run_layers(const Strip& strip, const Region& region) const {
    AlignedBuffer previous;
    Rows input = strip.inputs[0];
    size_t input_x = 0;  // the column at which `input` begins
    std::vector<std::byte*> pointers;
    for (size_t i = 0; i < chain_.size(); ++i) {
      const Region own = needed(strip, region, i);
      const auto radius = static_cast<ptrdiff_t>(chain_[i].kernel / 2);
      const ShiftedRows shifted(input, static_cast<ptrdiff_t>(own.y_begin) - radius,
                                static_cast<ptrdiff_t>(own.y_end) + radius, own.x_begin - input_x,
                                input_pixel_bytes(chain_[i]));
      if (i + 1 == chain_.size()) {
        const ShiftedRows output(strip.output, static_cast<ptrdiff_t>(own.y_begin), static_cast<ptrdiff_t>(own.y_end),
                                 own.x_begin, output_pixel_bytes(chain_[i]));
        run_all(*layers_[i], part_of(strip, own, shifted.rows(), output.rows()), nullptr);
        return;
      }
      // The result is surrounded by zeros as far as the next layer reads.
      const size_t margin = chain_[i + 1].kernel / 2;
      const size_t pixel_bytes = output_pixel_bytes(chain_[i]);
      const size_t row_bytes = (own.width() + 2 * margin + kReadAhead) * pixel_bytes;
      AlignedBuffer result((own.height() + 2 * margin) * row_bytes);
      pointers.clear();
      for (size_t y = 0; y < own.height() + 2 * margin; ++y) {
        pointers.push_back(result.data() + y * row_bytes + margin * pixel_bytes);
      }
      const Rows output{pointers.data(), static_cast<ptrdiff_t>(own.y_begin) - static_cast<ptrdiff_t>(margin)};
      run_all(*layers_[i], part_of(strip, own, shifted.rows(), output), nullptr);
      previous = std::move(result);
      input = output;
      input_x = own.x_begin;
    }
  }

  std::vector<ConvSpec> chain_;
  size_t frame_;
  std::unique_ptr<Kernel> inner_;
  std::vector<std::unique_ptr<Kernel>> layers_;
};

}  // namespace

ConvSpec compose(const std::vector<ConvSpec>& chain) {
  const ConvSpec& first = chain.front();
  Map map{first.in_channels,
          first.out_channels,
          first.kernel,
          {first.weight.begin(), first.weight.end()},
          {first.bias.begin(), first.bias.end()}};
  for (size_t i = 1; i < chain.size(); ++i) map = compose_two(map, chain[i]);
  ConvSpec result = chain.back();
  result.in_channels = map.in;
  result.kernel = map.kernel;
  result.weight.assign(map.weight.begin(), map.weight.end());
  result.bias.assign(map.bias.begin(), map.bias.end());
  return result;
}

size_t frame_width(const std::vector<ConvSpec>& chain) {
  size_t width = 0;
  for (size_t i = 1; i < chain.size(); ++i) width += chain[i].kernel / 2;
  return width;
}

bool worth_composing(const std::vector<ConvSpec>& chain) {
  double separate = 0.0;
  ConvSpec composed = chain.back();
  composed.in_channels = chain.front().in_channels;
  composed.kernel = 1;
  for (const ConvSpec& spec : chain) {
    separate += conv_cost(spec);
    composed.kernel += spec.kernel - 1;
  }
  return chain.size() > 1 && conv_cost(composed) < separate;
}

std::unique_ptr<Kernel> make_chain(const std::vector<ConvSpec>& chain) {
  E2LF_REQUIRE(!chain.empty(), "a chain has at least one layer");
  return std::make_unique<ChainKernel>(chain);
}

}  // namespace e2lf::engine
