// SPDX-License-Identifier: MIT
#include "e2lf/sensor/block_kernels.h"

#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/sensor/block_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/base/rng.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::sensor::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Elementary functions on float32 vectors, composed only of additions, multiplications, divisions and square roots.
// Each of these rounds in the same way everywhere, so that results are bit-identical on every instruction set.

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

using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;
using D32 = hn::ScalableTag<uint32_t>;
using V32 = hn::Vec<D32>;

void AddScaled(const float* HWY_RESTRICT values, float weight, float* HWY_RESTRICT sum, size_t count) {
  const D d;
  const V scale = hn::Set(d, weight);
  size_t i = 0;
  for (; i + hn::Lanes(d) <= count; i += hn::Lanes(d)) {
    hn::StoreU(hn::Add(hn::LoadU(d, sum + i), hn::Mul(scale, hn::LoadU(d, values + i))), d, sum + i);
  }
  for (; i < count; ++i) sum[i] += weight * values[i];
}

/// The four words of CounterRng(seed, stream).bits(pixel) for a vector of consecutive pixels.
struct Words {
  V32 word[4];
};

#if HWY_TARGET == HWY_SCALAR

Words PixelWords(uint32_t first_pixel, uint64_t stream, uint64_t seed) {
  const D32 d;
  const auto words = CounterRng(seed, stream).bits(first_pixel);
  return {{hn::Set(d, words[0]), hn::Set(d, words[1]), hn::Set(d, words[2]), hn::Set(d, words[3])}};
}

#else

using D64 = hn::Repartition<uint64_t, D32>;
using V64 = hn::Vec<D64>;

HWY_INLINE V64 Multiply32(V64 a, V64 b) {
  const D32 d32;
  return hn::MulEven(hn::BitCast(d32, a), hn::BitCast(d32, b));
}

/// Computes the rounds of philox4x32 with one counter per 64-bit lane. The words end up in the low halves of the lanes.
HWY_INLINE void Philox(uint64_t seed, V64 (&counter)[4]) {
  const D64 d;
  const V64 multiplier0 = hn::Set(d, 0xD2511F53), multiplier1 = hn::Set(d, 0xCD9E8D57);
  auto key0 = static_cast<uint32_t>(seed), key1 = static_cast<uint32_t>(seed >> 32);
  for (int round = 0; round < 10; ++round) {
    // The high halves of the lanes hold remainders, which neither the products nor the next round read.
    const V64 product0 = Multiply32(multiplier0, counter[0]);
    const V64 product1 = Multiply32(multiplier1, counter[2]);
    counter[0] = hn::Xor3(hn::ShiftRight<32>(product1), counter[1], hn::Set(d, key0));
    counter[1] = product1;
    counter[2] = hn::Xor3(hn::ShiftRight<32>(product0), counter[3], hn::Set(d, key1));
    counter[3] = product0;
    key0 += 0x9E3779B9;
    key1 += 0xBB67AE85;
  }
}

/// Takes the words of the even lanes and, from their low halves as well, those of the odd lanes.
HWY_INLINE V32 Merge(V64 odd, V64 even) {
  const D32 d;
  return hn::OddEven(hn::BitCast(d, hn::ShiftLeft<32>(odd)), hn::BitCast(d, even));
}

Words PixelWords(uint32_t first_pixel, uint64_t stream, uint64_t seed) {
  const D64 d;
  // Pixels in even and odd lanes are processed separately and then merged.
  const V64 pixel = hn::Add(hn::Set(d, first_pixel), hn::ShiftLeft<1>(hn::Iota(d, 0)));
  V64 even[4] = {pixel, hn::Zero(d), hn::Set(d, stream & 0xFFFFFFFF), hn::Set(d, stream >> 32)};
  V64 odd[4] = {hn::Add(pixel, hn::Set(d, 1)), even[1], even[2], even[3]};
  Philox(seed, even);
  Philox(seed, odd);
  // No constructor of Words is called, since GCC would compile it without the instructions of NEON's target.
  return {{Merge(odd[0], even[0]), Merge(odd[1], even[1]), Merge(odd[2], even[2]), Merge(odd[3], even[3])}};
}

#endif

/// Converts the words to uniform numbers in 0..1.
HWY_INLINE V Uniform(V32 word) {
  const D d;
  return hn::Mul(hn::Add(FloatFromWord(d, word), hn::Set(d, 0.5F)), hn::Set(d, 0x1p-32F));
}

