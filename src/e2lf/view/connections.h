// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <httplib.h>

namespace e2lf::view {

/// A server of httplib whose connections end at a stop, and none of which keeps the others waiting: each has its own
/// thread, and a request must arrive within a few seconds, however slowly its bytes come.
class ConnectionServer : public httplib::Server {
 public:
  ConnectionServer();

  /// Ends listening and all connections. It may be called from any thread.
  void stop_all();

  static constexpr int kRequestMs = 3'000;        ///< longest time for a request to arrive, and between two of them
  static constexpr int kSilenceMs = 5'000;        ///< longest time in which a client accepts no byte of an answer
  static constexpr int kMostConnections = 500;    ///< further ones are closed
  static constexpr size_t kMostRequests = 1'000;  ///< of one connection

 private:
  bool process_and_close_socket(socket_t socket) override;

  std::atomic<bool> is_over_ = false;
  std::atomic<int> connections_ = 0;
};

}  // namespace e2lf::view
