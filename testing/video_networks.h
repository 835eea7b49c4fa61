// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/video/operations.h"
#include "testing/test_networks.h"

namespace e2lf::video {

using engine::conv, engine::reshape, engine::TestNetwork;

inline const bool kHasOperations = (add_operations(), true);

inline model::Layer cell(const std::string& name, const std::string& op, const std::string& input, size_t out,
                         size_t kernel) {
  model::Layer layer = conv(name, input, out, kernel, false);
  layer.op = op;
  return layer;
}

inline model::Layer previous(const std::string& name, size_t channels) {
  model::Layer layer = reshape(name, VideoOp::kPrevious, {});
  layer.out_channels = channels;
  return layer;
}

inline model::Layer attention(const std::string& name, std::vector<std::string> inputs, size_t heads) {
  model::Layer layer = reshape(name, VideoOp::kAttention, std::move(inputs));
  layer.attributes["heads"] = {static_cast<double>(heads)};
  return layer;
}

/// Returns networks whose pixels depend on the whole image, with heads of several sizes, surrounded by layers that run
/// row by row.
inline std::vector<TestNetwork> whole_image_networks() {
  std::vector<TestNetwork> list;
  list.push_back(
      {"attention",
       {3,
        {conv("a", "input", 48, 3), conv("q", "a", 48, 1, false), conv("k", "a", 48, 3, false),
         conv("v", "a", 48, 1, false), attention("look", {"q", "k", "v"}, 3), conv("out", "look", 48, 1, false, "a")}},
       1});
  list.push_back({"odd heads", {2, {conv("a", "input", 21, 3, false), attention("out", {"a", "a", "a"}, 3)}}, 1});
  list.push_back({"norm",
                  {5,
                   {conv("a", "input", 37, 3, false), reshape("norm", VideoOp::kLayerNorm, {"a"}),
                    reshape("out", VideoOp::kPositionCode, {"norm"})}},
                  1});
  list.push_back({"two scales",
                  {4,
                   {conv("head", "input", 12, 5),
                    conv("half", "head", 32, 5, true, "", 2),
                    conv("split", "head", 32, 2, false, "", 2),
                    reshape("place1", VideoOp::kPositionCode, {"half"}),
                    reshape("place2", VideoOp::kPositionCode, {"split"}),
                    reshape("n1", VideoOp::kLayerNorm, {"place1"}),
                    attention("self", {"n1", "n1", "n1"}, 2),
                    conv("x1", "self", 32, 1, false, "place1"),
                    conv("wide", "x1", 70, 1),
                    conv("y1", "wide", 32, 1, false, "x1"),
                    reshape("n2", VideoOp::kLayerNorm, {"place2"}),
                    reshape("n3", VideoOp::kLayerNorm, {"y1"}),
                    attention("cross", {"n2", "n3", "n3"}, 4),
                    reshape("sum", VideoOp::kAdd, {"cross", "place2"}),
                    reshape("mean", VideoOp::kMean, {"sum", "y1", "place1"}),
                    reshape("join", VideoOp::kAdd, {"mean", "half"}),
                    reshape("up", VideoOp::kUpsampleBilinear, {"join"}, 2),
                    conv("d", "up", 12, 5),
                    reshape("last", VideoOp::kAdd, {"d", "head"}),
                    conv("p", "last", 1, 1, false),
                    reshape("out", VideoOp::kSigmoid, {"p"})}},
                  2});
  return list;
}

/// Returns networks with both kinds of cells, at full and at lower resolution, also as the last layer; one keeps rows
/// on which its output does not depend, and two feed back their last output. Two have no memory: one resamples, and one
/// filters each pixel in its own way.
inline std::vector<TestNetwork> recurrent_networks() {
  std::vector<TestNetwork> list;
  list.push_back({"gru",
                  {5,
                   {conv("head", "input", 16, 3), cell("g1", VideoOp::kConvGru, "head", 16, 3), conv("r1", "g1", 16, 3),
                    conv("r2", "r1", 16, 3, true, "g1"), cell("g2", VideoOp::kConvGru, "r2", 16, 3),
                    conv("out", "g2", 1, 1, false)}},
                  1});
  list.push_back({"lstm",
                  {5,
                   {conv("head", "input", 8, 5), conv("e0", "head", 20, 5, true, "", 2),
                    cell("l0", VideoOp::kConvLstm, "e0", 20, 3), conv("e1", "l0", 24, 5, true, "", 2),
                    cell("l1", VideoOp::kConvLstm, "e1", 24, 3), reshape("s1", VideoOp::kAdd, {"l1", "e1"}),
                    reshape("u1", VideoOp::kUpsampleBilinear, {"s1"}, 2), conv("d1", "u1", 20, 5),
                    reshape("s0", VideoOp::kAdd, {"d1", "l0"}), reshape("u0", VideoOp::kUpsampleBilinear, {"s0"}, 2),
                    conv("d0", "u0", 8, 5), reshape("s", VideoOp::kAdd, {"d0", "head"}), conv("p", "s", 2, 1, false),
                    reshape("out", VideoOp::kSigmoid, {"p"})}},
                  4});
  list.push_back({"feedback",
                  {3,
                   {previous("last", 7), reshape("both", VideoOp::kConcat, {"input", "last"}), conv("a", "both", 20, 5),
                    conv("half", "a", 20, 3, true, "", 2), reshape("up", VideoOp::kUpsample, {"half"}, 2),
                    conv("p", "up", 7, 3, false), reshape("out", VideoOp::kTanh, {"p"})}},
                  2});
  list.push_back({"feedback and cell",
                  {2,
                   {previous("last", 4), cell("g", VideoOp::kConvGru, "input", 4, 3),
                    reshape("sum", VideoOp::kAdd, {"last", "g"}), reshape("out", VideoOp::kSigmoid, {"sum"})}},
                  1});
  list.push_back(
      {"odd", {3, {cell("a", VideoOp::kConvGru, "input", 7, 5), cell("b", VideoOp::kConvLstm, "a", 33, 1)}}, 1});
  list.push_back({"attention and cell",
                  {3,
                   {conv("a", "input", 16, 3, true, "", 2), cell("g", VideoOp::kConvLstm, "a", 16, 3),
                    attention("look", {"g", "a", "g"}, 2), conv("b", "look", 16, 1, false, "g"),
                    reshape("up", VideoOp::kUpsample, {"b"}, 2), conv("out", "up", 3, 3, false)}},
                  2});
  list.push_back({"sparse",
                  {3,
                   {cell("a", VideoOp::kConvGru, "input", 9, 3), conv("b", "a", 8, 5, true, "", 4),
                    reshape("out", VideoOp::kUpsample, {"b"}, 4)}},
                  4});
  list.push_back({"bilinear",
                  {3,
                   {conv("half", "input", 20, 5, true, "", 2), conv("third", "half", 17, 3, true, "", 3),
                    reshape("up3", VideoOp::kUpsampleBilinear, {"third"}, 3, true),
                    conv("a", "up3", 20, 3, false, "half"), reshape("up2", VideoOp::kUpsampleBilinear, {"a"}, 2),
                    conv("b", "up2", 5, 5, false), reshape("out", VideoOp::kSigmoid, {"b"})}},
                  6});
  // Dynamic filters with channel numbers that do not fill whole vectors, of several vectors and of one.
  model::Layer wide = reshape("wide", VideoOp::kDynamicFilter, {"a", "f"}),
               narrow = reshape("out", VideoOp::kDynamicFilter, {"m", "g"});
  wide.kernel = 5;
  narrow.kernel = 3;
  list.push_back(
      {"dynamic",
       {3,
        {conv("a", "input", 83, 3), conv("p", "input", 50, 1, false), reshape("f", VideoOp::kTanh, {"p"}), wide,
         conv("m", "wide", 5, 1), conv("q", "a", 27, 3, false), reshape("g", VideoOp::kTanh, {"q"}), narrow}},
       1});
  return list;
}

}  // namespace e2lf::video
