// SPDX-License-Identifier: MIT
// Winograd's transforms (see elements.h), and the adjoints that gradients need. This file is included once per
// instruction set, after <hwy/highway.h>.
#if defined(E2LF_KERNELS_WINOGRAD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_KERNELS_WINOGRAD_INL_H_
#undef E2LF_KERNELS_WINOGRAD_INL_H_
#else
#define E2LF_KERNELS_WINOGRAD_INL_H_
#endif

#include "e2lf/kernels/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::kernels {
namespace HWY_NAMESPACE {

inline constexpr float kA = static_cast<float>(kWinogradA);
inline constexpr float kB = static_cast<float>(kWinogradB);

/// Computes B^T x, which maps six input samples to the six points.
HWY_INLINE void transform_input(const FloatVec (&x)[kWinogradPoints], FloatVec (&v)[kWinogradPoints]) {
  const FloatTag d;
  const auto a2b2 = hn::Set(d, kA * kA * kB * kB);
  const auto a2_plus_b2 = hn::Set(d, kA * kA + kB * kB);
  const auto a2 = hn::Set(d, kA * kA);
  const auto b2 = hn::Set(d, kB * kB);
  v[0] = hn::NegMulAdd(a2_plus_b2, x[2], hn::MulAdd(a2b2, x[0], x[4]));
  const auto even_a = hn::NegMulAdd(b2, x[2], x[4]);
  const auto odd_a = hn::NegMulAdd(b2, x[1], x[3]);
  v[1] = hn::MulAdd(hn::Set(d, kA), odd_a, even_a);
  v[2] = hn::NegMulAdd(hn::Set(d, kA), odd_a, even_a);
  const auto even_b = hn::NegMulAdd(a2, x[2], x[4]);
  const auto odd_b = hn::NegMulAdd(a2, x[1], x[3]);
  v[3] = hn::MulAdd(hn::Set(d, kB), odd_b, even_b);
  v[4] = hn::NegMulAdd(hn::Set(d, kB), odd_b, even_b);
  v[5] = hn::NegMulAdd(a2_plus_b2, x[3], hn::MulAdd(a2b2, x[1], x[5]));
}

/// Computes A^T m, which maps the sums at the six points to four outputs.
HWY_INLINE void transform_output(const FloatVec (&m)[kWinogradPoints], FloatVec (&y)[kTileSize]) {
  const FloatTag d;
  const auto even_a = hn::Add(m[1], m[2]);
  const auto odd_a = hn::Sub(m[1], m[2]);
  const auto even_b = hn::Add(m[3], m[4]);
  const auto odd_b = hn::Sub(m[3], m[4]);
  y[0] = hn::Add(m[0], hn::Add(even_a, even_b));
  y[1] = hn::MulAdd(hn::Set(d, kB), odd_b, hn::Mul(hn::Set(d, kA), odd_a));
  y[2] = hn::MulAdd(hn::Set(d, kB * kB), even_b, hn::Mul(hn::Set(d, kA * kA), even_a));
  y[3] = hn::MulAdd(hn::Set(d, kB * kB * kB), odd_b, hn::MulAdd(hn::Set(d, kA * kA * kA), odd_a, m[5]));
}

inline constexpr size_t kTaps = 3;

/// Computes A y, the adjoint of transform_output().
HWY_INLINE void spread_output(const FloatVec (&y)[kTileSize], FloatVec (&m)[kWinogradPoints]) {
  const FloatTag d;
  const auto even_a = hn::MulAdd(hn::Set(d, kA * kA), y[2], y[0]);
  const auto odd_a = hn::MulAdd(hn::Set(d, kA * kA * kA), y[3], hn::Mul(hn::Set(d, kA), y[1]));
  const auto even_b = hn::MulAdd(hn::Set(d, kB * kB), y[2], y[0]);
  const auto odd_b = hn::MulAdd(hn::Set(d, kB * kB * kB), y[3], hn::Mul(hn::Set(d, kB), y[1]));
  m[0] = y[0];
  m[1] = hn::Add(even_a, odd_a);
  m[2] = hn::Sub(even_a, odd_a);
  m[3] = hn::Add(even_b, odd_b);
  m[4] = hn::Sub(even_b, odd_b);
  m[5] = y[3];
}

/// Computes B v, the adjoint of transform_input().
HWY_INLINE void spread_input(const FloatVec (&v)[kWinogradPoints], FloatVec (&x)[kWinogradPoints]) {
  const FloatTag d;
  const auto a2 = hn::Set(d, kA * kA), b2 = hn::Set(d, kB * kB);
  const auto a2b2 = hn::Set(d, kA * kA * kB * kB), a2_plus_b2 = hn::Set(d, kA * kA + kB * kB);
  const auto even_a = hn::Add(v[1], v[2]), even_b = hn::Add(v[3], v[4]);
  const auto odd_a = hn::Mul(hn::Set(d, kA), hn::Sub(v[1], v[2]));
  const auto odd_b = hn::Mul(hn::Set(d, kB), hn::Sub(v[3], v[4]));
  x[0] = hn::Mul(a2b2, v[0]);
  x[1] = hn::NegMulAdd(b2, odd_a, hn::NegMulAdd(a2, odd_b, hn::Mul(a2b2, v[5])));
  x[2] = hn::NegMulAdd(b2, even_a, hn::NegMulAdd(a2, even_b, hn::Neg(hn::Mul(a2_plus_b2, v[0]))));
  x[3] = hn::NegMulAdd(a2_plus_b2, v[5], hn::Add(odd_a, odd_b));
  x[4] = hn::Add(v[0], hn::Add(even_a, even_b));
  x[5] = v[5];
}

// Scales of the transformed weights. At each point in order, they are (g0 + point g1 + point^2 g2) * scale for the taps
// g.
inline constexpr float kScaleZero = 1.0F / (kA * kA * kB * kB);
inline constexpr float kScaleA = 1.0F / (2.0F * kA * kA * (kA * kA - kB * kB));
inline constexpr float kScaleB = 1.0F / (2.0F * kB * kB * (kB * kB - kA * kA));

/// Computes G g, the transform of the taps.
HWY_INLINE void transform_taps(const FloatVec (&g)[kTaps], FloatVec (&u)[kWinogradPoints]) {
  const FloatTag d;
  const auto pair = [&](float point, float scale, FloatVec& plus, FloatVec& minus) HWY_ATTR {
    const auto even = hn::Mul(hn::Set(d, scale), hn::MulAdd(hn::Set(d, point * point), g[2], g[0]));
    const auto odd = hn::Mul(hn::Set(d, scale * point), g[1]);
    plus = hn::Add(even, odd);
    minus = hn::Sub(even, odd);
  };
  u[0] = hn::Mul(hn::Set(d, kScaleZero), g[0]);
  pair(kA, kScaleA, u[1], u[2]);
  pair(kB, kScaleB, u[3], u[4]);
  u[5] = g[2];
}

/// Computes G^T u, the adjoint of transform_taps().
HWY_INLINE void collect_taps(const FloatVec (&u)[kWinogradPoints], FloatVec (&g)[kTaps]) {
  const FloatTag d;
  const auto even_a = hn::Mul(hn::Set(d, kScaleA), hn::Add(u[1], u[2]));
  const auto even_b = hn::Mul(hn::Set(d, kScaleB), hn::Add(u[3], u[4]));
  g[0] = hn::MulAdd(hn::Set(d, kScaleZero), u[0], hn::Add(even_a, even_b));
  g[1] =
      hn::MulAdd(hn::Set(d, kScaleA * kA), hn::Sub(u[1], u[2]), hn::Mul(hn::Set(d, kScaleB * kB), hn::Sub(u[3], u[4])));
  g[2] = hn::MulAdd(hn::Set(d, kA * kA), even_a, hn::MulAdd(hn::Set(d, kB * kB), even_b, u[5]));
}

/// Applies a transform along both axes of a square, first to its columns: `load(i, j)` returns the value in row i of
/// column j, and `store(i, j, value)` receives those of the result. With i and j exchanged in both, the rows are first.
template <size_t kFrom, size_t kTo, class Transform, class Load, class Store>
HWY_INLINE void transform_square(const Transform& transform, const Load& load, const Store& store) {
  FloatVec half[kTo][kFrom];
  E2LF_UNROLL
  for (size_t j = 0; j < kFrom; ++j) {
    FloatVec column[kFrom], transformed[kTo];
    E2LF_UNROLL
    for (size_t i = 0; i < kFrom; ++i) column[i] = load(i, j);
    transform(column, transformed);
    E2LF_UNROLL
    for (size_t i = 0; i < kTo; ++i) half[i][j] = transformed[i];
  }
  E2LF_UNROLL
  for (size_t i = 0; i < kTo; ++i) {
    FloatVec transformed[kTo];
    transform(half[i], transformed);
    E2LF_UNROLL
    for (size_t j = 0; j < kTo; ++j) store(i, j, transformed[j]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::kernels
HWY_AFTER_NAMESPACE();

#endif
