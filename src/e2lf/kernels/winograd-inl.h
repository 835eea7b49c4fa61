// SPDX-License-Identifier: MIT
// Winograd's transforms (see winograd_points.h). This file is included once per instruction set, after <hwy/highway.h>.
#if defined(E2LF_KERNELS_WINOGRAD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_KERNELS_WINOGRAD_INL_H_
#undef E2LF_KERNELS_WINOGRAD_INL_H_
#else
#define E2LF_KERNELS_WINOGRAD_INL_H_
#endif

#include "e2lf/kernels/vector-inl.h"
#include "e2lf/kernels/winograd_points.h"

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

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::kernels
HWY_AFTER_NAMESPACE();

#endif
