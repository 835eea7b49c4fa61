// SPDX-License-Identifier: MIT
// Light fields for any patterns, against their parts computed one by one.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>

#include "e2lf/geometry/any_patterns.h"
#include "e2lf/geometry/aperture.h"
#include "e2lf/model/composition.h"
#include "testing/engine_runs.h"
#include "testing/networks_for_any_patterns.h"

namespace e2lf::geometry {
namespace {

using engine::conv, engine::reshape, engine::run_engine;
using namespace for_any_patterns;

/// A network of the central picture with one hidden layer.
model::Model small_picture_network() {
  model::Model model;
  model.name = "picture";
  model.num_patterns = 4;
  model.input = {{model::InputKind::kCentral, 1.0F}};
  model.network = {model::kCentralPlanes,
                   {conv("stem", "input", 5, 2, true, "", 2), conv("head", "stem", 4, 3, false),
                    reshape("sharp", model::Op::kPixelShuffle, {"head"}, 2)}};
  for (const auto& weights : model::weight_shapes(model.network)) {
    model.weights[weights.name] = numbered(weights.name, weights.shape);
  }
  model.open_guide = std::make_shared<const model::OpenGuide>(model::OpenGuide{{}, small_model()});
  return model;
}

/// Reads an image at any place, linearly with edges repeated.
double read(const float* image, double y, double x) {
  const auto inside = [](double place) { return std::clamp(place, 0.0, static_cast<double>(kSize - 1)); };
  y = inside(y);
  x = inside(x);
  double sum = 0;
  for (size_t i = 0; i < kSize * kSize; ++i) {
    const double dy = 1 - std::abs(y - static_cast<double>(i / kSize));
    const double dx = 1 - std::abs(x - static_cast<double>(i % kSize));
    if (dy > 0 && dx > 0) sum += dy * dx * image[i];
  }
  return sum;
}

/// The planes of InputKind::kCentral for patterns that are all lit, and the base of the picture.
struct CentralPlanes {
  std::vector<float> values, base;

  CentralPlanes(const std::vector<float>& input, const std::vector<float>& map, const capture::Codes& codes)
      : input_(input), map_(map), transitions_(codes.num_patterns - 1), aperture_(describe_aperture(codes).value()) {
    const size_t first_condition = 3 * transitions_;
    add_slots(/*is_moved=*/true);
    add_slots(/*is_moved=*/false);
    std::vector<double> areas;
    for (size_t p = 1; p <= transitions_; ++p) {
      double open = 0;
      for (const float cell : codes.pattern(p)) open += cell;
      areas.push_back(open / 64);
    }
    double all = 0;
    for (const double area : areas) all += area;
    add([&](size_t i) {
      double sum = 0;
      for (size_t p = 0; p < transitions_; ++p) sum += moved(2, p, i) / 4 / all;
      base.push_back(static_cast<float>(sum));
      return sum;
    });
    add([&](size_t i) {
      double sum = 0, weights = 0;
      for (size_t p = 0; p < transitions_; ++p) {
        sum += aperture_.pictures[p].weight * moved(2, p, i) / 4 / areas[p];
        weights += aperture_.pictures[p].weight;
      }
      return sum / weights;
    });
    for (size_t output = 0; output < 2; ++output) add([&](size_t i) { return 0.3 * map_[output * kPixels + i]; });
    add([&](size_t i) { return input_[(first_condition + 15) * kPixels + i]; });
    for (const double constant : aperture_.constants) add([&](size_t) { return constant; });
    for (size_t c = 0; c < 15; ++c) add([&](size_t i) { return input_[(first_condition + c) * kPixels + i]; });
    for (size_t slot = 0; slot < kSlots; ++slot) {
      add([&](size_t i) {
        double sum = 0;
        for (size_t p = 1; p < transitions_; ++p) {
          sum += aperture_.pictures[p].slots[slot] * input_[(first_condition + 16 + p - 1) * kPixels + i];
        }
        return sum;
      });
    }
  }

 private:
  static constexpr size_t kPixels = kSize * kSize;

