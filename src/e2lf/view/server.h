// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/view/document.h"

namespace e2lf::view {

/// A request that the server passes to the calling code.
struct Request {
  bool is_command = false;  ///< POST instead of GET
  std::string name;         ///< path after the secret
  std::map<std::string, std::string> parameters;
};
/// The reply to a Request.
struct Response {
  int status = 200;  ///< HTTP status code
  std::string type, body;
};
/// Answers a request, or returns nothing if it is unknown. Called by several threads at a time.
using Handler = std::function<std::optional<Response>(const Request&)>;

/// Serves a document and its page to browsers on this computer, and nothing else: it never opens a file named by a
/// request. It listens on 127.0.0.1 only. Every address contains a secret of 128 random bits. A request is refused
/// (403) unless its Host is this server's own: a page of another site that resolves its name to 127.0.0.1 has another
/// Host. It is also refused if its Origin or Sec-Fetch-Site shows that it comes from another site. Bodies of requests
/// are not read: the connection ends after the answer to a request that has one.
class Server {
 public:
  /// Binds the port; 0 selects any free one. `handler` receives commands and the requests that the document does not
  /// answer; without it, commands are refused. Fails with kIo if the port is in use.
  [[nodiscard]] static Result<std::unique_ptr<Server>> create(Document document, uint16_t port, Handler handler = {});
  virtual ~Server() = default;

  /// Shows another document from now on. Requests for parts of the previous one that have already begun are
  /// completed. It may be called from any thread.
  virtual void replace(Document document) = 0;

  /// Returns the address of the page: http://127.0.0.1:<port>/<secret>/
  [[nodiscard]] virtual std::string url() const = 0;

  /// Answers requests until stop_requested() or end(). Fails with kIo.
  [[nodiscard]] virtual Result<void> run() = 0;

  /// Ends run() soon afterwards. It may be called from any thread.
  virtual void end() = 0;
};

}  // namespace e2lf::view
