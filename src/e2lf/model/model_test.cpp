// SPDX-License-Identifier: MIT
#include "e2lf/model/model.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "e2lf/files/file.h"
#include "e2lf/files/safetensors.h"
#include "testing/test_files.h"

namespace e2lf::model {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

/// A small model for the default codes: two layers, two input groups.
Model small_model() {
  Model model;
  model.name = "small";
  model.num_patterns = 4;
  model.codes = capture::default_codes();
  model.constants = {0.02F, 0.3F, 0.1F, 0.0F};
  model.input = {{InputKind::kCounts, 0.125F}, {InputKind::kIntensity, 4.0F}};
  model.network.input_channels = 6;
  Layer first;
  first.name = "a";
  first.inputs = {"input"};
  first.out_channels = 5;
  first.kernel = 3;
  first.relu = true;
  Layer second;
  second.name = "b";
  second.inputs = {"a"};
  second.out_channels = 64;
  model.network.layers = {first, second};
  float value = 0.0F;
  for (const WeightShape& tensor : weight_shapes(model.network)) {
    size_t size = 1;
    for (const size_t extent : tensor.shape) size *= extent;
    for (size_t i = 0; i < size; ++i) model.weights[tensor.name].push_back(value += 0.25F);
  }
  model.provenance = {{"seed", 7}, {"command", "e2lf train"}};
  return model;
}

/// The small model's file, changed by `change`, read again.
template <typename Change>
Error error_after(const Change& change) {
  const TestFolder folder;
  EXPECT_TRUE(write_model(folder / "m.safetensors", small_model()).ok());
  Safetensors file = *read_safetensors(folder / "m.safetensors");
  change(file);
  EXPECT_TRUE(write_safetensors(folder / "m.safetensors", file).ok());
  const auto model = read_model(folder / "m.safetensors");
  EXPECT_FALSE(model.ok());
  return model.ok() ? Error{} : model.error();
}

/// The same with a change of the JSON in its metadata.
template <typename Change>
Error error_after_json(const Change& change) {
  return error_after([&](Safetensors& file) {
    Json json = Json::parse(file.metadata.at("e2lf"));
    change(json);
    file.metadata["e2lf"] = json.dump();
  });
}

TEST(ModelFile, RoundTripsEveryField) {
  const TestFolder folder;
  Model model = small_model();
  model.precision_loss = {.bfloat16_db = 0.25, .int16_db = std::nullopt};
  ASSERT_TRUE(write_model(folder / "m.safetensors", model).ok());
  const auto read = read_model(folder / "m.safetensors");
  ASSERT_TRUE(read.ok()) << read.error().text();
  EXPECT_EQ(read->name, model.name);
  EXPECT_EQ(read->num_patterns, model.num_patterns);
  EXPECT_EQ(read->views_y, model.views_y);
  EXPECT_EQ(read->views_x, model.views_x);
  EXPECT_EQ(read->codes, model.codes);
  EXPECT_EQ(read->event_model, model.event_model);
  EXPECT_EQ(read->black_first, model.black_first);
  EXPECT_EQ(read->constants, model.constants);
  EXPECT_EQ(read->input, model.input);
  EXPECT_EQ(read->network, model.network);
  EXPECT_EQ(read->weights, model.weights);
  EXPECT_EQ(read->precision_loss, model.precision_loss);
  EXPECT_EQ(read->provenance, model.provenance);
}

TEST(ModelFile, StoresWeightsInHalfTheRoomRoundedToTheNearest) {
  const TestFolder folder;
  Model model = small_model();
  std::vector<float>& weights = model.weights.begin()->second;
  // 1 + 2^-8 is a tie between 1 and 1 + 2^-7, 1 + 3 * 2^-8 one between that and 1 + 2^-6: both go to the even one.
  weights[0] = 1.0F + 0x1p-8F;
  weights[1] = -(1.0F + 0x1.8p-7F);
  ASSERT_TRUE(write_model(folder / "m.safetensors", model, WeightStorage::kBfloat16).ok());
  const auto read = read_model(folder / "m.safetensors");
  ASSERT_TRUE(read.ok()) << read.error().text();
  EXPECT_EQ(read->weights.begin()->second[0], 1.0F);
  EXPECT_EQ(read->weights.begin()->second[1], -(1.0F + 0x1p-6F));
  EXPECT_EQ(read->codes, model.codes);
  for (const auto& [name, values] : model.weights) {
    const auto& stored = read->weights.at(name);
    for (size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(stored[i], values[i], 0x1p-8F * std::abs(values[i])) << name;
  }
}

TEST(ModelFile, ReadsWeightsInHalfPrecisionBesideOthers) {
  const TestFolder folder;
  const Model model = small_model();
  ASSERT_TRUE(write_model(folder / "m.safetensors", model).ok());
  Safetensors file = *read_safetensors(folder / "m.safetensors");
  // 64 times 1.5, the third of which is -0.25.
  std::vector<uint16_t> halves(64, 0x3E00);
  halves[2] = 0xB400;
  file.tensors["b.bias"] = make_npy<uint16_t>({64}, halves);
  file.tensors["b.bias"].type = "f2";
  ASSERT_TRUE(write_safetensors(folder / "m.safetensors", file).ok());
  const auto read = read_model(folder / "m.safetensors");
  ASSERT_TRUE(read.ok()) << read.error().text();
  std::vector<float> expected(64, 1.5F);
  expected[2] = -0.25F;
  EXPECT_EQ(read->weights.at("b.bias"), expected);
  EXPECT_EQ(read->weights.at("b.weight"), model.weights.at("b.weight"));
}

/// A model with two layers that have the same weights, and their sum as the output.
Model model_with_equal_layers() {
  Model model = small_model();
  Layer& first = model.network.layers.front();
  first.out_channels = 64;
  Layer& second = model.network.layers.back();
  second = first;
  second.name = "b";
  Layer sum;
  sum.name = "sum";
  sum.op = Op::kAdd;
  sum.inputs = {"a", "b"};
  model.network.layers.push_back(sum);
  model.weights.clear();
  for (const WeightShape& tensor : weight_shapes(model.network)) {
    size_t size = 1;
    for (const size_t extent : tensor.shape) size *= extent;
    for (size_t i = 0; i < size; ++i) model.weights[tensor.name].push_back(static_cast<float>(i) * 0.5F);
  }
  return model;
}

TEST(ModelFile, StoresWeightsThatTwoLayersHaveOnce) {
  const TestFolder folder;
  const Model model = model_with_equal_layers();
  ASSERT_TRUE(write_model(folder / "m.safetensors", model).ok());
  const Safetensors file = *read_safetensors(folder / "m.safetensors");
  EXPECT_TRUE(file.tensors.contains("a.weight"));
  EXPECT_FALSE(file.tensors.contains("b.weight"));
  EXPECT_TRUE(file.tensors.contains("b.bias"));  // 64 values are too few
  const auto read = read_model(folder / "m.safetensors");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->weights, model.weights);
}

TEST(ModelFile, RefusesWeightsThatAreSharedTwiceOrWithoutASource) {
  const TestFolder folder;
  ASSERT_TRUE(write_model(folder / "m.safetensors", model_with_equal_layers()).ok());
  const Safetensors written = *read_safetensors(folder / "m.safetensors");
  const auto error_with = [&](const char* shared) {
    Safetensors file = written;
    Json header = Json::parse(file.metadata.at("e2lf"));
    header["shared_weights"] = Json::parse(shared);
    file.metadata["e2lf"] = header.dump();
    EXPECT_TRUE(write_safetensors(folder / "m.safetensors", file).ok());
    const auto model = read_model(folder / "m.safetensors");
    EXPECT_FALSE(model.ok()) << shared;
    return model.ok() ? Error{} : model.error();
  };
  for (const char* twice : {R"({"b.weight": "a.weight", "c.weight": "a.weight"})", R"({"a.weight": "b.weight"})",
                            R"({"b.weight": "c.weight", "c.weight": "a.weight"})"}) {
    const Error error = error_with(twice);
    EXPECT_THAT(error.message, HasSubstr("share")) << twice;
  }
  EXPECT_EQ(error_with(R"({"b.weight": "aa.weight"})").code, ErrorCode::kNotFound);
  EXPECT_THAT(error_with(R"({"b.weight": 1})").location, HasSubstr("$.shared_weights.b.weight"));
  EXPECT_THAT(error_with("[]").location, EndsWith("$.shared_weights"));
}

TEST(ModelFile, RoundTripsWithoutCodes) {
  const TestFolder folder;
  Model model = small_model();
  model.codes.reset();
  model.black_first = false;
  model.event_model = "quantised";
  ASSERT_TRUE(write_model(folder / "m.safetensors", model).ok());
  const auto read = read_model(folder / "m.safetensors");
  ASSERT_TRUE(read.ok()) << read.error().text();
  EXPECT_FALSE(read->codes.has_value());
  EXPECT_FALSE(read->black_first);
  EXPECT_EQ(read->event_model, "quantised");
}

TEST(ModelFile, NamesAFileThatIsMissingOrCutOff) {
  const TestFolder folder;
  EXPECT_EQ(read_model(folder / "none.safetensors").error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(write_model(folder / "m.safetensors", small_model()).ok());
  const auto bytes = *read_file(folder / "m.safetensors");
  for (const size_t size : {size_t{0}, size_t{7}, size_t{100}, bytes.size() - 1}) {
    ASSERT_TRUE(write_file(folder / "cut.safetensors", std::span(bytes).first(size)).ok());
    const Error error = read_model(folder / "cut.safetensors").error();
    EXPECT_EQ(error.code, ErrorCode::kTruncated) << size;
    EXPECT_THAT(error.location, HasSubstr("cut.safetensors")) << size;
  }
}

TEST(ModelFile, RefusesAHeaderLargerThanTheFile) {
  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "m.safetensors", std::vector<uint8_t>{0, 0, 0, 0, 0, 0, 0, 1, '{', '}'}).ok());
  const Error error = read_model(folder / "m.safetensors").error();
  EXPECT_EQ(error.code, ErrorCode::kTruncated);
  EXPECT_THAT(error.message, HasSubstr("file"));
}

