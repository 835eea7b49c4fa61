// SPDX-License-Identifier: MIT
#include "e2lf/engine/reshape.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/engine/sigmoid.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "e2lf/engine/pixel_kernel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace e2lf::engine {
namespace HWY_NAMESPACE {
namespace {

struct SigmoidOf {
  template <class Element>
  HWY_INLINE FloatVec operator()(const Element* x) const {
    return sigmoid(load_floats(x));
  }
};

}  // namespace

std::unique_ptr<Kernel> MakeSigmoid(size_t channels, ElementType type) {
  return one_to_one<SigmoidOf>("sigmoid", channels, type);
}

}  // namespace HWY_NAMESPACE
}  // namespace e2lf::engine
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::engine {

HWY_EXPORT(MakeSigmoid);

std::unique_ptr<Kernel> make_sigmoid(size_t channels, ElementType type) {
  return HWY_DYNAMIC_DISPATCH(MakeSigmoid)(channels, type);
}

}  // namespace e2lf::engine
#endif
