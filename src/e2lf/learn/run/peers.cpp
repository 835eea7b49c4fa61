// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/peers.h"

#include <arpa/inet.h>
#include <charconv>
#include <cstdlib>
#include <exception>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include "e2lf/base/text.h"

// Torch's CMake package states with which transports it was built, but their headers may be absent.
#if defined(USE_DISTRIBUTED) && __has_include(<torch/csrc/distributed/c10d/TCPStore.hpp>)
#define E2LF_C10D
#include <torch/csrc/distributed/c10d/TCPStore.hpp>
#if defined(USE_C10D_GLOO) && __has_include(<gloo/transport/device.h>)
#define E2LF_GLOO
#include <torch/csrc/distributed/c10d/ProcessGroupGloo.hpp>
#endif
#if defined(USE_C10D_NCCL) && __has_include(<nccl.h>)
#define E2LF_NCCL
#include <torch/csrc/distributed/c10d/ProcessGroupNCCL.hpp>
#endif
#endif

namespace e2lf::learn {
namespace {

constexpr int kMaxProcesses = 4096;

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

struct Meeting {
  int rank = 0, size = 1;
  std::string address;
  int port = 0;
};

Result<int> number_variable(const char* name, int low, int high) {
  const char* text = std::getenv(name);
  if (text == nullptr) {
    return fail(ErrorCode::kInvalidValue, name, "the environment variable ", name,
                " is missing; start with torchrun or set it");
  }
  int value = 0;
  const std::string_view view = text;
  const auto [end, failure] = std::from_chars(view.data(), view.data() + view.size(), value);
  if (failure != std::errc{} || end != view.data() + view.size() || value < low || value > high) {
    return fail(ErrorCode::kInvalidValue, name, "\"", view, "\" is not a number from ", low, " to ", high,
                "; correct the variable");
  }
  return value;
}

/// Returns the first host of a list of Slurm: "node03" of "node[03-07,9],other".
std::string first_host(const std::string& list) {
  const size_t end = list.find_first_of("[,");
  std::string host = list.substr(0, end);
  if (end != std::string::npos && list[end] == '[')
    host += list.substr(end + 1, list.find_first_of("-,]", end) - end - 1);
  return host;
}

/// Reads the variables that srun sets in each task of a step. The tasks meet on the first host, at a port that follows
/// from the number of the job.
Result<Meeting> read_slurm_step() {
  constexpr int kMaxJob = 0x7fffffff, kFirstPort = 20000, kPorts = 20000;
  Meeting meeting;
  E2LF_ASSIGN_OR_RETURN(meeting.size, number_variable("SLURM_STEP_NUM_TASKS", 1, kMaxProcesses));
  if (meeting.size == 1) return meeting;
  E2LF_ASSIGN_OR_RETURN(meeting.rank, number_variable("SLURM_PROCID", 0, meeting.size - 1));
  E2LF_ASSIGN_OR_RETURN(const int job, number_variable("SLURM_JOB_ID", 0, kMaxJob));
  meeting.port = kFirstPort + job % kPorts;
  const char* hosts = std::getenv("SLURM_STEP_NODELIST");
  meeting.address = hosts == nullptr ? "127.0.0.1" : first_host(hosts);
  return meeting;
}

Result<Meeting> read_environment() {
  Meeting meeting;
  if (std::getenv("WORLD_SIZE") == nullptr) {
    return std::getenv("SLURM_STEP_NUM_TASKS") == nullptr ? meeting : read_slurm_step();
  }
  E2LF_ASSIGN_OR_RETURN(meeting.size, number_variable("WORLD_SIZE", 1, kMaxProcesses));
  if (meeting.size == 1) return meeting;
  E2LF_ASSIGN_OR_RETURN(meeting.rank, number_variable("RANK", 0, meeting.size - 1));
  E2LF_ASSIGN_OR_RETURN(meeting.port, number_variable("MASTER_PORT", 1, 65535));
  const char* address = std::getenv("MASTER_ADDR");
  if (address == nullptr) {
    return fail(ErrorCode::kInvalidValue, "MASTER_ADDR",
                "the environment variable MASTER_ADDR is missing; start with torchrun or set it");
  }
  meeting.address = address;
  return meeting;
}

#ifdef E2LF_GLOO
/// Returns the address of this machine on the route to `host`. Connecting a datagram socket sends nothing, but selects
/// the route.
std::string local_address_towards(const std::string& host, int port) {
  addrinfo hints{}, *found = nullptr;
  hints.ai_socktype = SOCK_DGRAM;
  if (getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) return {};
  std::string address;
  const int handle = socket(found->ai_family, SOCK_DGRAM, 0);
  sockaddr_storage local{};
  socklen_t length = sizeof local;
  char text[NI_MAXHOST];
  if (handle >= 0 && connect(handle, found->ai_addr, found->ai_addrlen) == 0 &&
      getsockname(handle, reinterpret_cast<sockaddr*>(&local), &length) == 0 &&
      getnameinfo(reinterpret_cast<sockaddr*>(&local), length, text, sizeof text, nullptr, 0, NI_NUMERICHOST) == 0) {
    address = text;
  }
  if (handle >= 0) close(handle);
  freeaddrinfo(found);
  return address;
}

auto gloo_device(const Meeting& meeting) {
  if (const char* interface = std::getenv("GLOO_SOCKET_IFNAME")) {
    return c10d::ProcessGroupGloo::createDeviceForInterface(interface);
  }
  const auto address = local_address_towards(meeting.address, meeting.port);
  return address.empty() ? c10d::ProcessGroupGloo::createDefaultDevice()
                         : c10d::ProcessGroupGloo::createDeviceForHostname(address);
}
#endif

}  // namespace

#ifdef E2LF_C10D

struct Peers::Group {
  Meeting meeting;
  c10::intrusive_ptr<c10d::TCPStore> store;
  // Torch 2 splits ProcessGroup from its backends; both have the calls used here.
#ifdef E2LF_GLOO
  c10::intrusive_ptr<c10d::ProcessGroupGloo> gloo;
#endif
#ifdef E2LF_NCCL
  c10::intrusive_ptr<c10d::ProcessGroupNCCL> nccl;
#endif