TEST(ModelFile, RefusesSafetensorsThatHoldNoModel) {
  const Error error = error_after([](Safetensors& file) { file.metadata.clear(); });
  EXPECT_EQ(error.code, ErrorCode::kFormat);
  EXPECT_THAT(error.message, HasSubstr("e2lf model import"));
  EXPECT_EQ(error_after([](Safetensors& file) { file.metadata["e2lf"] = "{"; }).code, ErrorCode::kFormat);
  EXPECT_EQ(error_after([](Safetensors& file) { file.metadata["e2lf"] = "[]"; }).code, ErrorCode::kFormat);
}

TEST(ModelFile, RefusesAnUnknownVersion) {
  for (const Json& version : {Json(2), Json("1"), Json()}) {
    const Error error = error_after_json([&](Json& json) {
      json["format_version"] = version;
      json["a key of the future"] = 1;
    });
    EXPECT_EQ(error.code, ErrorCode::kUnsupported) << version;
    EXPECT_THAT(error.location, EndsWith("m.safetensors: e2lf: $.format_version"));
  }
}

TEST(ModelFile, RefusesAnUnknownNetworkType) {
  const Error error = error_after_json([](Json& json) { json["network"] = {{"type", "transformer"}, {"heads", 8}}; });
  EXPECT_EQ(error.code, ErrorCode::kUnsupported);
  EXPECT_THAT(error.location, EndsWith("m.safetensors: e2lf: $.network.type"));
  EXPECT_THAT(error.message, HasSubstr("conv-graph"));
}

