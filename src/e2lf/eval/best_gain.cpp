// SPDX-License-Identifier: MIT
#include "e2lf/eval/best_gain.h"

#include "e2lf/base/contract.h"

namespace e2lf::eval {

float best_gain(const lightfield::LightField& truth, const lightfield::LightField& reconstruction) {
  E2LF_REQUIRE(truth.shape() == reconstruction.shape(), "light fields of different shapes have no best gain");
  double products = 0, squares = 0;
  for (size_t i = 0; i < truth.data().size(); ++i) {
    const double value = double{reconstruction.data()[i]};
    products += value * double{truth.data()[i]};
    squares += value * value;
  }
  return squares > 0 ? static_cast<float>(products / squares) : 0.0F;
}

}  // namespace e2lf::eval
