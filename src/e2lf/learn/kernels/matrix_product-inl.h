// SPDX-License-Identifier: MIT
// Included once per instruction set, after <hwy/highway.h>. Contains products of small matrices.
#if defined(E2LF_LEARN_MATRIX_PRODUCT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef E2LF_LEARN_MATRIX_PRODUCT_INL_H_
#undef E2LF_LEARN_MATRIX_PRODUCT_INL_H_
#else
#define E2LF_LEARN_MATRIX_PRODUCT_INL_H_
#endif

#include "e2lf/kernels/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::learn {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
namespace kn = kernels::HWY_NAMESPACE;

using kn::FloatTag, kn::FloatVec, kn::kGemmRows, kn::kGemmVectors, kn::kLanes;

/// A matrix that is read element by element: (row, column) is at data[row * row_step + column * column_step].
struct Factor {
  const float* data;
  size_t row_step, column_step;
};

/// Computes the product of kRows rows of `a` and kVectors vectors of columns of `b`, and stores it in `product` or adds
/// it (kAdd). The rows of `b` and `product` have `columns` elements.
template <bool kAdd, size_t kRows, size_t kVectors>
HWY_INLINE void multiply_block(const Factor& a, size_t depth, const float* HWY_RESTRICT b, size_t columns,
                               float* HWY_RESTRICT product) {
  const FloatTag d;
  FloatVec sums[kRows][kVectors];
  E2LF_UNROLL
  for (size_t i = 0; i < kRows; ++i) {
    E2LF_UNROLL
    for (size_t j = 0; j < kVectors; ++j)
      sums[i][j] = kAdd ? hn::LoadU(d, product + i * columns + j * kLanes) : hn::Zero(d);
  }
  const float* HWY_RESTRICT from = a.data;
  for (size_t k = 0; k < depth; ++k) {
    FloatVec row[kVectors];
    E2LF_UNROLL
    for (size_t j = 0; j < kVectors; ++j) row[j] = hn::LoadU(d, b + j * kLanes);
    E2LF_UNROLL
    for (size_t i = 0; i < kRows; ++i) {
      const auto factor = hn::Set(d, from[i * a.row_step]);
      E2LF_UNROLL
      for (size_t j = 0; j < kVectors; ++j) sums[i][j] = hn::MulAdd(factor, row[j], sums[i][j]);
    }
    from += a.column_step;
    b += columns;
  }
  E2LF_UNROLL
  for (size_t i = 0; i < kRows; ++i) {
    E2LF_UNROLL
    for (size_t j = 0; j < kVectors; ++j) hn::StoreU(sums[i][j], d, product + i * columns + j * kLanes);
  }
}

/// Computes the product of all rows for kVectors vectors of columns.
template <bool kAdd, size_t kVectors>
HWY_INLINE void multiply_rows(Factor a, size_t rows, size_t depth, const float* b, size_t columns, float* product) {
  static_assert(kGemmRows == 6);
  for (; rows >= kGemmRows; rows -= kGemmRows) {
    multiply_block<kAdd, kGemmRows, kVectors>(a, depth, b, columns, product);
    a.data += kGemmRows * a.row_step;
    product += kGemmRows * columns;
  }
  if (rows == 1) multiply_block<kAdd, 1, kVectors>(a, depth, b, columns, product);
  if (rows == 2) multiply_block<kAdd, 2, kVectors>(a, depth, b, columns, product);
  if (rows == 3) multiply_block<kAdd, 3, kVectors>(a, depth, b, columns, product);
  if (rows == 4) multiply_block<kAdd, 4, kVectors>(a, depth, b, columns, product);
  if (rows == 5) multiply_block<kAdd, 5, kVectors>(a, depth, b, columns, product);
}

/// Computes product = a b, or product += a b (kAdd), where `a` is [rows, depth], `b` is [depth, columns], and `columns`
/// is a multiple of 16.
template <bool kAdd>
void multiply(const Factor& a, size_t rows, size_t depth, const float* b, size_t columns, float* product) {
  size_t column = 0;
  for (; column + kGemmVectors * kLanes <= columns; column += kGemmVectors * kLanes) {
    multiply_rows<kAdd, kGemmVectors>(a, rows, depth, b + column, columns, product + column);
  }
  for (; column < columns; column += kLanes) {
    multiply_rows<kAdd, 1>(a, rows, depth, b + column, columns, product + column);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::learn
HWY_AFTER_NAMESPACE();

#endif