TEST(ModelFile, RefusesUnknownKeysInputsAndTypes) {
  const Error key = error_after_json([](Json& json) { json["constants"]["sigma"] = 1; });
  EXPECT_THAT(key.location, EndsWith("m.safetensors: e2lf: $.constants.sigma"));
  EXPECT_THAT(key.message, HasSubstr("sigma_"));
  const Error kind = error_after_json([](Json& json) { json["input"][1]["kind"] = "voxels"; });
  EXPECT_EQ(kind.code, ErrorCode::kUnsupported);
  EXPECT_THAT(kind.location, EndsWith("$.input[1].kind"));
  EXPECT_THAT(kind.message, HasSubstr("intensity"));
  EXPECT_EQ(error_after_json([](Json& json) { json["input"] = 3; }).code, ErrorCode::kFormat);
  EXPECT_EQ(error_after_json([](Json& json) { json["num_patterns"] = -4; }).code, ErrorCode::kInvalidValue);
  EXPECT_EQ(error_after_json([](Json& json) { json["provenance"] = "me"; }).code, ErrorCode::kInvalidValue);
}

TEST(ModelFile, RefusesWeightsOfTheWrongShape) {
  const Error error = error_after([](Safetensors& file) { file.tensors["a.weight"].shape = {6, 5, 3, 3}; });
  EXPECT_EQ(error.code, ErrorCode::kShape);
  EXPECT_THAT(error.location, EndsWith("m.safetensors: a.weight"));
  EXPECT_THAT(error.message, HasSubstr("[6, 5, 3, 3]"));
  EXPECT_THAT(error.message, HasSubstr("[5, 6, 3, 3]"));
}

