// SPDX-License-Identifier: MIT
#include "e2lf/recordings/io/tcp.h"

#include <arpa/inet.h>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "e2lf/base/text.h"

namespace e2lf::recordings {
namespace {

constexpr std::string_view kTcpScheme = "tcp://";

Result<sockaddr_in> parse_address(const std::string& name) {
  const Error malformed{ErrorCode::kInvalidValue, "not a TCP address; write tcp://127.0.0.1:PORT", name};
  const size_t colon = name.rfind(':');
  if (!name.starts_with(kTcpScheme) || colon <= kTcpScheme.size()) return malformed;
  uint16_t port = 0;
  const char* end = name.data() + name.size();
  const auto parsed = std::from_chars(name.data() + colon + 1, end, port);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  const std::string host = name.substr(kTcpScheme.size(), colon - kTcpScheme.size());
  if (parsed.ec != std::errc() || parsed.ptr != end || ::inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1) {
    return malformed;
  }
  return address;
}

}  // namespace

Result<int> connect_tcp(const std::string& name) {
  E2LF_ASSIGN_OR_RETURN(const sockaddr_in address, parse_address(name));
  const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0 || ::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    const std::string reason = std::strerror(errno);
    if (descriptor >= 0) ::close(descriptor);
    return Error{ErrorCode::kIo, cat("cannot connect (", reason, "); start the sender first"), name};
  }
  return descriptor;
}

}  // namespace e2lf::recordings
