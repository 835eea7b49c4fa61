// SPDX-License-Identifier: MIT
#include "e2lf/view/server.h"

#include <atomic>
#include <chrono>
#include <httplib.h>
#include <mutex>
#include <random>
#include <sys/socket.h>
#include <thread>

#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::view {

namespace {

constexpr std::chrono::seconds kMostSilence{3};  // of a client that sends a request or receives an answer
constexpr size_t kThreads = 64;                  // so that slow clients do not keep the others waiting
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
    // Bodies are not read. What follows one would otherwise be executed as the next request.
    server_.set_keep_alive_max_count(1);
    server_.set_keep_alive_timeout(kMostSilence.count());
    server_.set_read_timeout(kMostSilence);
    server_.set_write_timeout(kMostSilence);
    server_.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
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
      server_.stop();
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
      const auto number = recordings::parse_number<size_t>(name.starts_with("part/") ? name.substr(5) : "");
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
  httplib::Server server_;
};

}  // namespace

Result<std::unique_ptr<Server>> Server::create(Document document, uint16_t port, Handler handler) {
  auto server = std::make_unique<DocumentServer>(std::move(document), std::move(handler));
  E2LF_RETURN_IF_ERROR(server->bind(port));
  return std::unique_ptr<Server>(std::move(server));
}

}  // namespace e2lf::view