TEST(ModelFile, RefusesMissingSurplusAndOtherThanFloatWeights) {
  const Error missing = error_after([](Safetensors& file) { file.tensors.erase("b.bias"); });
  EXPECT_EQ(missing.code, ErrorCode::kNotFound);
  EXPECT_THAT(missing.message, HasSubstr("b.bias"));
  const Error surplus =
      error_after([](Safetensors& file) { file.tensors["c.bias"] = make_npy<float>({1}, std::vector<float>{1.0F}); });
  EXPECT_EQ(surplus.code, ErrorCode::kFormat);
  EXPECT_THAT(surplus.location, EndsWith("m.safetensors: c.bias"));
  const Error bytes = error_after(
      [](Safetensors& file) { file.tensors["b.bias"] = make_npy<uint8_t>({64}, std::vector<uint8_t>(64)); });
  EXPECT_EQ(bytes.code, ErrorCode::kUnsupported);
  EXPECT_THAT(bytes.location, EndsWith("m.safetensors: b.bias"));
}

TEST(ModelFile, RefusesWeightsThatAreNotFinite) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    std::vector<float> values(64);
    values[5] = bad;
    const Error error = error_after([&](Safetensors& file) { file.tensors["b.bias"] = make_npy<float>({64}, values); });
    EXPECT_EQ(error.code, ErrorCode::kInvalidValue);
    EXPECT_THAT(error.location, EndsWith("m.safetensors: b.bias"));
    EXPECT_THAT(error.message, HasSubstr("weight 5"));
  }
}

TEST(ModelFile, RefusesCodesOfTheWrongSizeOrValue) {
  const auto set_codes = [](std::vector<size_t> shape, std::vector<float> values) {
    return error_after([&](Safetensors& file) { file.tensors["aperture.codes"] = make_npy<float>(shape, values); });
  };
  const Error shape = set_codes({3, 8, 8}, std::vector<float>(192));
  EXPECT_EQ(shape.code, ErrorCode::kShape);
  EXPECT_THAT(shape.location, EndsWith("m.safetensors: aperture.codes"));
  EXPECT_THAT(shape.message, HasSubstr("[4, 8, 8]"));
  EXPECT_EQ(set_codes({256}, std::vector<float>(256)).code, ErrorCode::kShape);
  EXPECT_EQ(set_codes({4, 8, 8}, std::vector<float>(256, NAN)).code, ErrorCode::kInvalidValue);
}