/// Computes two standard normal draws per lane with the Box-Muller transform.
HWY_INLINE void Normals(V32 word0, V32 word1, V& w, V& z) {
  const D d;
  const V unit = hn::Min(Uniform(word0), hn::Set(d, 1.0F));
  const V radius = hn::Sqrt(hn::Mul(hn::Set(d, -2.0F), Log(d, unit)));
  V cosine, sine;
  CosSinOfTurn(d, word1, cosine, sine);
  w = hn::Mul(radius, cosine);
  z = hn::Mul(radius, sine);
}

template <bool kNoisy, bool kQuantised>
bool Simulate(const EventBlock& block, size_t num_pixels, const EventModelOptions& options) {
  const D d;
  const hn::Rebind<int16_t, D> d16;
  const hn::RebindToSigned<D> di;
  const V zero = hn::Zero(d), gain = hn::Set(d, options.gain), eps = hn::Set(d, options.constants.eps);
  const V tau = hn::Set(d, options.constants.tau), residue = hn::Set(d, options.residue);
  const V sigma_w = hn::Set(d, options.constants.sigma_w), sigma_z = hn::Set(d, options.constants.sigma_z);
  const V min_threshold = hn::Set(d, kMinThreshold);
  const V lowest = hn::Set(d, -32768.0F), highest = hn::Set(d, 32767.0F);
  auto saturated = hn::Lt(highest, zero);

  for (size_t i = 0; i < num_pixels; i += hn::Lanes(d)) {
    const float* intensity = block.intensities + i;
    // Max returns its second operand if the first is NaN.
    const auto log_intensity = [&](size_t n) HWY_ATTR {
      const V light = hn::Mul(hn::LoadU(d, intensity + n * kBlockPixels), gain);
      return Log(d, hn::Add(hn::Max(light, zero), eps));
    };
    const uint32_t first_pixel = block.first_pixel + static_cast<uint32_t>(i);
    Words words = {};
    V reference = log_intensity(0);
    if (options.residue != 0.0F) {
      const V thresholds = hn::Mul(residue, Uniform(PixelWords(first_pixel, kResidueStream, options.seed).word[0]));
      reference = hn::Add(reference, hn::Mul(tau, thresholds));
    }
    for (size_t step = 0; step + 1 < block.num_patterns; ++step) {
      const V now = log_intensity(step + 1);
      V change = hn::Sub(now, reference);
      V threshold = hn::Max(tau, min_threshold);
      if constexpr (kNoisy) {
        V w, z;
        if (step % 2 == 0) words = PixelWords(first_pixel, step / 2, options.seed);
        Normals(words.word[2 * (step % 2)], words.word[2 * (step % 2) + 1], w, z);
        change = hn::Add(change, hn::Mul(sigma_w, w));
        threshold = hn::Max(hn::Add(tau, hn::Mul(sigma_z, z)), min_threshold);
      }
      const V quotient = hn::Div(change, threshold);
      const V clamped = hn::Min(hn::Max(quotient, lowest), highest);
      saturated = hn::Or(saturated, hn::Ge(hn::Abs(quotient), hn::Set(d, 32768.0F)));
      const auto count = hn::ConvertTo(di, clamped);
      hn::StoreU(hn::DemoteTo(d16, count), d16, block.counts + step * kBlockPixels + i);
      reference = kQuantised ? now : hn::Add(reference, hn::Mul(tau, hn::ConvertTo(d, count)));
    }
  }
  return !hn::AllFalse(d, saturated);
}

bool SimulateBlock(const EventBlock& block, size_t num_pixels, const EventModelOptions& options) {
  const bool noisy = options.constants.sigma_w != 0 || options.constants.sigma_z != 0;
  const bool quantised = options.model == EventModel::kQuantised;
  if (noisy) {
    return quantised ? Simulate<true, true>(block, num_pixels, options)
                     : Simulate<true, false>(block, num_pixels, options);
  }
  return quantised ? Simulate<false, true>(block, num_pixels, options)
                   : Simulate<false, false>(block, num_pixels, options);
}

}  // namespace e2lf::sensor::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::sensor {

HWY_EXPORT(AddScaled);
HWY_EXPORT(SimulateBlock);

void add_scaled(const float* values, float weight, float* sum, size_t count) {
  HWY_DYNAMIC_DISPATCH(AddScaled)(values, weight, sum, count);
}

bool simulate_block(const EventBlock& block, size_t num_pixels, const EventModelOptions& options) {
  return HWY_DYNAMIC_DISPATCH(SimulateBlock)(block, num_pixels, options);
}

}  // namespace e2lf::sensor
#endif
