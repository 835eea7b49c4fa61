// SPDX-License-Identifier: MIT
#include <algorithm>
#include <atomic>
#include <chrono>

#include "bench/program/parts.h"
#include "e2lf/base/isa.h"
#include "e2lf/base/threads.h"
#include "e2lf/engine/amx-inl.h"
#include "e2lf/engine/conv.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/program/peak.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/kernels/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::bench {
namespace HWY_NAMESPACE {

using namespace kernels::HWY_NAMESPACE;
using engine::ElementType;
namespace {

// The number of independent sums. It exceeds latency times units of any core.
constexpr size_t kSums = 12;

/// Performs multiply-adds in registers only and returns the number of operations. The sums begin at different multiples
/// of `factor`, which is zero but unknown to the compiler, so that it cannot remove any computation.
template <class Products>
double multiply_add_loop(size_t rounds, float factor) {
  const typename Products::Element zeros[2] = {};
  const auto product = hn::Add(Products::broadcast(zeros), hn::Set(FloatTag(), factor));
  FloatVec sums[kSums];
  E2LF_UNROLL
  for (size_t j = 0; j < kSums; ++j) sums[j] = hn::Set(FloatTag(), factor * static_cast<float>(j));
  for (size_t i = 0; i < rounds; ++i) {
    E2LF_UNROLL
    for (size_t j = 0; j < kSums; ++j) sums[j] = Products::multiply_add(product, product, sums[j]);
  }
  FloatVec total = hn::Zero(FloatTag());
  E2LF_UNROLL
  for (size_t j = 0; j < kSums; ++j) total = hn::Add(total, sums[j]);
  return static_cast<double>(rounds * kSums * 2 * kLanes * Products::kStep) +
         static_cast<double>(hn::GetLane(hn::SumOfLanes(FloatTag(), total)));
}

#if E2LF_TARGET_HAS_BF16
/// The same with products of AMX tiles.
double multiply_add_in_tiles(size_t rounds) {
  engine::TileShapes shapes;
  std::fill_n(shapes.row_bytes, 8, static_cast<uint16_t>(engine::kTileRowBytes));
  std::fill_n(shapes.rows, 8, static_cast<uint8_t>(engine::kTileRows));
  engine::load_tile_shapes(shapes);
  for (size_t i = 0; i < rounds; ++i) {
    E2LF_TILE_MULTIPLY(0, 4, 6);
    E2LF_TILE_MULTIPLY(1, 4, 7);
    E2LF_TILE_MULTIPLY(2, 5, 6);
    E2LF_TILE_MULTIPLY(3, 5, 7);
  }
  engine::release_tiles();
  return static_cast<double>(rounds * 4 * 2 * engine::kTileRows * engine::kTileRows * engine::kTileDepth);
}
#endif

}  // namespace

double MultiplyAdd(ElementType type, bool in_tiles, size_t rounds, float factor) {
#if E2LF_TARGET_HAS_BF16
  if (in_tiles) return multiply_add_in_tiles(rounds / 4);
  if (type == ElementType::kBfloat16) return multiply_add_loop<Bfloat16Products>(rounds, factor);
#else
  (void)in_tiles;
#endif
  return type == ElementType::kFloat32 ? multiply_add_loop<FloatProducts>(rounds, factor) : 0.0;
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::bench {

using engine::ElementType;

HWY_EXPORT(MultiplyAdd);

namespace {

constexpr int kTries = 10;
constexpr size_t kRounds = 2'000'000;

/// Runs a short loop and returns the number of operations.
double run_loop(ElementType type, float zero) {
  const bool in_tiles = type == ElementType::kBfloat16 && current_isa() == "amx";
  return HWY_DYNAMIC_DISPATCH(MultiplyAdd)(type, in_tiles, kRounds, zero);
}

double measure(ElementType type) {
  const volatile float zero = 0.0F;
  double best = 0.0;
  for (int i = 0; i < kTries; ++i) {
    std::atomic<double> operations = 0.0;
    const auto begin = std::chrono::steady_clock::now();
    run_team(static_cast<size_t>(num_threads()), [&](size_t /*member*/) { operations += run_loop(type, zero); });
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
    best = std::max(best, operations / elapsed.count());
  }
  return best;
}

}  // namespace

Peak measure_peak() {
  return {measure(ElementType::kFloat32), engine::bfloat16_supported() ? measure(ElementType::kBfloat16) : 0.0};
}

}  // namespace e2lf::bench
#endif
