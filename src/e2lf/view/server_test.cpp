// SPDX-License-Identifier: MIT
#include "e2lf/view/server.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace e2lf::view {
namespace {

/// A connection of a client to a port of this computer.
class Client {
 public:
  explicit Client(uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  Client(Client&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}
  ~Client() {
    if (socket_ >= 0) ::close(socket_);
  }

  void send(const std::string& text) const {
    EXPECT_EQ(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
  }
  /// Returns what the server sends until it closes the connection.
  [[nodiscard]] std::string received() const {
    std::string all;
    char part[4096];
    for (ssize_t count = 0; (count = ::recv(socket_, part, sizeof part, 0)) > 0;) {
      all.append(part, static_cast<size_t>(count));
    }
    return all;
  }

 private:
  int socket_;
};

TEST(Server, RequestsThatNeverEndNeitherBlockThePageNorTheStop) {
  const std::unique_ptr<Server> server = Server::create(Document(), 0).value();
  const std::string url = server->url(), port = url.substr(17, url.find('/', 17) - 17);
  const std::string path = url.substr(17 + port.size());
  std::thread running([&] { EXPECT_TRUE(server->run()); });
  const auto ask = [&] {
    const Client client(static_cast<uint16_t>(std::stoi(port)));
    client.send("GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1:" + port + "\r\nConnection: close\r\n\r\n");
    EXPECT_TRUE(client.received().starts_with("HTTP/1.1 200"));
  };
  ask();
  std::vector<Client> slow;
  for (size_t i = 0; i < 12; ++i) {  // more than httplib has threads
    slow.emplace_back(static_cast<uint16_t>(std::stoi(port))).send("GET / HTTP/1.1\r\nX-Slow: ");
  }
  ask();
  server->end();
  running.join();
}

TEST(Server, WhatFollowsARequestWithABodyIsNotExecuted) {
  size_t commands = 0;
  const std::unique_ptr<Server> server = Server::create(Document(), 0, [&](const Request& request) {
                                           commands += request.is_command;
                                           return std::optional<Response>({200, "text/plain", "done"});
                                         }).value();
  const std::string url = server->url(), port = url.substr(17, url.find('/', 17) - 17);
  const std::string path = url.substr(17 + port.size()), host = " HTTP/1.1\r\nHost: 127.0.0.1:" + port + "\r\n";
  std::thread running([&] { EXPECT_TRUE(server->run()); });
  const std::string hidden = "POST " + path + "hidden" + host + "\r\n";
  const std::string length = "Content-Length: " + std::to_string(hidden.size()) + "\r\n";
  const auto answers = [&](const std::string& text) {
    const Client client(static_cast<uint16_t>(std::stoi(port)));
    client.send(text);
    const std::string all = client.received();
    std::vector<std::string> codes;
    for (size_t at = 0; (at = all.find("HTTP/1.1 ", at)) != std::string::npos; ++at) {
      codes.push_back(all.substr(at + 9, 3));
    }
    return codes;
  };
  using Codes = std::vector<std::string>;
  const std::string foreign = "Origin: http://evil.example\r\n", chunked = "Transfer-Encoding: chunked\r\n";
  EXPECT_EQ(answers("POST /x" + host + foreign + length + "\r\n" + hidden), Codes{"403"});
  EXPECT_EQ(answers("POST /x" + host + foreign + chunked + "\r\n" + hidden), Codes{"403"});
  EXPECT_EQ(answers("POST /x" + host + foreign + "Connection: keep-alive\r\n" + length + "\r\n" + hidden),
            Codes{"403"});
  EXPECT_EQ(answers("POST /x" + host + "Content-Length: 0\r\n" + foreign + length + "\r\n" + hidden), Codes{"403"});
  EXPECT_EQ(answers("PUT " + path + host + length + "\r\n" + hidden), Codes{"405"});
  EXPECT_EQ(answers("POST /x" + host + length + "\r\n" + hidden), Codes{"404"});
  EXPECT_EQ(answers("GET /x" + host + length + "\r\n" + hidden), Codes{"404"});
  EXPECT_EQ(answers("GET " + path + host + length + "\r\n" + hidden), Codes{"200"});
  EXPECT_EQ(answers("nonsense\r\n" + hidden), Codes{"400"});
  EXPECT_EQ(answers("GET /" + std::string(10'000, 'x') + host + "\r\n" + hidden), Codes{"414"});
  EXPECT_EQ(answers("POST /x" + host + foreign + "Content-Length: 1000000\r\n\r\n" + std::string(1'000'000, 'x')),
            Codes{"403"});
  EXPECT_EQ(commands, 0u);
  // Requests of the page, which have no body, share a connection.
  const std::string last = "GET " + path + "version" + host + "Connection: close\r\n\r\n";
  EXPECT_EQ(answers("POST " + path + "command" + host + "Content-Length: 0\r\n\r\n" + hidden + last),
            (Codes{"200", "200", "200"}));
  EXPECT_EQ(commands, 2u);
  server->end();
  running.join();
}

}  // namespace
}  // namespace e2lf::view
