// SPDX-License-Identifier: MIT
#include "e2lf/video/import_event_video.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "e2lf/base/text.h"
#include "testing/event_video_checkpoints.h"
#include "testing/event_video_networks.h"
#include "testing/test_files.h"

namespace e2lf::video {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Result<VideoModel> import_tensors(const Safetensors& tensors, const std::string& as = "") {
  const TestFolder folder;
  EXPECT_TRUE(write_safetensors(folder / "c.safetensors", tensors).ok());
  return import_event_video(folder / "c.safetensors", as);
}

TEST(ImportEventVideo, FireNetAndFireNetPlusAreToldByTheirNames) {
  const auto legacy = import_tensors(firenet_checkpoint(true));
  ASSERT_TRUE(legacy.ok()) << legacy.error().text();
  EXPECT_EQ(legacy->name, "firenet");
  EXPECT_TRUE(legacy->normalises_voxels);
  EXPECT_EQ(legacy->pad_multiple, 16U);
  EXPECT_EQ(num_parameters(legacy->network), 37777U);
  const auto plus = import_tensors(firenet_checkpoint(false));
  ASSERT_TRUE(plus.ok()) << plus.error().text();
  EXPECT_EQ(plus->name, "firenet+");
  EXPECT_FALSE(plus->normalises_voxels);
  EXPECT_EQ(plus->pad_multiple, 1U);
  EXPECT_EQ(plus->network, firenet());
  EXPECT_EQ(legacy->network, firenet());
}

TEST(ImportEventVideo, UpdateGatesStandBeforeResetGates) {
  Safetensors tensors = firenet_checkpoint(false);
  tensors.tensors["G1.update_gate.bias"] = make_npy<float>({16}, std::vector<float>(16, 3.0F));
  tensors.tensors["G1.reset_gate.bias"] = make_npy<float>({16}, std::vector<float>(16, -4.0F));
  const auto model = import_tensors(tensors);
  ASSERT_TRUE(model.ok()) << model.error().text();
  EXPECT_EQ(model->weights.at("cell1.gates.bias")[0], 3.0F);
  EXPECT_EQ(model->weights.at("cell1.gates.bias")[16], -4.0F);
}

TEST(ImportEventVideo, TheUnetHasTheParametersOfE2vidAndItsConventions) {
  const auto plus = import_tensors(unet_checkpoint({.is_normalised = false}));
  ASSERT_TRUE(plus.ok()) << plus.error().text();
  EXPECT_EQ(plus->name, "e2vid+");
  EXPECT_EQ(num_parameters(plus->network), 10710401U);
  EXPECT_EQ(plus->pad_multiple, 8U);
  EXPECT_EQ(plus->network, event_unet());
  const auto e2vid = import_tensors(unet_checkpoint({.is_normalised = true}));
  ASSERT_TRUE(e2vid.ok()) << e2vid.error().text();
  EXPECT_EQ(e2vid->name, "e2vid");
  EXPECT_EQ(e2vid->tone, FrameTone::kRobust);
  EXPECT_TRUE(e2vid->normalises_voxels);
  EXPECT_EQ(e2vid->network, event_unet({.ends_in_sigmoid = true}));
  EXPECT_EQ(import_tensors(unet_checkpoint({.is_normalised = false}), "ssl-e2vid")->tone, FrameTone::kExpRobust);
}

TEST(ImportEventVideo, HyperE2vidHasItsParametersAndThoseThatBringTheContextToItsResolution) {
  const auto model = import_tensors(unet_checkpoint({.is_dynamic = true}));
  ASSERT_TRUE(model.ok()) << model.error().text();
  EXPECT_EQ(model->name, "hypere2vid");
  EXPECT_FALSE(model->normalises_voxels);
  EXPECT_EQ(model->tone, FrameTone::kNone);
  EXPECT_EQ(model->pad_multiple, 8U);
  EXPECT_TRUE(is_recurrent(model->network));
  // The published count, without batch normalisation; sampling at a quarter; 72 coefficients to 150 values of filters.
  EXPECT_EQ(num_parameters(model->network), 10149881U - (2 * 64 + 2 * 72) + (6 * 6 * 16 + 6) + (72 * 150 + 150));
}

TEST(ImportEventVideo, FiltersAreSumsOfBasesAndTheirResultsAreMixedInTheOrderOfTheFilters) {
  Safetensors tensors = unet_checkpoint({.channels = 2, .is_dynamic = true});
  const std::string key = "unetrecurrent.decoders.0.";
  const auto model = import_tensors(tensors);
  ASSERT_TRUE(model.ok()) << model.error().text();
  const auto bases = tensors.tensors.at(key + "dynamic_atom_generation.bases").to_float("b").value();
  const auto& filters = model->weights.at("decoder0_filters.weight");  // [6 * 25, 6 * 12]
  EXPECT_EQ(filters[(2 * 25 + 7) * 72 + 2 * 12 + 5], bases[5 * 25 + 7]);
  EXPECT_EQ(filters[(2 * 25 + 7) * 72 + 3 * 12 + 5], 0.0F);
  const auto mix = tensors.tensors.at(key + "dynamic_conv.compositional_coefficients").to_float("m").value();
  const size_t in = 16;  // channels of [8, 16 * 6]
  EXPECT_EQ(model->weights.at("decoder0.weight")[5 * in * 6 + 4 * in + 9], mix[5 * in * 6 + 9 * 6 + 4]);
}

TEST(ImportEventVideo, RefusesDynamicDecodersThatDoNotFit) {
  const std::string key = "unetrecurrent.decoders.0.dynamic_atom_generation.bases";
  const auto error_with_bases = [&](const std::vector<size_t>& shape) {
    Safetensors tensors = unet_checkpoint({.channels = 2, .is_dynamic = true});
    size_t size = 1;
    for (const size_t extent : shape) size *= extent;
    tensors.tensors[key] = make_npy<float>(shape, std::vector<float>(size, 0.1F));
    const auto model = import_tensors(tensors);
    EXPECT_FALSE(model.ok());
    return model.ok() ? Error{} : model.error();
  };
  for (const std::vector<size_t>& shape :
       {std::vector<size_t>{12, 24}, {12, 16}, {7, 25}, {300}, {12, 0}, {1, 12321}}) {
    const Error error = error_with_bases(shape);
    EXPECT_EQ(error.code, ErrorCode::kShape);
    EXPECT_THAT(error.location, HasSubstr("bases"));
  }
  Safetensors missing = unet_checkpoint({.channels = 2, .is_dynamic = true});
  missing.tensors.erase(key);
  EXPECT_EQ(import_tensors(missing).error().code, ErrorCode::kNotFound);
  EXPECT_THAT(import_tensors(unet_checkpoint({.channels = 2, .is_dynamic = true}), "e2vid").error().message,
              HasSubstr("other layers"));
}

/// A small one of every part.
Safetensors small_transformers() {
  return transformer_checkpoint({.channels = 2, .self_layers = 2, .cross_layers = 1, .wide = 20});
}

TEST(ImportEventVideo, EtNetHasItsParametersAndConventions) {
  const auto model = import_tensors(transformer_checkpoint({}));
  ASSERT_TRUE(model.ok()) << model.error().text();
  EXPECT_EQ(model->name, "et-net");
  EXPECT_FALSE(model->normalises_voxels);
  EXPECT_EQ(model->tone, FrameTone::kNone);
  EXPECT_EQ(model->pad_multiple, 8U);
  EXPECT_EQ(num_parameters(model->network), 22175361U);
  EXPECT_EQ(model->network, event_transformer());
  const auto small = import_tensors(small_transformers());
  ASSERT_TRUE(small.ok()) << small.error().text();
  EXPECT_EQ(small->network, event_transformer({.channels = 2, .self_layers = 2, .cross_layers = 1, .wide = 20}));
}

TEST(ImportEventVideo, AttentionHasQueriesKeysAndValuesInThisOrder) {
  const Safetensors tensors = small_transformers();
  const auto model = import_tensors(tensors);
  ASSERT_TRUE(model.ok()) << model.error().text();
  const std::string key = "trans_decoder1.decoder.layers.0.cross_attn.in_proj_";
  const auto weight = tensors.tensors.at(key + "weight").to_float("w").value();  // [48, 16]
  const auto bias = tensors.tensors.at(key + "bias").to_float("b").value();
  EXPECT_EQ(model->weights.at("cross1_0_cross_query.weight")[3 * 16 + 5], weight[3 * 16 + 5]);
  EXPECT_EQ(model->weights.at("cross1_0_cross_key.weight")[3 * 16 + 5], weight[(16 + 3) * 16 + 5]);
  EXPECT_EQ(model->weights.at("cross1_0_cross_value.weight")[3 * 16 + 5], weight[(32 + 3) * 16 + 5]);
  EXPECT_EQ(model->weights.at("cross1_0_cross_value.bias")[3], bias[35]);
}

TEST(ImportEventVideo, ATableOfPositionsMustBeOfSines) {
  Safetensors tensors = small_transformers();
  std::vector<float> table(size_t{40} * 16);
  for (size_t i = 0; i < table.size(); ++i) {
    const double angle = static_cast<double>(i / 16) / std::pow(10000.0, static_cast<double>(i % 16 / 2) / 8.0);
    table[i] = static_cast<float>(i % 2 == 0 ? std::sin(angle) : std::cos(angle));
  }
  tensors.tensors["position_embedding.pos_table"] = make_npy<float>({1, 40, 16}, table);
  EXPECT_TRUE(import_tensors(tensors).ok());
  table[300] += 0.1F;
  tensors.tensors["position_embedding.pos_table"] = make_npy<float>({1, 40, 16}, table);
  EXPECT_EQ(import_tensors(tensors).error().code, ErrorCode::kUnsupported);
}

TEST(ImportEventVideo, RefusesTransformersThatDoNotFit) {
  const auto error_after = [](const std::string& name, const std::vector<size_t>& shape) {
    Safetensors tensors = small_transformers();
    size_t size = 1;
    for (const size_t extent : shape) size *= extent;
    if (shape.empty()) {
      tensors.tensors.erase(name);
    } else {
      tensors.tensors[name] = make_npy<float>(shape, std::vector<float>(size, 0.1F));
    }
    const auto model = import_tensors(tensors);
    EXPECT_FALSE(model.ok()) << name;
    return model.ok() ? ErrorCode::kIo : model.error().code;
  };
  const std::string layer = "trans_encoder1.encoder.layers.1.";
  EXPECT_EQ(error_after(layer + "self_attn.in_proj_weight", {47, 16}), ErrorCode::kShape);
  EXPECT_EQ(error_after(layer + "self_attn.in_proj_weight", {36, 12}), ErrorCode::kShape);
  EXPECT_EQ(error_after(layer + "self_attn.in_proj_bias", {16}), ErrorCode::kShape);
  EXPECT_EQ(error_after(layer + "linear1.weight", {20}), ErrorCode::kShape);
  EXPECT_EQ(error_after(layer + "linear1.weight", {20, 17}), ErrorCode::kShape);
  EXPECT_EQ(error_after(layer + "norm2.weight", {15}), ErrorCode::kShape);
  EXPECT_EQ(error_after(layer + "norm2.bias", {}), ErrorCode::kNotFound);
  EXPECT_EQ(error_after(layer + "linear1.weight", {}), ErrorCode::kFormat);  // of a layer that is no more
  EXPECT_EQ(error_after("trans_decoder2.decoder.layers.0.linear1.weight", {}), ErrorCode::kNotFound);
  EXPECT_EQ(error_after("split1.weight", {16, 8, 4, 4}), ErrorCode::kInvalidValue);
  EXPECT_THAT(import_tensors(small_transformers(), "e2vid").error().message, HasSubstr("other layers"));
}

TEST(ImportEventVideo, FoldsBatchNormalisationIntoTheConvolutionBeforeIt) {
  Safetensors tensors = unet_checkpoint({.is_normalised = true, .channels = 2});
  const std::string key = "unetrecurrent.encoders.0.conv.";
  tensors.tensors[key + "norm_layer.running_mean"] = make_npy<float>({4}, std::vector<float>{1, 2, 3, 4});
  tensors.tensors[key + "norm_layer.running_var"] = make_npy<float>({4}, std::vector<float>{4, 4, 4, 4});
  tensors.tensors[key + "norm_layer.weight"] = make_npy<float>({4}, std::vector<float>{6, 6, 6, 6});
  tensors.tensors[key + "norm_layer.bias"] = make_npy<float>({4}, std::vector<float>{10, 20, 30, 40});
  const auto model = import_tensors(tensors);
  ASSERT_TRUE(model.ok()) << model.error().text();
  const auto before = tensors.tensors.at(key + "conv2d.weight").to_float("w").value();
  const auto& after = model->weights.at("encoder0.weight");
  const double factor = 6.0 / std::sqrt(4.0 + 1e-5);
  ASSERT_EQ(before.size(), after.size());
  for (size_t i = 0; i < after.size(); ++i) EXPECT_NEAR(after[i], factor * before[i], 1e-5);
  EXPECT_NEAR(model->weights.at("encoder0.bias")[2], 30.0 - 3.0 * factor, 1e-5);
}

TEST(ImportEventVideo, KeepsThePictureOfSeveralOutputs) {
  Safetensors tensors = unet_checkpoint({.is_normalised = false, .channels = 2});
  tensors.tensors["unetrecurrent.pred.conv2d.weight"] =
      make_npy<float>({3, 2, 1, 1}, std::vector<float>{1, 2, 3, 4, 5, 6});
  tensors.tensors["unetrecurrent.pred.conv2d.bias"] = make_npy<float>({3}, std::vector<float>{7, 8, 9});
  const auto model = import_tensors(tensors);
  ASSERT_TRUE(model.ok()) << model.error().text();
  EXPECT_THAT(model->weights.at("picture.weight"), ElementsAre(1, 2));
  EXPECT_THAT(model->weights.at("picture.bias"), ElementsAre(7));
}

TEST(ImportEventVideo, RefusesWhatItDoesNotKnow) {
  Safetensors other;
  other.tensors["a.weight"] = make_npy<float>({1}, std::vector<float>{1});
  EXPECT_THAT(import_tensors(other).error().message, HasSubstr("firenet+"));

  Safetensors extra = firenet_checkpoint(false);
  extra.tensors["G3.update_gate.weight"] = make_npy<float>({1}, std::vector<float>{1});
  EXPECT_THAT(import_tensors(extra).error().location, HasSubstr("G3.update_gate.weight"));

  Safetensors missing = firenet_checkpoint(false);
  missing.tensors.erase("R2.conv2.weight");
  EXPECT_EQ(import_tensors(missing).error().code, ErrorCode::kNotFound);

  Safetensors misfit = firenet_checkpoint(false);
  misfit.tensors["G1.reset_gate.weight"] = make_npy<float>({16, 32, 1, 1}, std::vector<float>(512));
  EXPECT_EQ(import_tensors(misfit).error().code, ErrorCode::kShape);

  Safetensors empty = firenet_checkpoint(false);
  empty.tensors["pred.conv2d.weight"] = make_npy<float>({0, 16, 1, 1}, std::vector<float>());
  EXPECT_EQ(import_tensors(empty).error().code, ErrorCode::kShape);

  EXPECT_THAT(import_tensors(firenet_checkpoint(false), "e2vid").error().message, HasSubstr("other layers"));
  EXPECT_THAT(import_tensors(firenet_checkpoint(false), "hyper").error().message, HasSubstr("known are"));

  Safetensors transposed = unet_checkpoint({.is_normalised = false, .channels = 2});
  transposed.tensors["unetrecurrent.decoders.1.transposed_conv2d.weight"] = make_npy<float>({1}, std::vector<float>{1});
  EXPECT_EQ(import_tensors(transposed).error().code, ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace e2lf::video
