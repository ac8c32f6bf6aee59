// SPDX-License-Identifier: Apache-2.0
// Server that sends back every message, for the tests of this folder.
#pragma once

#include "socket_fixture.h"

namespace fourdvt::live {

struct EchoHandler final : ServerHandler {
  SocketLimits limits;
  std::string file;
  Log<std::shared_ptr<Connection>> opens;
  Log<std::shared_ptr<Connection>> closes;
  Log<std::string> messages;

  HttpAnswer onGet(const HttpRequest& request) override {
    HttpAnswer answer;
    if (request.path == "/file") {
      answer.file = file;
      answer.type = "application/octet-stream";
    } else if (request.path == "/throws") {
      throw std::runtime_error("thrown by the handler");
    } else {
      answer.body = request.path + "|" + request.host + "|" + request.origin + "|" + request.token;
    }
    return answer;
  }
  Result<SocketLimits> onOpening(const HttpRequest& request, int& refused_status) override {
    if (request.path == "/unauthorised") {
      refused_status = 401;
      return Error{ErrorId::InvalidArgument, "no token"};
    }
    if (request.path == "/busy") {
      refused_status = 503;
      return Error{ErrorId::InvalidArgument, "busy"};
    }
    return limits;
  }
  void onOpen(const std::shared_ptr<Connection>& connection) override {
    opens.add(connection);
    if (connection->request().path == "/replaced") connection->close(4409, "replaced");
  }
  void onMessage(const std::shared_ptr<Connection>& connection, std::span<const uint8_t> bytes, bool text) override {
    messages.add(textOf(bytes));
    if (textOf(bytes) == "throw") throw std::runtime_error("thrown by the handler");
    connection->send(bytesOf(textOf(bytes)), text);
  }
  void onClose(const std::shared_ptr<Connection>& connection) override { closes.add(connection); }
};

class EchoServer : public testing::Test {
 protected:
  void start() {
    auto started = Server::start(options_, handler_);
    ASSERT_TRUE(started.ok()) << started.error().message;
    server_ = started.take();
    port_ = server_->port();
  }
  std::string url(const std::string& path = "/") const { return "ws://127.0.0.1:" + std::to_string(port_) + path; }
  // Expects that another client is still served.
  void expectEcho() {
    LoggedClient other(url());
    ASSERT_TRUE(other.opens.waitFor(1));
    other.client->send(bytesOf("still there?"));
    ASSERT_TRUE(other.messages.waitFor(1));
    EXPECT_EQ(other.messages.values()[0], "still there?");
  }
  // Raw socket with an open WebSocket.
  std::unique_ptr<RawSocket> openRaw(int receive_bytes = 0) {
    auto socket = std::make_unique<RawSocket>(port_, receive_bytes);
    socket->send(upgradeRequest("/"));
    EXPECT_EQ(statusOf(socket->receive("\r\n\r\n")), 101);
    return socket;
  }

  EchoHandler handler_;
  ServerOptions options_;
  std::unique_ptr<Server> server_;
  uint16_t port_ = 0;
};

}  // namespace fourdvt::live
