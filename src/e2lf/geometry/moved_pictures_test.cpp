// SPDX-License-Identifier: MIT
// Light fields for any patterns, against their parts computed one by one.
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <numeric>

#include "e2lf/files/bundled_files.h"
#include "e2lf/geometry/any_patterns.h"
#include "e2lf/geometry/aperture.h"
#include "e2lf/model/composition.h"
#include "testing/engine_runs.h"
#include "testing/networks_for_any_patterns.h"

namespace e2lf::geometry {
namespace {

using engine::conv, engine::run_engine;
using namespace for_any_patterns;

/// Views made of moved pictures by one layer.
model::Model small_views() {
  model::Model model;
  model.name = "views";
  model.num_patterns = 4;
  model.input = {{model::InputKind::kMoved, 1.0F}};
  model.network = {model::kMovedPlanes, {conv("output", "input", 64, 3, false)}};
  for (const auto& weights : model::weight_shapes(model.network)) {
    model.weights[weights.name] = numbered(weights.name, weights.shape);
  }
  model.open_guide = std::make_shared<const model::OpenGuide>(model::OpenGuide{{}, small_model()});
  return model;
}

/// Returns the output of a layer of a network.
std::vector<float> run_until(const std::string& layer, const model::Model& model, const std::vector<float>& input) {
  model::Network part = model.network;
  const auto last = std::ranges::find(part.layers, layer, &model::Layer::name);
  if (last == part.layers.end()) return {};
  part.layers.erase(last + 1, part.layers.end());
  model::Weights weights;
  for (const auto& needed : model::weight_shapes(part)) weights[needed.name] = model.weights.at(needed.name);
  return run_engine(part, weights, input, kSize, kSize);
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

/// The planes of InputKind::kMoved for patterns that are all lit.
struct MovedPlanes {
  std::vector<float> values;

  MovedPlanes(const std::vector<float>& input, const std::vector<float>& map, const capture::Codes& codes)
      : input_(input), map_(map), transitions_(codes.num_patterns - 1), aperture_(describe_aperture(codes).value()) {
    const size_t first_condition = 3 * transitions_;
    for (size_t k = 0; k < kSlots; ++k) {
      add([&](size_t i) { return counts(i)[k]; });
    }
    for (size_t k = 0; k < kSlots; ++k) {
      add([&](size_t i) {
        const auto of_all = counts(i);
        return std::accumulate(of_all.begin(), of_all.begin() + static_cast<ptrdiff_t>(k) + 1, 0.0);
      });
    }
    for (size_t k = 0; k < kSlots; ++k) {
      add([&](size_t i) { return kLevelScale * level(k, i); });
    }
    for (size_t k = 0; k < kSlots; ++k) {
      add([&](size_t i) {
        double sum = 0;
        for (size_t p = 0; p < transitions_; ++p) {
          const AperturePicture& picture = aperture_.pictures[p];
          sum += picture.places[k] * moved(2, p, k, i) * kPlaceAreas[k] / picture.area;
        }
        return sum;
      });
    }
    for (size_t c = 0; c < 16; ++c) add([&](size_t i) { return input_[(first_condition + c) * kPixels + i]; });
    for (size_t k = 1; k < kSlots; ++k) add([&](size_t i) { return transmission(k, i) - transmission(0, i); });
    for (size_t group = 1; group <= 2; ++group) {
      for (size_t slot = 0; slot < kSlots; ++slot) {
        add([&](size_t i) {
          double sum = 0;
          for (size_t p = 0; p < transitions_; ++p) {
            sum += aperture_.pictures[p].slots[slot] * input_[(group * transitions_ + p) * kPixels + i];
          }
          return sum;
        });
      }
    }
    for (size_t output = 0; output < 2; ++output) add([&](size_t i) { return 0.3 * map_[output * kPixels + i]; });
    for (const double constant : aperture_.constants) add([&](size_t) { return constant; });
  }

 private:
  static constexpr size_t kPixels = kSize * kSize;
  static constexpr double kLevelScale = 0.125;

  template <typename At>
  void add(const At& at) {
    for (size_t i = 0; i < kPixels; ++i) values.push_back(static_cast<float>(at(i)));
  }

  /// The level that the pattern of e2lf-n4 would show in a place, in thresholds.
  [[nodiscard]] double level(size_t k, size_t i) const {
    double result = 0, of_area = 0;
    for (size_t p = 0; p < transitions_; ++p) {
      const AperturePicture& picture = aperture_.pictures[p];
      result += picture.places[k] * moved(1, p, k, i) / kLevelScale;
      of_area += picture.places[k] * std::log(kPlaceAreas[k] / picture.area) / 0.35;
    }
    return result + of_area * std::min(result / 3, 1.0);
  }

  /// The counts of a pixel that shows the levels of the places, for which half a threshold remains.
  [[nodiscard]] std::array<double, kSlots> counts(size_t i) const {
    std::array<double, kSlots> result = {};
    double before = 0;
    for (size_t k = 0; k < kSlots; ++k) {
      const double change = level(k, i) - before;
      result[k] = kLevelScale * std::copysign(std::max(std::abs(change) - 0.5, 0.0), change);
      before += result[k] / kLevelScale;
    }
    return result;
  }

  [[nodiscard]] double transmission(size_t k, size_t i) const {
    double sum = 0;
    for (size_t p = 1; p < transitions_; ++p) {
      sum += aperture_.pictures[p].places[k] * input_[(3 * transitions_ + 16 + p - 1) * kPixels + i];
    }
    return sum;
  }

  /// Reads an input where pixel i of place k sees what picture p shows.
  [[nodiscard]] double moved(size_t group, size_t p, size_t k, size_t i) const {
    const auto y = static_cast<double>(i / kSize), x = static_cast<double>(i % kSize);
    double disparity = map_[i];
    for (int iteration = 0; iteration < 2; ++iteration) {
      disparity = read(map_.data(), y - kPlaces[k][0] * disparity, x - kPlaces[k][1] * disparity);
    }
    const AperturePicture& picture = aperture_.pictures[p];
    return read(&input_[(group * transitions_ + p) * kPixels], y + (picture.offset_y - kPlaces[k][0]) * disparity,
                x + (picture.offset_x - kPlaces[k][1]) * disparity);
  }

  const std::vector<float>&input_, &map_;
  size_t transitions_;
  Aperture aperture_;
};

TEST(MovedPictures, AreWhatTheViewsAreMadeOf) {
  const capture::Codes codes = three_boxes();
  const model::Model views = small_views();
  const auto adapted = for_patterns(views, codes);
  ASSERT_TRUE(adapted) << adapted.error().text();
  EXPECT_EQ(adapted->codes, codes);
  EXPECT_EQ(adapted->name, "views");
  EXPECT_TRUE(model::serves_any_patterns(*adapted));
  EXPECT_FALSE(model::is_for_any_patterns(*adapted));
  const std::vector<float> input = inputs(codes.num_patterns - 1);
  const model::Model disparity = for_patterns(small_model(), codes).value();
  const auto map = run_engine(disparity.network, disparity.weights, input, kSize, kSize);
  const MovedPlanes planes(input, map, codes);
  const std::vector<float> expected = run_engine(views.network, views.weights, planes.values, kSize, kSize);
  const auto found = run_until("views_output", *adapted, input);
  ASSERT_EQ(found.size(), expected.size());
  for (size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], expected[i], 1e-4) << i;

  // Then they follow the disparity as those of any network of views.
  EXPECT_EQ(adapted->network.layers.back().name, "guided");
  EXPECT_EQ(adapted->network.layers.back().residual, "views_output");
}

TEST(MovedPictures, GiveViewsThatDoNotFollowTheDisparityIfNoTextureIsWeak) {
  model::Model views = small_views();
  views.open_guide = std::make_shared<const model::OpenGuide>(model::OpenGuide{{.weak_texture = 0}, small_model()});
  const auto adapted = for_patterns(views, three_boxes());
  ASSERT_TRUE(adapted) << adapted.error().text();
  EXPECT_EQ(adapted->network.layers.back().name, "views_output");
  views.open_guide = std::make_shared<const model::OpenGuide>(model::OpenGuide{{.weak_texture = -1}, small_model()});
  EXPECT_EQ(for_patterns(views, three_boxes()).error().code, ErrorCode::kInvalidValue);
}

TEST(MovedPictures, LoseInFasterArithmeticWhatTheFileStates) {
  model::Model views = small_views();
  views.precision_loss = {.bfloat16_db = 0.01, .int16_db = 0.002};
  EXPECT_EQ(for_patterns(views, three_boxes()).value().precision_loss, views.precision_loss);
}

/// Disparities made of moved pictures.
model::Model small_depth() {
  model::Model model = small_views();
  model.name = "depth";
  model.network = {model::kMovedPlanes, {conv("output", "input", model::kDepthOutputs, 3, false)}};
  model.weights.clear();
  for (const auto& weights : model::weight_shapes(model.network)) {
    model.weights[weights.name] = numbered(weights.name, weights.shape);
  }
  return model;
}

TEST(MovedPictures, AreWhatAnotherDisparityIsMadeOf) {
  const capture::Codes codes = three_boxes();
  const model::Model network = small_depth();
  const auto adapted = for_patterns(network, codes);
  ASSERT_TRUE(adapted) << adapted.error().text();
  EXPECT_TRUE(model::is_depth_network(*adapted));
  EXPECT_EQ(adapted->name, "depth");
  EXPECT_EQ(adapted->codes, codes);
  const std::vector<float> input = inputs(codes.num_patterns - 1);
  const model::Model first = for_patterns(small_model(), codes).value();
  const MovedPlanes planes(input, run_engine(first.network, first.weights, input, kSize, kSize), codes);
  const auto expected = run_engine(network.network, network.weights, planes.values, kSize, kSize);
  const auto found = run_engine(adapted->network, adapted->weights, input, kSize, kSize);
  ASSERT_EQ(found.size(), expected.size());
  for (size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], expected[i], 1e-4) << i;
}

TEST(MovedPictures, LeaveWholeCyclesToTheFirstDisparity) {
  const capture::Codes cycle = capture::whole_cycle(three_boxes());
  const auto adapted = for_patterns(small_depth(), cycle);
  ASSERT_TRUE(adapted) << adapted.error().text();
  EXPECT_EQ(adapted->network, for_patterns(small_model(), cycle)->network);
}

TEST(MovedPictures, OfE2lfN4StayWhereTheyAre) {
  add_operations();
  const auto model = model::read_model(*bundled_file_named(kBundledModels, "e2lf-n4"));
  const auto aperture = describe_aperture(*model->codes);
  ASSERT_TRUE(aperture) << aperture.error().text();
  ASSERT_EQ(aperture->pictures.size(), kSlots);
  for (size_t p = 0; p < kSlots; ++p) {
    const AperturePicture& picture = aperture->pictures[p];
    EXPECT_NEAR(picture.offset_y, kPlaces[p][0], 1e-6);
    EXPECT_NEAR(picture.offset_x, kPlaces[p][1], 1e-6);
    EXPECT_NEAR(picture.area, kPlaceAreas[p], 1e-9);
    for (size_t place = 0; place < kSlots; ++place) EXPECT_NEAR(picture.places[place], place == p ? 1 : 0, 1e-3);
  }
}

TEST(MovedPictures, AllGiveTheSameInTotalAndEachPlaceTakesOne) {
  Codes two(3, 8, 8), seven(8, 8, 8);
  open_cells(kFirst, 1, two);
  open_cells(kSecond, 2, two);
  for (size_t n = 1; n < 8; ++n) open_cells({n % 5, n % 5 + 2, n - 1, n + 1}, n, seven);
  for (const Codes& codes : {two, three_boxes(), seven}) {
    const auto pictures = describe_aperture(codes)->pictures;
    const double each = 3.0 / static_cast<double>(pictures.size());
    for (const AperturePicture& picture : pictures) {
      EXPECT_NEAR(picture.places[0] + picture.places[1] + picture.places[2], each, 1e-3) << codes.num_patterns;
    }
    for (size_t place = 0; place < kSlots; ++place) {
      double sum = 0;
      for (const AperturePicture& picture : pictures) sum += picture.places[place];
      EXPECT_NEAR(sum, 1, 1e-9) << codes.num_patterns;
    }
  }
}

TEST(MovedPictures, GiveAsManyViewsAsThePatternsHaveCells) {
  Codes of_five(4, 5, 5);
  of_five.pattern(1)[6] = of_five.pattern(2)[8] = of_five.pattern(3)[17] = 1;
  const model::Model views = small_views();
  const auto five = for_patterns(views, of_five);
  ASSERT_TRUE(five) << five.error().text();
  EXPECT_EQ(five->views_y, 5U);
  const std::vector<float> input = inputs(3);
  const auto of_all = run_until("views_output", *five, input), chosen = run_until("own_views", *five, input);
  ASSERT_EQ(chosen.size(), 25 * kSize * kSize);
  for (size_t row = 0; row < 5; ++row) {
    for (size_t column = 0; column < 5; ++column) {
      const size_t own = (5 * row + column) * kSize * kSize, of_eight = (8 * (row + 2) + column + 2) * kSize * kSize;
      for (size_t i = 0; i < kSize * kSize; ++i) ASSERT_NEAR(chosen[own + i], of_all[of_eight + i], 1e-5);
    }
  }
}

TEST(MovedPictures, NeedThePatternsTheirViewsAndTheLitTransitions) {
  const model::Model views = small_views();
  EXPECT_EQ(model::validate(views, "views").error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(for_patterns(views, capture::whole_cycle(three_boxes())).error().code, ErrorCode::kUnsupported);
  Codes of_nine(4, 9, 9);
  for (size_t n = 1; n < 4; ++n) of_nine.pattern(n)[20 * n] = 1;
  EXPECT_EQ(for_patterns(views, of_nine).error().code, ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace e2lf::geometry