TEST(ModelFile, DoesNotReplaceAFileByAModelThatIsNotValid) {
  const TestFolder folder;
  ASSERT_TRUE(write_model(folder / "m.safetensors", small_model()).ok());
  Model bad = small_model();
  bad.weights["a.bias"].clear();
  EXPECT_EQ(write_model(folder / "m.safetensors", bad).error().code, ErrorCode::kShape);
  EXPECT_TRUE(read_model(folder / "m.safetensors").ok());
}

TEST(ModelValidate, NamesTheFieldThatDoesNotFit) {
  struct Case {
    const char* field;
    ErrorCode code;
    void (*change)(Model&);
  };
  const Case cases[] = {
      {"num_patterns", ErrorCode::kInvalidValue, [](Model& m) { m.num_patterns = 1; }},
      {"num_patterns", ErrorCode::kInvalidValue, [](Model& m) { m.num_patterns = ~size_t{0}; }},
      {"views_x", ErrorCode::kInvalidValue, [](Model& m) { m.views_x = 0; }},
      {"event_model", ErrorCode::kInvalidValue, [](Model& m) { m.event_model = "frames"; }},
      {"constants.eps", ErrorCode::kInvalidValue, [](Model& m) { m.constants.eps = 0.0F; }},
      {"constants.tau", ErrorCode::kInvalidValue, [](Model& m) { m.constants.tau = NAN; }},
      {"constants.sigma_z", ErrorCode::kInvalidValue, [](Model& m) { m.constants.sigma_z = -1.0F; }},
      {"input", ErrorCode::kInvalidValue, [](Model& m) { m.input.clear(); }},
      {"input[1].scale", ErrorCode::kInvalidValue, [](Model& m) { m.input[1].scale = 0.0F; }},
      {"network.input_channels", ErrorCode::kShape, [](Model& m) { m.num_patterns = 5; }},
      {"network", ErrorCode::kShape, [](Model& m) { m.network.layers.pop_back(); }},
      {"network: layer \"b\"", ErrorCode::kInvalidValue, [](Model& m) { m.network.layers[1].kernel = 2; }},
      {"aperture.codes", ErrorCode::kShape, [](Model& m) { m.codes = capture::Codes(4, 4, 16); }},
      {"aperture.codes", ErrorCode::kInvalidValue, [](Model& m) { m.codes->values[70] = 2.0F; }},
      {"black_first", ErrorCode::kInvalidValue, [](Model& m) { m.black_first = false; }},
      {"a.bias", ErrorCode::kNotFound, [](Model& m) { m.weights.erase("a.bias"); }},
      {"a.bias", ErrorCode::kShape, [](Model& m) { m.weights["a.bias"].push_back(0.0F); }},
      {"a.bias", ErrorCode::kInvalidValue, [](Model& m) { m.weights["a.bias"][2] = NAN; }},
      {"z", ErrorCode::kFormat, [](Model& m) { m.weights["z"] = {}; }},
      {"provenance", ErrorCode::kInvalidValue, [](Model& m) { m.provenance = 3; }},
  };
  ASSERT_TRUE(validate(small_model(), "m").ok());
  for (const Case& test : cases) {
    Model model = small_model();
    test.change(model);
    const auto status = validate(model, "m");
    ASSERT_FALSE(status.ok()) << test.field;
    EXPECT_EQ(status.error().code, test.code) << status.error().text();
    EXPECT_EQ(status.error().location, std::string("m: ") + test.field) << status.error().text();
  }
}

TEST(ModelSummary, TellsWhatTheModelIs) {
  const Json json = summary_json(small_model());
  EXPECT_EQ(json["name"], "small");
  EXPECT_EQ(json["num_patterns"], 4);
  EXPECT_EQ(json["constants"]["eps"], 0.02);
  EXPECT_EQ(json["network"]["layers"], 2);
  EXPECT_EQ(json["network"]["parameters"], 6 * 5 * 9 + 5 + 5 * 64 + 64);
  EXPECT_EQ(json["network"]["macs_per_pixel"], 6 * 5 * 9 + 5 * 64);
  EXPECT_EQ(json["network"]["receptive_field_px"], 3);
  EXPECT_EQ(json["codes"]["light_efficiency"], Json({0.0, 0.1875, 0.1875, 0.1875}));
  EXPECT_EQ(json["provenance"]["seed"], 7);
}

