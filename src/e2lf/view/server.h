// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/view/document.h"

namespace e2lf::view {

/// Serves a document and its page to browsers of this computer, and nothing else: it never opens a file that a request
/// names. It listens on 127.0.0.1 alone. Every address holds a secret of 128 random bits. A request is refused (403)
/// unless its Host is this server's own (a page of another site that points its name at 127.0.0.1 has another one), and
/// when its Origin or Sec-Fetch-Site says that another site made it.
class Server {
 public:
  /// Binds the port; 0 = any free one. Fails with kIo where it is taken.
  [[nodiscard]] static Result<Server> create(Document document, uint16_t port);

  Server(Server&&) noexcept;
  Server& operator=(Server&&) noexcept;
  ~Server();

  /// Shows another document from now on. Parts of the one before that are being made are finished. May be called from
  /// any thread.
  void replace(Document document);

  /// Where the page is: http://127.0.0.1:<port>/<secret>/
  [[nodiscard]] std::string url() const;

  /// Answers until stop_requested() or end(). Fails with kIo.
  [[nodiscard]] Result<void> run();

  /// Ends run(), soon. May be called from any thread.
  void end();

 private:
  class Impl;
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace e2lf::view
