// SPDX-License-Identifier: MIT
#include "e2lf/view/connections.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <list>
#include <poll.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

namespace e2lf::view {
namespace {

using Clock = std::chrono::steady_clock;

/// One connection, whose waiting ends at a stop or at the deadline of the request.
class Connection : public httplib::Stream {
 public:
  Connection(socket_t socket, const std::atomic<bool>& is_over) : socket_(socket), is_over_(is_over) {}

  /// Waits for the first byte of the next request, and sets the deadline for all of it.
  bool begin_request() {
    deadline_ = Clock::now() + std::chrono::milliseconds(ConnectionServer::kRequestMs);
    return begin_ < end_ || wait_for(POLLIN, deadline_);
  }

  ssize_t read(char* data, size_t size) override {
    if (begin_ == end_) {
      if (!wait_for(POLLIN, deadline_)) return -1;
      const ssize_t received = ::recv(socket_, buffer_.data(), buffer_.size(), 0);
      if (received <= 0) return received;
      begin_ = 0;
      end_ = static_cast<size_t>(received);
    }
    const size_t taken = std::min(size, end_ - begin_);
    std::memcpy(data, buffer_.data() + begin_, taken);
    begin_ += taken;
    return static_cast<ssize_t>(taken);
  }

  ssize_t write(const char* data, size_t size) override {
    if (!wait_for(POLLOUT, Clock::now() + std::chrono::milliseconds(ConnectionServer::kSilenceMs))) return -1;
    return ::send(socket_, data, size, MSG_NOSIGNAL | MSG_DONTWAIT);
  }

  [[nodiscard]] bool is_readable() const override { return !is_over_; }
  [[nodiscard]] bool is_writable() const override { return !is_over_; }
  void get_remote_ip_and_port(std::string& /*ip*/, int& /*port*/) const override {}
  void get_local_ip_and_port(std::string& /*ip*/, int& /*port*/) const override {}
  [[nodiscard]] socket_t socket() const override { return socket_; }

 private:
  [[nodiscard]] bool wait_for(short what, Clock::time_point deadline) const {
    constexpr int kPollMs = 50;  // limits how long a stop waits
    pollfd one{.fd = socket_, .events = what, .revents = 0};
    while (!is_over_ && Clock::now() < deadline) {
      if (::poll(&one, 1, kPollMs) > 0) return true;
    }
    return false;
  }

  socket_t socket_;
  const std::atomic<bool>& is_over_;
  Clock::time_point deadline_;
  std::array<char, 4096> buffer_ = {};
  size_t begin_ = 0, end_ = 0;  ///< of the bytes that were received and not yet read
};

/// Starts a thread for each connection, so that slow ones do not keep the others waiting.
class ThreadPerConnection : public httplib::TaskQueue {
 public:
  void enqueue(std::function<void()> serve) override {
    threads_.remove_if([](Thread& each) { return each.has_ended.load(); });
    Thread& added = threads_.emplace_back();
    added.thread = std::jthread([serve = std::move(serve), &ended = added.has_ended] {
      serve();
      ended = true;
    });
  }
  void shutdown() override { threads_.clear(); }

 private:
  struct Thread {
    std::atomic<bool> has_ended = false;
    std::jthread thread;  ///< is joined by its destructor
  };
  std::list<Thread> threads_;
};

}  // namespace

ConnectionServer::ConnectionServer() {
  new_task_queue = [] { return new ThreadPerConnection(); };
}

void ConnectionServer::stop_all() {
  is_over_ = true;
  stop();
}

bool ConnectionServer::process_and_close_socket(socket_t socket) {
  bool is_good = connections_++ < kMostConnections, is_closed = !is_good;
  Connection connection(socket, is_over_);
  for (size_t request = 1; !is_closed && is_good && connection.begin_request(); ++request) {
    is_good = process_request(connection, request == kMostRequests, is_closed, nullptr);
    if (request == kMostRequests) break;
  }
  --connections_;
  ::shutdown(socket, SHUT_RDWR);
  ::close(socket);
  return is_good;
}

}  // namespace e2lf::view
