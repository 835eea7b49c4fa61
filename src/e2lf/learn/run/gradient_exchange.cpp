// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/gradient_exchange.h"

#include <exception>

namespace e2lf::learn {
namespace {

constexpr int64_t kBucketNumel = int64_t{1}
                                 << 18;  // 1 MiB: a small number of messages, of which the first is sent early

struct Bucket {
  torch::Tensor flat;
  std::vector<size_t> parameters;
  size_t num_missing = 0;
  Peers::Finish finish;
};

}  // namespace

struct GradientExchange::State {
  Peers peers;
  std::vector<torch::Tensor> parameters;
  std::vector<torch::Tensor> places;  // the place of each parameter's gradient in its bucket
  std::vector<size_t> bucket_of;
  std::vector<Bucket> buckets;
  size_t num_sent = 0;
  std::exception_ptr failure;

  void add_bucket(size_t first, size_t last, int64_t numel);
  void take(size_t parameter, const torch::Tensor& gradient);
  void send_full_buckets();
};

void GradientExchange::State::add_bucket(size_t first, size_t last, int64_t numel) {
  Bucket bucket;
  bucket.flat = torch::zeros({numel}, parameters[first].options().requires_grad(false));
  int64_t offset = 0;
  for (size_t i = first; i < last; ++i) {
    places.push_back(bucket.flat.slice(0, offset, offset + parameters[i].numel()));
    bucket_of.push_back(buckets.size());
    bucket.parameters.push_back(i);
    offset += parameters[i].numel();
  }
  buckets.push_back(std::move(bucket));
}

// Buckets are sent in order, even if a later one is full earlier, because the sums of all processes must match.
void GradientExchange::State::send_full_buckets() {
  while (num_sent < buckets.size() && buckets[num_sent].num_missing == 0) {
    Bucket& bucket = buckets[num_sent++];
    bucket.finish = peers.begin_sum(bucket.flat);
  }
}

void GradientExchange::State::take(size_t parameter, const torch::Tensor& gradient) {
  if (failure) return;
  try {
    torch::NoGradGuard no_grad;
    places[parameter].copy_(gradient.reshape({-1}));
    --buckets[bucket_of[parameter]].num_missing;
    send_full_buckets();
  } catch (...) {
    failure = std::current_exception();  // rethrown by finish(), because the backward pass would wrap it
  }
}

GradientExchange::GradientExchange(const Peers& peers, std::vector<torch::Tensor> parameters)
    : state_(std::make_shared<State>()) {
  if (peers.size() == 1) return;
  State& state = *state_;
  state.peers = peers;
  state.parameters = std::move(parameters);
  size_t first = 0;
  int64_t numel = 0;
  for (size_t i = 0; i < state.parameters.size(); ++i) {
    numel += state.parameters[i].numel();
    if (numel < kBucketNumel && i + 1 < state.parameters.size()) continue;
    state.add_bucket(first, i + 1, numel);
    first = i + 1;
    numel = 0;
  }
  for (size_t i = 0; i < state.parameters.size(); ++i) {
    state.parameters[i].register_hook([weak = std::weak_ptr<State>(state_), i](const torch::Tensor& gradient) {
      if (const auto alive = weak.lock()) alive->take(i, gradient);
    });
  }
}

void GradientExchange::begin() {
  state_->num_sent = 0;
  state_->failure = nullptr;
  for (Bucket& bucket : state_->buckets) {
    bucket.flat.zero_();
    bucket.num_missing = bucket.parameters.size();
  }
}

Result<void> GradientExchange::finish() {
  State& state = *state_;
  torch::NoGradGuard no_grad;
  try {
    if (state.failure) std::rethrow_exception(state.failure);
    // Parameters that were not used in this step (patterns that are not learned) contribute zeros.
    for (Bucket& bucket : state.buckets) bucket.num_missing = 0;
    state.send_full_buckets();
    for (Bucket& bucket : state.buckets) bucket.finish();
  } catch (const std::exception& error) {
    return Peers::lost(error);
  }
  for (size_t i = 0; i < state.parameters.size(); ++i) {
    auto gradient = state.parameters[i].grad();
    if (!gradient.defined()) continue;
    gradient.copy_(state.places[i].reshape(gradient.sizes())).div_(state.peers.size());
  }
  return {};
}

}  // namespace e2lf::learn
