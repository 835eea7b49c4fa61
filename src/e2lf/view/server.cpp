// SPDX-License-Identifier: MIT
#include "e2lf/view/server.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstring>
#include <httplib.h>
#include <list>
#include <mutex>
#include <poll.h>
#include <random>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"

namespace e2lf::view {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kRequestMs = 3'000;        // longest time for a request to arrive, and between two of them
constexpr int kSilenceMs = 5'000;        // longest time in which a client accepts no byte of an answer
constexpr int kMostConnections = 500;    // further ones are closed
constexpr size_t kMostRequests = 1'000;  // of one connection

/// Returns true if bytes follow the head of a request. No request of the page has any.
bool has_body(const httplib::Request& request) {
  const auto lengths = request.headers.equal_range("Content-Length");
  return request.has_header("Transfer-Encoding") ||
         std::any_of(lengths.first, lengths.second, [](const auto& length) { return length.second != "0"; });
}

/// One connection, whose waiting ends at a stop or at the deadline of the request.
class Connection : public httplib::Stream {
 public:
  Connection(socket_t socket, const std::atomic<bool>& is_over) : socket_(socket), is_over_(is_over) {}

  /// Waits for the first byte of the next request, and sets the deadline for all of it.
  bool begin_request() {
    deadline_ = Clock::now() + std::chrono::milliseconds(kRequestMs);
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
    if (!wait_for(POLLOUT, Clock::now() + std::chrono::milliseconds(kSilenceMs))) return -1;
    return ::send(socket_, data, size, MSG_NOSIGNAL | MSG_DONTWAIT);
  }

