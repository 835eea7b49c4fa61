// SPDX-License-Identifier: MIT
// Reads pipes, sockets and standard input as cameras; declared in cameras.h.
#include <algorithm>
#include <arpa/inet.h>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <netinet/in.h>
#include <optional>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/cameras/cameras.h"

namespace e2lf::cameras {
namespace {

constexpr size_t kCameraReadBytes = size_t{1} << 16;
constexpr int kPollMs = 100;  // longest delay of a stop

/// Delivers the bytes of a pipe or socket as they arrive.
class DescriptorCamera final : public Camera {
 public:
  DescriptorCamera(int descriptor, bool owned, std::string name)
      : descriptor_(descriptor), owned_(owned), name_(std::move(name)) {}
  ~DescriptorCamera() override {
    if (owned_) ::close(descriptor_);
  }

  Result<void> start() override { return {}; }

  Result<bool> read(std::vector<uint8_t>& bytes) override {
    for (;;) {
      const bool is_stopped = is_stopped_;
      if (is_stopped && !left_bytes_) left_bytes_ = unread_bytes();
      if (is_stopped && *left_bytes_ == 0) return false;
      pollfd waiting = {descriptor_, POLLIN, 0};
      const int ready = ::poll(&waiting, 1, is_stopped ? 0 : kPollMs);
      if (ready == 0 && is_stopped) return false;
      if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
      bytes.resize(std::min(kCameraReadBytes, left_bytes_.value_or(kCameraReadBytes)));
      const ssize_t count = ::read(descriptor_, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0)
        return fail(ErrorCode::kIo, name_, "the sender broke off (", std::strerror(errno),
                    "); look there for the reason");
      bytes.resize(static_cast<size_t>(count));
      if (left_bytes_) *left_bytes_ -= bytes.size();
      return count > 0;
    }
  }

  void stop() override { is_stopped_ = true; }

  bool keeps_unread() const override { return true; }

 private:
  /// Determines how many unread bytes had arrived, because a sender may never end.
  [[nodiscard]] size_t unread_bytes() const {
    int bytes = 0;
    return ::ioctl(descriptor_, FIONREAD, &bytes) == 0 && bytes > 0 ? static_cast<size_t>(bytes) : 0;
  }

  int descriptor_;
  bool owned_;
  std::optional<size_t> left_bytes_;  ///< to be read after stop()
  std::string name_;
  std::atomic<bool> is_stopped_ = false;
};

/// Returns when there are bytes to read or the writer has closed. Fails if a stop is requested before.
Result<void> wait_for_bytes(int descriptor, const std::string& address) {
  pollfd waiting = {descriptor, POLLIN, 0};
  while (::poll(&waiting, 1, kPollMs) <= 0) {
    if (stop_requested()) {
      return fail(ErrorCode::kCancelled, address,
                  "no program wrote to it before the run was stopped; start the writer first");
    }
  }
  return {};
}

/// Connects to a sender, e.g. 127.0.0.1:5000, and returns the descriptor.
Result<int> connect_tcp(const std::string& host_and_port, const std::string& name) {
  const size_t colon = std::min(host_and_port.rfind(':'), host_and_port.size());
  const auto port =
      parse_number<uint16_t>(std::string_view(host_and_port).substr(std::min(colon + 1, host_and_port.size())));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port.value_or(0));
  if (!port || ::inet_pton(AF_INET, host_and_port.substr(0, colon).c_str(), &address.sin_addr) != 1) {
    return fail(ErrorCode::kInvalidValue, name, "not a TCP address; write tcp://127.0.0.1:PORT");
  }
  const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0 || ::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    const std::string reason = std::strerror(errno);
    if (descriptor >= 0) ::close(descriptor);
    return fail(ErrorCode::kIo, name, "cannot connect (", reason, "); start the sender first");
  }
  return descriptor;
}

}  // namespace

Result<CameraPtr> open_pipe_camera(const std::string& address) {
  CameraPtr camera;
  if (address.empty()) {
    camera = std::make_unique<DescriptorCamera>(STDIN_FILENO, /*owned=*/false, "stdin");
    return camera;
  }
  // A blocking open would wait in the kernel, and a signal just before it would have no effect.
  const int descriptor = ::open(address.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) {
    return fail_to("open", address, errno);
  }
  camera = std::make_unique<DescriptorCamera>(descriptor, /*owned=*/true, address);
  E2LF_RETURN_IF_ERROR(wait_for_bytes(descriptor, address));
  ::fcntl(descriptor, F_SETFL, 0);
  return camera;
}

Result<CameraPtr> open_tcp_camera(const std::string& address) {
  const std::string name = "tcp://" + address;
  E2LF_ASSIGN_OR_RETURN(const int descriptor, connect_tcp(address, name));
  return CameraPtr(std::make_unique<DescriptorCamera>(descriptor, /*owned=*/true, name));
}

}  // namespace e2lf::cameras