TEST(ModelSummary, DoesWithoutCodes) {
  Model model = small_model();
  model.codes.reset();
  EXPECT_TRUE(summary_json(model)["codes"].is_null());
}

TEST(ImportRelease, GivesAModelThatRoundTrips) {
  E2LF_REQUIRE_DATA("official/RecNet.safetensors");
  const TestFolder folder;
  const auto model = import_release(test_data("official"));
  ASSERT_TRUE(model.ok()) << model.error().text();
  EXPECT_EQ(model->num_patterns, 4U);
  EXPECT_THAT(model->input, ElementsAre(InputGroup{InputKind::kCounts, 0.125F}));
  EXPECT_EQ(model->constants, capture::SensorConstants());
  EXPECT_EQ(model->network, recnet(3));
  ASSERT_TRUE(model->codes.has_value());
  EXPECT_TRUE(capture::is_binary(*model->codes));
  // Blobs of 9, 12 and 11 open cells after the black pattern.
  EXPECT_THAT(capture::light_efficiency(*model->codes), ElementsAre(0.0F, 9.0F / 64, 12.0F / 64, 11.0F / 64));
  EXPECT_THAT(model->provenance.dump(), HasSubstr("released weights"));
  EXPECT_EQ(num_parameters(model->network), 948352U);
  ASSERT_TRUE(write_model(folder / "m.safetensors", *model).ok());
  const auto read = read_model(folder / "m.safetensors");
  ASSERT_TRUE(read.ok()) << read.error().text();
  EXPECT_EQ(read->weights, model->weights);
  EXPECT_EQ(read->codes, model->codes);
}

TEST(ImportRelease, PlacesTheBlobsWhereTheReleaseHasThem) {
  E2LF_REQUIRE_DATA("official/AcqNet.safetensors");
  const auto model = import_release(test_data("official"));
  ASSERT_TRUE(model.ok()) << model.error().text();
  // Upper left, lower centre, upper right: centres of gravity against the centre of the aperture.
  const auto centre = [&](size_t n) {
    double y = 0.0, x = 0.0, sum = 0.0;
    for (size_t cell = 0; cell < 64; ++cell) {
      const double value = model->codes->pattern(n)[cell];
      y += value * (static_cast<double>(cell / 8) - 3.5);
      x += value * (static_cast<double>(cell % 8) - 3.5);
      sum += value;
    }
    return std::pair(y / sum, x / sum);
  };
  EXPECT_LT(centre(1).first, -1.0);
  EXPECT_LT(centre(1).second, -1.0);
  EXPECT_GT(centre(2).first, 1.0);
  EXPECT_LT(std::abs(centre(2).second), 1.0);
  EXPECT_LT(centre(3).first, -1.0);
  EXPECT_GT(centre(3).second, 1.0);
}

TEST(ImportRelease, NamesWhatIsMissingOrOfAnotherShape) {
  const TestFolder folder;
  EXPECT_EQ(import_release(folder.path()).error().code, ErrorCode::kNotFound);
  Safetensors network;
  for (const WeightShape& tensor : weight_shapes(recnet(3))) {
    size_t size = 1;
    for (const size_t extent : tensor.shape) size *= extent;
    network.tensors[tensor.name] = make_npy<float>(tensor.shape, std::vector<float>(size));
  }
  Safetensors patterns;
  patterns.tensors["mask_4x64"] = make_npy<float>({4, 64}, std::vector<float>(256));
  ASSERT_TRUE(write_safetensors(folder / "RecNet.safetensors", network).ok());
  EXPECT_THAT(import_release(folder.path()).error().location, EndsWith("AcqNet.safetensors"));
  ASSERT_TRUE(write_safetensors(folder / "AcqNet.safetensors", patterns).ok());
  EXPECT_TRUE(import_release(folder.path()).ok());
  patterns.tensors["mask_4x64"].shape = {64, 4};
  ASSERT_TRUE(write_safetensors(folder / "AcqNet.safetensors", patterns).ok());
  EXPECT_EQ(import_release(folder.path()).error().code, ErrorCode::kShape);
  network.tensors["l7.weight"].shape = {64, 64, 9, 1};
  ASSERT_TRUE(write_safetensors(folder / "RecNet.safetensors", network).ok());
  const Error error = import_release(folder.path()).error();
  EXPECT_EQ(error.code, ErrorCode::kShape);
  EXPECT_THAT(error.location, EndsWith("RecNet.safetensors: l7.weight"));
}