  /// Ends the answers, and discards what the client still sends until the deadline of the request: if the socket were
  /// closed with unread bytes in it, the system would reset the connection and the client could lose the answer.
  void discard_rest() {
    ::shutdown(socket_, SHUT_WR);
    while (wait_for(POLLIN, deadline_) && ::recv(socket_, buffer_.data(), buffer_.size(), 0) > 0) continue;
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

/// A server of httplib whose connections end at a stop, and none of which keeps the others waiting: each has its own
/// thread, and a request must arrive within a few seconds, however slowly its bytes come.
class ConnectionServer : public httplib::Server {
 public:
  ConnectionServer() {
    new_task_queue = [] { return new ThreadPerConnection(); };
  }

  /// Ends listening and all connections. It may be called from any thread.
  void stop_all() {
    is_over_ = true;
    stop();
  }

 private:
  bool process_and_close_socket(socket_t socket) override {
    bool is_good = connections_++ < kMostConnections, is_closed = !is_good;
    Connection connection(socket, is_over_);
    for (size_t number = 1; !is_closed && is_good && connection.begin_request(); ++number) {
      // Bodies are not read, and of a request whose head is wrong it is unknown where it ends. What follows would be
      // executed as the next request, so the connection ends after the answer.
      bool is_whole = false;
      is_good = process_request(connection, number == kMostRequests, is_closed, [&](httplib::Request& request) {
        is_whole = !has_body(request);
        if (!is_whole) request.headers.erase("Connection");
        if (!is_whole) request.set_header("Connection", "close");  // httplib repeats it in the answer
      });
      if (!is_whole) connection.discard_rest();
      if (!is_whole || number == kMostRequests) break;
    }
    --connections_;
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
    return is_good;
  }

  std::atomic<bool> is_over_ = false;
  std::atomic<int> connections_ = 0;
};

constexpr const char* kHost = "127.0.0.1";
constexpr std::chrono::milliseconds kStopPoll{100};

/// Returns 32 hexadecimal digits from the random device of the system.
std::string random_secret() {
  std::random_device device;
  std::string text;
  for (int i = 0; i < 32; ++i) text += "0123456789abcdef"[device() & 15U];
  return text;
}

/// Compares in constant time, regardless of where the first difference is.
bool is_equal_secretly(const std::string& text, const std::string& secret) {
  if (text.size() != secret.size()) return false;
  unsigned difference = 0;
  for (size_t i = 0; i < text.size(); ++i) difference |= static_cast<unsigned char>(text[i] ^ secret[i]);
  return difference == 0;
}

/// Allows only the page's own scripts, styles and pictures; the page must not be framed and connects to this server
/// only.
void set_headers(httplib::Response& response) {
  response.set_header("Content-Security-Policy",
                      "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
                      "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
  response.set_header("X-Content-Type-Options", "nosniff");
  response.set_header("Referrer-Policy", "no-referrer");
  response.set_header("Cross-Origin-Resource-Policy", "same-origin");
  response.set_header("Cross-Origin-Opener-Policy", "same-origin");
  response.set_header("Cache-Control", "no-store");
}

void refuse(httplib::Response& response, int status, const char* text) {
  response.status = status;
  response.set_content(text, "text/plain");
}

class DocumentServer : public Server {
 public:
  DocumentServer(Document document, Handler handler) : handler_(std::move(handler)) {
    replace(std::move(document));
    server_.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      answer(request, response);
      return httplib::Server::HandlerResponse::Handled;
    });
    // The default options would let a second server take the same port.
    server_.set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    server_.set_payload_max_length(0);
  }

  Result<void> bind(uint16_t port) {
    const int bound = port == 0 ? server_.bind_to_any_port(kHost) : (server_.bind_to_port(kHost, port) ? port : -1);
    if (bound <= 0) {
      return Error{ErrorCode::kIo, cat("cannot listen on port ", port, "; give another, or none for a free one"), kHost,
                   "port"};
    }
    port_ = bound;
    return {};
  }

  void replace(Document document) final {
    std::string description = document.description();
    const std::lock_guard lock(mutex_);
    const uint64_t version = shown_ ? shown_->version + 1 : 0;
    shown_ =
        std::make_shared<const ServedDocument>(ServedDocument{version, std::move(description), std::move(document)});
  }

  void end() override { has_ended_ = true; }

  [[nodiscard]] std::string url() const override { return cat("http://", kHost, ":", port_, "/", secret_, "/"); }

  Result<void> run() override {
    std::thread stopper([this] {
      while (!stop_requested() && !has_ended_) std::this_thread::sleep_for(kStopPoll);
      server_.stop_all();
    });
    const bool is_good = server_.listen_after_bind();
    const bool is_wanted = has_ended_.exchange(true);
    stopper.join();
    if (is_good || is_wanted || stop_requested()) return {};
    return fail(ErrorCode::kIo, url(), "the server failed; try again");
  }

 private:
  /// Returns true if a Host, or an Origin without its scheme, is this server.
  [[nodiscard]] bool is_own(const std::string& host) const {
    return host == cat(kHost, ":", port_) || host == cat("localhost:", port_);
  }

  [[nodiscard]] bool is_from_own_page(const httplib::Request& request) const {
    const std::string origin = request.get_header_value("Origin");
    const std::string site = request.get_header_value("Sec-Fetch-Site");
    return is_own(request.get_header_value("Host")) &&
           (!request.has_header("Origin") || (origin.starts_with("http://") && is_own(origin.substr(7)))) &&
           (site.empty() || site == "same-origin" || site == "none");
  }

  void answer(const httplib::Request& request, httplib::Response& response) const {
    set_headers(response);
    if (!is_from_own_page(request)) return refuse(response, 403, "only pages of this server may ask");
    const bool is_command = request.method == "POST" && handler_;
    if (!is_command && request.method != "GET" && request.method != "HEAD") return refuse(response, 405, "only GET");
    const std::string& path = request.path;
    const size_t end = path.find('/', 1);
    if (end == std::string::npos || !is_equal_secretly(path.substr(1, end - 1), secret_)) {
      return refuse(response, 404, "the address lacks the secret that e2lf view printed");
    }
    const std::string name = path.substr(end + 1);
    if (!is_command && send(name, response)) return;
    const auto other = handler_ ? handler_({is_command, name, {request.params.begin(), request.params.end()}})
                                : std::optional<Response>();
    if (!other) return refuse(response, 404, "there is no such part");
    response.status = other->status;
    response.set_content(other->body, other->type);
  }

  struct ServedDocument {
    uint64_t version;
    std::string description;
    Document document;
  };

  [[nodiscard]] std::shared_ptr<const ServedDocument> shown() const {
    const std::lock_guard lock(mutex_);
    return shown_;
  }

  /// Returns false if `name` is not of the document.
  bool send(const std::string& name, httplib::Response& response) const {
    const auto now = shown();
    if (name.empty()) {
      response.set_content(empty_page().data(), empty_page().size(), "text/html; charset=utf-8");
    } else if (name == "version") {
      response.set_content(std::to_string(now->version), "text/plain");
    } else if (name == "document.json") {
      response.set_content(now->description, "application/json");
    } else {
      const auto number = parse_number<size_t>(name.starts_with("part/") ? name.substr(5) : "");
      if (!number || *number >= now->document.parts().size()) return false;
      const auto bytes = now->document.parts()[*number]();
      if (!bytes) {
        refuse(response, 500, bytes.error().text().c_str());
      } else {
        response.set_content(reinterpret_cast<const char*>(bytes->data()), bytes->size(), "application/octet-stream");
      }
    }
    return true;
  }

  const std::string secret_ = random_secret();
  Handler handler_;
  mutable std::mutex mutex_;
  std::shared_ptr<const ServedDocument> shown_;
  int port_ = 0;
  std::atomic<bool> has_ended_ = false;
  ConnectionServer server_;
};

}  // namespace

Result<std::unique_ptr<Server>> Server::create(Document document, uint16_t port, Handler handler) {
  auto server = std::make_unique<DocumentServer>(std::move(document), std::move(handler));
  E2LF_RETURN_IF_ERROR(server->bind(port));
  return std::unique_ptr<Server>(std::move(server));
}

}  // namespace e2lf::view
