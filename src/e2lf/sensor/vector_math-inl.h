// SPDX-License-Identifier: MIT
// Highway's include guard per target: this file is included once for each instruction set.
#if defined(E2LF_SENSOR_VECTOR_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_SENSOR_VECTOR_MATH_INL_H_
#undef E2LF_SENSOR_VECTOR_MATH_INL_H_
#else
#define E2LF_SENSOR_VECTOR_MATH_INL_H_
#endif

#include <cstdint>
#include <numbers>

#include <hwy/highway.h>

// Elementary functions on float32 vectors, composed only of additions, multiplications, divisions and square roots.
// Each of these rounds in the same way everywhere, so that results are bit-identical on every instruction set.
HWY_BEFORE_NAMESPACE();
namespace e2lf::sensor::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Returns ln(x) for positive normal x, within 0.8 units in the last place (like the C library). With x = 2^e (1 + f)
/// and 1 + f in [sqrt(1/2), sqrt(2)), ln(1 + f) follows from the series of artanh(s), s = f / (2 + f): 2 artanh(s) = 2
/// s + s r, r = s^2 (2/3 + 2/5 s^2 + 2/7 s^4 + 2/9 s^6). It is written as f - (h - s (h + r)), h = f^2 / 2, so that the
/// largest term f is exact.
template <class D, class V = hn::Vec<D>>
V Log(D d, V x) {
  const hn::RebindToSigned<D> di;
  const auto bits = hn::BitCast(di, x);
  const auto exponent = hn::ShiftRight<23>(hn::Sub(bits, hn::Set(di, 0x3F3504F3)));  // the bits of sqrt(1/2)
  const V e = hn::ConvertTo(d, exponent);
  const V f = hn::Sub(hn::BitCast(d, hn::Sub(bits, hn::ShiftLeft<23>(exponent))), hn::Set(d, 1.0F));
  const V s = hn::Div(f, hn::Add(f, hn::Set(d, 2.0F)));
  const V s2 = hn::Mul(s, s);
  V r = hn::Add(hn::Mul(s2, hn::Set(d, 2.0F / 9)), hn::Set(d, 2.0F / 7));
  r = hn::Add(hn::Mul(s2, r), hn::Set(d, 2.0F / 5));
  r = hn::Mul(s2, hn::Add(hn::Mul(s2, r), hn::Set(d, 2.0F / 3)));
  const V h = hn::Mul(hn::Mul(f, f), hn::Set(d, 0.5F));
  // ln 2 is split into two parts, the first of which has so few bits that its product with an exponent is exact.
  constexpr float kHigh = 0x1.62E4p-1F;
  constexpr float kLow = static_cast<float>(std::numbers::ln2 - static_cast<double>(kHigh));
  const V rest = hn::Add(hn::Mul(s, hn::Add(h, r)), hn::Mul(e, hn::Set(d, kLow)));
  return hn::Add(hn::Mul(e, hn::Set(d, kHigh)), hn::Sub(f, hn::Sub(h, rest)));
}

/// Converts each unsigned 32-bit word to the nearest float.
template <class D, class VU>
hn::Vec<D> FloatFromWord(D d, VU words) {
  const hn::RebindToSigned<D> di;
  const hn::RebindToUnsigned<D> du;
  const auto high = hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<16>(words)));
  const auto low = hn::ConvertTo(d, hn::BitCast(di, hn::And(words, hn::Set(du, 0xFFFF))));
  return hn::Add(hn::Mul(high, hn::Set(d, 65536.0F)), low);
}

/// Computes the cosine and sine of 2 pi word / 2^32. The two top bits select the nearest quarter turn, and Taylor
/// series are used for the remaining angle of at most pi / 4. Both results are within 1e-7.
template <class D, class VU, class V = hn::Vec<D>>
void CosSinOfTurn(D d, VU words, V& cosine, V& sine) {
  const hn::RebindToSigned<D> di;
  const hn::RebindToUnsigned<D> du;
  const auto quarter = hn::ShiftRight<30>(hn::Add(words, hn::Set(du, 1U << 29)));
  const auto rest = hn::BitCast(di, hn::Sub(words, hn::ShiftLeft<30>(quarter)));
  const V a = hn::Mul(hn::ConvertTo(d, rest), hn::Set(d, 2.0F * std::numbers::pi_v<float> * 0x1p-32F));
  const V a2 = hn::Mul(a, a);
  V s = hn::Sub(hn::Mul(a2, hn::Set(d, 1.0F / 362880)), hn::Set(d, 1.0F / 5040));
  s = hn::Add(hn::Mul(a2, s), hn::Set(d, 1.0F / 120));
  s = hn::Sub(hn::Mul(a2, s), hn::Set(d, 1.0F / 6));
  s = hn::Add(a, hn::Mul(hn::Mul(a, a2), s));
  V c = hn::Sub(hn::Mul(a2, hn::Set(d, 1.0F / 40320)), hn::Set(d, 1.0F / 720));
  c = hn::Add(hn::Mul(a2, c), hn::Set(d, 1.0F / 24));
  c = hn::Sub(hn::Mul(a2, c), hn::Set(d, 0.5F));
  c = hn::Add(hn::Mul(a2, c), hn::Set(d, 1.0F));
  // Quarter turns 1 and 3 swap the two. The sign bits follow from the number of the quarter.
  const auto odd = hn::RebindMask(d, hn::Eq(hn::And(quarter, hn::Set(du, 1)), hn::Set(du, 1)));
  const auto sine_sign = hn::ShiftLeft<31>(hn::ShiftRight<1>(quarter));
  const auto cosine_sign = hn::ShiftLeft<31>(hn::ShiftRight<1>(hn::Add(quarter, hn::Set(du, 1))));
  cosine = hn::Xor(hn::IfThenElse(odd, s, c), hn::BitCast(d, cosine_sign));
  sine = hn::Xor(hn::IfThenElse(odd, c, s), hn::BitCast(d, sine_sign));
}

}  // namespace e2lf::sensor::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