  template <typename At>
  void add(const At& at) {
    for (size_t i = 0; i < kPixels; ++i) values.push_back(static_cast<float>(at(i)));
  }

  void add_slots(bool is_moved) {
    for (size_t group = 1; group <= 2; ++group) {
      for (size_t slot = 0; slot < kSlots; ++slot) {
        add([&](size_t i) {
          double sum = 0;
          for (size_t p = 0; p < transitions_; ++p) {
            const double value = is_moved ? moved(group, p, i) : input_[(group * transitions_ + p) * kPixels + i];
            sum += aperture_.pictures[p].slots[slot] * value;
          }
          return sum;
        });
      }
    }
  }

  [[nodiscard]] double moved(size_t group, size_t p, size_t i) const {
    const AperturePicture& picture = aperture_.pictures[p];
    return read(&input_[(group * transitions_ + p) * kPixels],
                static_cast<double>(i / kSize) + picture.offset_y * map_[i],
                static_cast<double>(i % kSize) + picture.offset_x * map_[i]);
  }

  const std::vector<float>&input_, &map_;
  size_t transitions_;
  Aperture aperture_;
};

TEST(CentralPicture, IsMadeOfThePicturesThatTheDisparityMovesToTheCentralView) {
  const capture::Codes codes = three_boxes();
  const model::Model picture = small_picture_network();
  const auto adapted = for_patterns(picture, codes);
  ASSERT_TRUE(adapted) << adapted.error().text();
  EXPECT_EQ(adapted->codes, codes);
  EXPECT_EQ(adapted->name, "picture");
  EXPECT_TRUE(model::serves_any_patterns(*adapted));
  EXPECT_FALSE(model::is_for_any_patterns(*adapted));
  const std::vector<float> input = inputs(codes.num_patterns - 1);
  const model::Model disparity = for_patterns(small_model(), codes).value();
  const auto map = run_engine(disparity.network, disparity.weights, input, kSize, kSize);
  const CentralPlanes planes(input, map, codes);
  std::vector<float> expected = run_engine(picture.network, picture.weights, planes.values, kSize, kSize);
  for (size_t i = 0; i < expected.size(); ++i) expected[i] += planes.base[i];

  model::Network until_picture = adapted->network;
  const auto last = std::ranges::find(until_picture.layers, "picture", &model::Layer::name);
  ASSERT_NE(last, until_picture.layers.end());
  until_picture.layers.erase(last + 1, until_picture.layers.end());
  model::Weights weights;
  for (const auto& needed : model::weight_shapes(until_picture)) {
    weights[needed.name] = adapted->weights.at(needed.name);
  }
  const auto found = run_engine(until_picture, weights, input, kSize, kSize);
  ASSERT_EQ(found.size(), expected.size());
  for (size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], expected[i], 1e-4) << i;
}

TEST(CentralPicture, IsRenderedFromViewFourFour) {
  const auto adapted = for_patterns(small_picture_network(), three_boxes());
  ASSERT_TRUE(adapted) << adapted.error().text();
  const model::Layer& surface = adapted->network.layers.back();
  EXPECT_EQ(surface.op, GeometryOp::kRenderLayers);
  for (const char* axis : {"rows", "columns"}) {
    const std::vector<double>& places = surface.attributes.at(axis);
    ASSERT_EQ(places.size(), 8U);
    EXPECT_EQ(places[4], 0);
    EXPECT_EQ(places[0], -4);
  }
}

TEST(CentralPicture, NeedsThePatternsAndTheLitTransitions) {
  const model::Model picture = small_picture_network();
  EXPECT_EQ(model::validate(picture, "picture").error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(for_patterns(picture, capture::whole_cycle(three_boxes())).error().code, ErrorCode::kUnsupported);
  model::Model reads_twice = picture;
  reads_twice.network.layers[1].inputs = {"input"};
  EXPECT_EQ(for_patterns(reads_twice, three_boxes()).error().code, ErrorCode::kInvalidValue);
}

}  // namespace
}  // namespace e2lf::geometry