  bool open(torch::Device device);

  /// Calls `work` with the transport in use.
  template <typename Work>
  Finish with(const Work& work) {
#ifdef E2LF_NCCL
    if (nccl) return work(*nccl);
#endif
#ifdef E2LF_GLOO
    if (gloo) return work(*gloo);
#endif
    throw std::runtime_error("no transport");
  }
};

/// Returns false if this build has no transport for the device.
bool Peers::Group::open(torch::Device device) {
#ifdef E2LF_NCCL
  if (device.is_cuda()) {
    const auto options = c10d::ProcessGroupNCCL::Options::create();
    options->timeout = kPatience;
    nccl = c10::make_intrusive<c10d::ProcessGroupNCCL>(store, meeting.rank, meeting.size, options);
    return true;
  }
#endif
#ifdef E2LF_GLOO
  if (device.is_cpu()) {
    const auto options = c10d::ProcessGroupGloo::Options::create(kPatience);
    options->devices.push_back(gloo_device(meeting));
    gloo = c10::make_intrusive<c10d::ProcessGroupGloo>(store, meeting.rank, meeting.size, options);
    return true;
  }
#endif
  return false;
}

Result<Peers> Peers::meet() {
  E2LF_ASSIGN_OR_RETURN(const auto meeting, read_environment());
  Peers peers;
  if (meeting.size == 1) return peers;
  peers.rank_ = meeting.rank;
  peers.size_ = meeting.size;
  peers.group_ = std::make_shared<Group>();
  peers.group_->meeting = meeting;
  try {
    c10d::TCPStoreOptions options;
    options.port = static_cast<uint16_t>(meeting.port);
    options.isServer = meeting.rank == 0;
    options.numWorkers = static_cast<size_t>(meeting.size);
    options.timeout = kPatience;
    peers.group_->store = c10::make_intrusive<c10d::TCPStore>(meeting.address, options);
  } catch (const std::exception& error) {
    return fail(ErrorCode::kIo, cat(meeting.address, ":", meeting.port), "not all of the ", meeting.size,
                " processes joined; start them within ", kPatience.count(),
                " s of each other with the same WORLD_SIZE (", first_line(error.what()), ")");
  }
  return peers;
}

Result<void> Peers::connect(torch::Device device) {
  if (size_ == 1) return {};
  try {
    if (group_->open(device)) return {};
  } catch (const std::exception& error) {
    return lost(error);
  }
  return fail(ErrorCode::kUnsupported, "WORLD_SIZE", "this build has no transport between processes for ", device.str(),
              "; train with one process, or build with Gloo (CPU) or NCCL (CUDA)");
}

Peers::Finish Peers::begin_sum(const torch::Tensor& tensor) const {
  std::vector<torch::Tensor> tensors{tensor};
  return group_->with([&](auto& group) -> Finish { return [work = group.allreduce(tensors)] { work->wait(); }; });
}

Result<void> Peers::copy_from_first(const torch::Tensor& tensor) const {
  if (size_ == 1) return {};
  try {
    torch::NoGradGuard no_grad;
    std::vector<torch::Tensor> dense{tensor.contiguous()};  // groups send only contiguous tensors
    group_->with([&](auto& group) -> Finish { return [work = group.broadcast(dense)] { work->wait(); }; })();
    auto target = tensor;
    if (!dense.front().is_same(tensor)) target.copy_(dense.front());
  } catch (const std::exception& error) {
    return lost(error);
  }
  return {};
}

Result<std::string> Peers::text_from_first(const std::string& text) const {
  if (size_ == 1) return text;
  try {
    if (leads()) group_->store->set("text", std::vector<uint8_t>(text.begin(), text.end()));
    const auto bytes = group_->store->get("text");
    return std::string(bytes.begin(), bytes.end());
  } catch (const std::exception& error) {
    return lost(error);
  }
}

#else

struct Peers::Group {};

Result<Peers> Peers::meet() {
  E2LF_ASSIGN_OR_RETURN(const auto meeting, read_environment());
  if (meeting.size == 1) return Peers();
  return fail(ErrorCode::kUnsupported, "WORLD_SIZE",
              "this build trains with one process only; build with torch's distributed part");
}

Result<void> Peers::connect(torch::Device) {
  return {};
}

Peers::Finish Peers::begin_sum(const torch::Tensor&) const {
  return [] {};
}

Result<void> Peers::copy_from_first(const torch::Tensor&) const {
  return {};
}

Result<std::string> Peers::text_from_first(const std::string& text) const {
  return text;
}

#endif

Result<void> Peers::sum(const torch::Tensor& tensor) const {
  if (size_ == 1) return {};
  try {
    begin_sum(tensor)();
  } catch (const std::exception& error) {
    return lost(error);
  }
  return {};
}

Error Peers::lost(const std::exception& error) {
  return fail(ErrorCode::kIo, "data-parallel training", "a peer ended or did not respond for ", kPatience.count(),
              " s; `e2lf resume` continues from the last checkpoint, with any number of processes (",
              first_line(error.what()), ")");
}

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