/// The small model for another measurement.
Model image_model(std::vector<InputGroup> input, size_t num_patterns) {
  Model model = small_model();
  model.input = std::move(input);
  model.num_patterns = num_patterns;
  model.codes = capture::Codes(num_patterns, 8, 8);
  for (float& cell : model.codes->values) cell = 1.0F;
  model.black_first = false;
  model.constants.sigma_i = 0.02F;
  model.network.input_channels = num_input_channels(model.input, num_patterns);
  model.weights["a.weight"].resize(5 * model.network.input_channels * 9, 0.5F);
  return model;
}

TEST(Measurement, IsWrittenAndReadWhereItIsNotEventImages) {
  const TestFolder folder;
  const std::vector<std::pair<Model, capture::MeasurementKind>> models = {
      {image_model({{InputKind::kImages, 4.0F}}, 1), capture::MeasurementKind::kCodedImages},
      {image_model({{InputKind::kImages, 4.0F}}, 4), capture::MeasurementKind::kCodedImages},
      {image_model({{InputKind::kCounts, 0.125F}, {InputKind::kImageSum, 1.0F}}, 4), capture::MeasurementKind::kHybrid},
      {image_model({{InputKind::kLensArray, 1.0F}}, 1), capture::MeasurementKind::kLensArray},
      {small_model(), capture::MeasurementKind::kEventImages}};
  for (const auto& [model, kind] : models) {
    EXPECT_EQ(model.measurement(), kind);
    const auto written = write_model(folder / "m.safetensors", model);
    ASSERT_TRUE(written) << written.error().text();
    const auto read = read_model(folder / "m.safetensors");
    ASSERT_TRUE(read) << read.error().text();
    EXPECT_EQ(read->measurement(), kind);
    EXPECT_EQ(read->input, model.input);
    EXPECT_EQ(read->constants, model.constants);
    EXPECT_EQ(summary_json(*read)["measurement"], capture::measurement_name(kind));
    const Safetensors file = *read_safetensors(folder / "m.safetensors");
    const bool is_said = Json::parse(file.metadata.at("e2lf")).contains("measurement");
    EXPECT_EQ(is_said, kind != capture::MeasurementKind::kEventImages) << "old readers know files of event images";
  }
}

TEST(Measurement, MustFitInputAndPatterns) {
  EXPECT_THAT(error_after([](Safetensors& file) {
                Json header = Json::parse(file.metadata["e2lf"]);
                header["measurement"] = "hybrid";
                file.metadata["e2lf"] = header.dump();
              }).message,
              HasSubstr("input"));
  EXPECT_THAT(validate(image_model({{InputKind::kImages, 1.0F}, {InputKind::kCounts, 1.0F}}, 4), "m").error().message,
              HasSubstr("no measurement provides"));
  EXPECT_THAT(validate(image_model({{InputKind::kLensArray, 1.0F}}, 2), "m").error().message, HasSubstr("one pattern"));
  EXPECT_THAT(validate(image_model({{InputKind::kCounts, 1.0F}, {InputKind::kImageSum, 1.0F}}, 1), "m").error().message,
              HasSubstr("use 2 to"));
}

}  // namespace
}  // namespace e2lf::model
