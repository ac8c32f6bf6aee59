// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>

#include "echo_server.h"

namespace fourdvt::live {
namespace {

class Http : public EchoServer {
 protected:
  void SetUp() override {
    path_ = testing::TempDir() + "live_net_http.bin";
    for (int i = 0; i < 200000; ++i) content_ += static_cast<char>(i * 7 + i / 256);
    std::FILE* file = std::fopen(path_.c_str(), "wb");
    ASSERT_TRUE(file);
    std::fwrite(content_.data(), 1, content_.size(), file);
    std::fclose(file);
    handler_.file = path_;
    start();
  }
  void TearDown() override { std::filesystem::remove(path_); }

  std::string path_, content_;
};

TEST_F(Http, HandsTheRequestOn) {
  const std::string answer =
      ask(port_, "GET /a%20b?token=query", "Origin: http://x.y\r\nAuthorization: Bearer header\r\n");
  EXPECT_EQ(statusOf(answer), 200);
  EXPECT_EQ(bodyOf(answer), "/a b|127.0.0.1|http://x.y|header");
  EXPECT_EQ(bodyOf(ask(port_, "GET /?token=query")), "/|127.0.0.1||query");
}

TEST_F(Http, KeepsTheConnectionForFurtherRequests) {
  RawSocket socket(port_);
  socket.send("GET /one HTTP/1.1\r\nHost: h\r\n\r\nGET /two HTTP/1.1\r\nHost: h\r\n\r\n");  // at once
  socket.receive("/one|h||");
  socket.receive("/two|h||");
  socket.send("HEAD /three HTTP/1.1\r\nHost: h\r\n\r\n");
  EXPECT_NE(socket.receive("\r\n\r\n").find("Content-Length: 10"), std::string::npos);
  socket.send("GET /four HTTP/1.0\r\n\r\n");
  const std::string last = socket.receive();  // until the server closes
  EXPECT_EQ(bodyOf(last), "/four|||");
}

TEST_F(Http, SendsFilesInWhole) {
  const std::string answer = ask(port_, "GET /file");
  EXPECT_EQ(statusOf(answer), 200);
  EXPECT_TRUE(bodyOf(answer) == content_);
  const std::string head = ask(port_, "HEAD /file");
  EXPECT_EQ(bodyOf(head), "");
  EXPECT_NE(head.find("Content-Length: 200000"), std::string::npos);
}

TEST_F(Http, SendsRangesOfFiles) {
  const auto part = [&](const std::string& range) { return ask(port_, "GET /file", "Range: bytes=" + range + "\r\n"); };
  const std::string middle = part("1000-69999");
  EXPECT_EQ(statusOf(middle), 206);
  EXPECT_NE(middle.find("Content-Range: bytes 1000-69999/200000"), std::string::npos);
  EXPECT_TRUE(bodyOf(middle) == content_.substr(1000, 69000));
  EXPECT_TRUE(bodyOf(part("199990-")) == content_.substr(199990));
  EXPECT_TRUE(bodyOf(part("-5")) == content_.substr(199995));
  EXPECT_TRUE(bodyOf(part("199999-300000")) == content_.substr(199999));
  EXPECT_EQ(statusOf(part("200000-")), 416);
  EXPECT_EQ(statusOf(part("0-1,5-6")), 200);
  EXPECT_EQ(statusOf(part("9-1")), 200);
}

TEST_F(Http, SaysThatAFileHasNotChanged) {
  const std::string answer = ask(port_, "HEAD /file");
  const size_t at = answer.find("ETag: ") + 6;
  const std::string tag = answer.substr(at, answer.find("\r\n", at) - at);
  EXPECT_EQ(statusOf(ask(port_, "GET /file", "If-None-Match: " + tag + "\r\n")), 304);
  EXPECT_EQ(statusOf(ask(port_, "GET /file", "If-None-Match: \"other\"\r\n")), 200);
}

TEST_F(Http, AnswersMissingFilesAndFoldersWith404) {
  handler_.file = path_ + ".missing";
  EXPECT_EQ(statusOf(ask(port_, "GET /file")), 404);
  handler_.file = testing::TempDir();
  EXPECT_EQ(statusOf(ask(port_, "GET /file")), 404);
}

TEST_F(Http, RefusesWhatItDoesNotServe) {
  EXPECT_EQ(statusOf(ask(port_, "POST /")), 405);
  EXPECT_EQ(statusOf(ask(port_, "GET nowhere")), 400);
  EXPECT_EQ(statusOf(ask(port_, "GET /%00")), 400);
  EXPECT_EQ(statusOf(ask(port_, "GET /%zz")), 400);
  EXPECT_EQ(statusOf(ask(port_, "GET /", "Content-Length: 5\r\n")), 400);
  EXPECT_EQ(statusOf(ask(port_, "GET /", "X: " + std::string(9000, 'x') + "\r\n")), 431);
  RawSocket garbage(port_), endless(port_);
  garbage.send(std::string(200, '\x80') + "\r\n\r\n");
  EXPECT_EQ(statusOf(garbage.receive()), 400);
  endless.send(std::string(100000, 'x'));
  EXPECT_EQ(statusOf(endless.receive()), 431);
  expectEcho();
}

TEST_F(Http, AnExceptionOfTheHandlerEndsThatConnectionOnly) {
  EXPECT_EQ(ask(port_, "GET /throws"), "");
  expectEcho();
}

TEST_F(Http, RefusesWebSocketsWithTheHandlersStatus) {
  RawSocket socket(port_);
  socket.send(upgradeRequest("/unauthorised"));
  const std::string answer = socket.receive();
  EXPECT_EQ(statusOf(answer), 401);
  EXPECT_EQ(bodyOf(answer), "no token");
  EXPECT_TRUE(handler_.opens.values().empty());
}

TEST_F(Http, AClientThatReadsNoneOfAFileHarmsNobody) {
  RawSocket slow(port_, 4096);
  slow.send("GET /file HTTP/1.1\r\nHost: h\r\n\r\n");
  expectEcho();
  EXPECT_TRUE(bodyOf(ask(port_, "GET /file")) == content_);
}

TEST_F(Http, AnswersConnectionsBeyondTheMostWith503) {
  server_.reset();
  options_.max_connections = 2;
  start();
  {
    const auto one = openRaw(), two = openRaw();
    EXPECT_EQ(statusOf(ask(port_, "GET /")), 503);
  }
  ASSERT_TRUE(handler_.closes.waitFor(2));
  EXPECT_TRUE(eventually([&] { return statusOf(ask(port_, "GET /")) == 200; }));
}

TEST_F(Http, SaysWhichPortIsInUse) {
  ServerOptions options;
  options.port = port_;
  const auto again = Server::start(options, handler_);
  ASSERT_FALSE(again.ok());
  EXPECT_EQ(again.error().id, ErrorId::InvalidArgument);
  EXPECT_NE(again.error().message.find(std::to_string(port_)), std::string::npos);
  options.address = "nowhere";
  EXPECT_FALSE(Server::start(options, handler_).ok());
}

}  // namespace
}  // namespace fourdvt::live
