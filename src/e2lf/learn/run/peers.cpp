// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/peers.h"

#include <arpa/inet.h>
#include <cstdlib>
#include <netdb.h>
#include <stdexcept>
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

/// Returns the error that describes the failure of a collective call.
Error lost(const std::exception& error) {
  return fail(ErrorCode::kIo, "data-parallel training", "a peer ended or did not respond for ",
              Peers::kPatience.count(),
              " s; `e2lf resume` continues from the last checkpoint, with any number of processes (",
              first_line(error.what()), ")");
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
  const auto value = parse_number<int>(text);
  if (!value || *value < low || *value > high) {
    return fail(ErrorCode::kInvalidValue, name, "\"", text, "\" is not a number from ", low, " to ", high,
                "; correct the variable");
  }
  return *value;
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

struct Peers::Group {
  Meeting meeting;
#ifdef E2LF_C10D
  c10::intrusive_ptr<c10d::TCPStore> store;
#endif
  // Torch 2 splits ProcessGroup from its backends; both have the calls used here.
#ifdef E2LF_GLOO
  c10::intrusive_ptr<c10d::ProcessGroupGloo> gloo;
#endif
#ifdef E2LF_NCCL
  c10::intrusive_ptr<c10d::ProcessGroupNCCL> nccl;
#endif

  bool open(torch::Device device);

  /// Calls `work` with the transport in use. Fails with kIo if a peer is lost.
  template <typename Work>
  Result<void> with([[maybe_unused]] const Work& work) {
    try {
#ifdef E2LF_NCCL
      if (nccl) {
        work(*nccl);
        return {};
      }
#endif
#ifdef E2LF_GLOO
      if (gloo) {
        work(*gloo);
        return {};
      }
#endif
      throw std::runtime_error("no transport");
    } catch (const std::exception& error) {
      return lost(error);
    }
  }
};

/// Returns false if this build has no transport for the device.
bool Peers::Group::open([[maybe_unused]] torch::Device device) {
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
#ifdef E2LF_C10D
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
#else
  return fail(ErrorCode::kUnsupported, "WORLD_SIZE",
              "this build trains with one process only; build with torch's distributed part");
#endif
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

Result<void> Peers::sum(const torch::Tensor& tensor) const {
  if (size_ == 1) return {};
  std::vector<torch::Tensor> tensors{tensor};
  return group_->with([&](auto& group) { group.allreduce(tensors)->wait(); });
}

Result<void> Peers::copy_from_first(const torch::Tensor& tensor) const {
  if (size_ == 1) return {};
  torch::NoGradGuard no_grad;
  std::vector<torch::Tensor> dense{tensor.contiguous()};  // groups send only contiguous tensors
  E2LF_RETURN_IF_ERROR(group_->with([&](auto& group) { group.broadcast(dense)->wait(); }));
  auto target = tensor;
  if (!dense.front().is_same(tensor)) target.copy_(dense.front());
  return {};
}

Result<std::string> Peers::text_from_first(const std::string& text) const {
#ifdef E2LF_C10D
  if (size_ == 1) return text;
  try {
    if (leads()) group_->store->set("text", std::vector<uint8_t>(text.begin(), text.end()));
    const auto bytes = group_->store->get("text");
    return std::string(bytes.begin(), bytes.end());
  } catch (const std::exception& error) {
    return lost(error);
  }
#else
  return text;
#endif
}

}  // namespace e2lf::learn
