// SPDX-License-Identifier: MIT
#include "peers/onednn_recnet.h"

#include <chrono>
#include <map>
#include <omp.h>
#include <oneapi/dnnl/dnnl.hpp>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

namespace {

using dnnl::memory;
using Tag = memory::format_tag;
using Type = memory::data_type;

constexpr size_t kLinearLayers = 3;

/// A primitive with its arguments.
struct Step {
  dnnl::primitive primitive;
  std::unordered_map<int, memory> arguments;
};

int64_t as_int(size_t value) {
  return static_cast<int64_t>(value);
}

/// The paper's network for one size of image. Layers are in the formats that oneDNN prefers for each convolution.
class Network {
 public:
  Network(const E2lfRecnetJob& job, Type type) : type_(type), height_(as_int(job.height)), width_(as_int(job.width)) {
    auto in = as_int(job.in_channels);
    memory x({{1, in, height_, width_}, Type::f32, Tag::nchw}, engine_, const_cast<float*>(job.input));
    for (size_t i = 0; i < job.num_layers; ++i) {
      x = add_convolution(job, i, in, x);
      in = as_int(job.out_channels[i]);
      if (i + 1 == kLinearLayers) skip_ = x;
    }
    convert(x, memory({{1, in, height_, width_}, Type::f32, Tag::nchw}, engine_, job.output));
  }

  void run() {
    for (Step& step : steps_) step.primitive.execute(stream_, step.arguments);
    stream_.wait();
  }

 private:
  memory add_convolution(const E2lfRecnetJob& job, size_t i, int64_t in, const memory& x) {
    const auto out = as_int(job.out_channels[i]);
    const auto kernel = as_int(job.kernels[i]);
    const bool is_last = i + 1 == job.num_layers;
    const memory::dims pixels = {1, out, height_, width_}, strides = {1, 1}, padding = {kernel / 2, kernel / 2};
    dnnl::post_ops after;
    if (is_last) {
      after.append_sum(1.0F);
    } else if (i >= kLinearLayers) {
      after.append_eltwise(1.0F, dnnl::algorithm::eltwise_relu, 0.0F, 0.0F);
    }
    dnnl::primitive_attr attributes;
    attributes.set_post_ops(after);
    const memory::desc result = is_last ? skip_.get_desc() : memory::desc(pixels, type_, Tag::any);
    const dnnl::convolution_forward::primitive_desc chosen({dnnl::prop_kind::forward_inference,
                                                            dnnl::algorithm::convolution_auto,
                                                            {{1, in, height_, width_}, type_, Tag::any},
                                                            {{out, in, kernel, kernel}, type_, Tag::any},
                                                            {{out}, Type::f32, Tag::a},
                                                            result,
                                                            strides,
                                                            padding,
                                                            padding},
                                                           attributes, engine_);
    const memory source = x.get_desc() == chosen.src_desc() ? x : convert(x, memory(chosen.src_desc(), engine_));
    memory weights(chosen.weights_desc(), engine_);
    memory plain({{out, in, kernel, kernel}, Type::f32, Tag::oihw}, engine_, const_cast<float*>(job.weights[i]));
    dnnl::reorder(plain, weights).execute(stream_, plain, weights);
    stream_.wait();
    const memory bias({{out}, Type::f32, Tag::a}, engine_, const_cast<float*>(job.biases[i]));
    const memory y = is_last ? skip_ : result_of_layer(i, chosen.dst_desc());
    steps_.push_back({dnnl::convolution_forward(chosen),
                      {{DNNL_ARG_SRC, source}, {DNNL_ARG_WEIGHTS, weights}, {DNNL_ARG_BIAS, bias}, {DNNL_ARG_DST, y}}});
    return y;
  }

  /// The layers after the skip connection write to two buffers in turn, so that they stay in the caches of small
  /// images.
  memory result_of_layer(size_t i, const memory::desc& desc) {
    if (i < kLinearLayers) return memory(desc, engine_);
    memory& buffer = buffers_[i % 2];
    if (!buffer) buffer = memory(desc, engine_);
    if (buffer.get_desc().get_size() != desc.get_size()) return memory(desc, engine_);
    return memory(desc, engine_, buffer.get_data_handle());
  }

  memory convert(const memory& from, const memory& to) {
    steps_.push_back({dnnl::reorder(from, to), {{DNNL_ARG_FROM, from}, {DNNL_ARG_TO, to}}});
    return to;
  }

  dnnl::engine engine_{dnnl::engine::kind::cpu, 0};
  dnnl::stream stream_{engine_};
  Type type_;
  int64_t height_, width_;
  std::vector<Step> steps_;
  memory skip_, buffers_[2];
};

void limit_instruction_set(const std::string& isa) {
  static const std::map<std::string, dnnl::cpu_isa> kNames = {{"sse4", dnnl::cpu_isa::sse41},
                                                              {"avx2", dnnl::cpu_isa::avx2},
                                                              {"avx512", dnnl::cpu_isa::avx512_core_bf16},
                                                              {"amx", dnnl::cpu_isa::avx512_core_amx}};
  const auto found = kNames.find(isa);
  if (found == kNames.end()) throw std::runtime_error("oneDNN has no kernels for the instruction set " + isa);
  static_cast<void>(dnnl::set_max_cpu_isa(found->second));  // refused after the first use of the library
}

}  // namespace

const char* e2lf_onednn_recnet(const E2lfRecnetJob* job, int bfloat16, const char* isa) {
  static std::string message;
  try {
    limit_instruction_set(isa);
    ::omp_set_num_threads(job->threads);
    Network network(*job, bfloat16 != 0 ? Type::bf16 : Type::f32);
    network.run();  // touches the memory
    for (size_t run = 0; run < job->runs; ++run) {
      const auto begin = std::chrono::steady_clock::now();
      network.run();
      job->seconds[run] = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }
    return nullptr;
  } catch (const std::exception& error) {
    message = error.what();
    return message.c_str();
  }
}

const char* e2lf_onednn_version() {
  static const std::string text = [] {
    const dnnl_version_t* const version = dnnl_version();
    return std::to_string(version->major) + "." + std::to_string(version->minor) + "." + std::to_string(version->patch);
  }();
  return text.c_str();
}
