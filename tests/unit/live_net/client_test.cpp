// SPDX-License-Identifier: Apache-2.0
#include "echo_server.h"
#include "live/net/http.h"

namespace fourdvt::live {
namespace {

class Clients : public EchoServer {};

TEST_F(Clients, ReconnectAfterTheServerHasRestarted) {
  start();
  LoggedClient client(url());
  ASSERT_TRUE(client.opens.waitFor(1));
  server_.reset();
  ASSERT_TRUE(client.closes.waitFor(2));  // the loss, and at least one failed attempt
  EXPECT_FALSE(client.client->open());
  client.client->send(bytesOf("dropped"));
  EXPECT_EQ(client.client->queuedBytes(), 0u);
  options_.port = port_;
  start();
  ASSERT_TRUE(client.opens.waitFor(2));
  client.client->send(bytesOf("again"));
  ASSERT_TRUE(client.messages.waitFor(1));
  EXPECT_EQ(client.messages.values()[0], "again");
  EXPECT_FALSE(client.refused);
}

TEST_F(Clients, EndWhenTheyAreRefused) {
  start();
  LoggedClient unauthorised(url("/unauthorised")), replaced(url("/replaced"));
  EXPECT_TRUE(eventually([&] { return unauthorised.refused && replaced.refused; }));
  EXPECT_EQ(unauthorised.closes.values().size(), 1u);
  EXPECT_NE(unauthorised.closes.values()[0].find("401"), std::string::npos);
  EXPECT_NE(replaced.closes.values()[0].find("4409 replaced"), std::string::npos);
}

TEST_F(Clients, TryAgainWhenTheServerIsBusy) {
  start();
  LoggedClient client(url("/busy"));
  ASSERT_TRUE(client.closes.waitFor(3));
  EXPECT_FALSE(client.refused);
}

TEST_F(Clients, SendTheirToken) {
  start();
  LoggedClient client(url(), "secret");
  ASSERT_TRUE(handler_.opens.waitFor(1));
  EXPECT_EQ(handler_.opens.values()[0]->request().token, "secret");
}

TEST_F(Clients, EndWhileTheyConnect) {
  start();
  RawSocket silent(port_);
  for (int i = 0; i < 20; ++i) LoggedClient brief(url());
  LoggedClient nowhere("ws://127.0.0.1:1");
  EXPECT_TRUE(nowhere.closes.waitFor(1));
}

TEST(Urls, AreReadInParts) {
  const auto url = parseUrl("wss://host.example:8443/camera?x=1");
  ASSERT_TRUE(url.ok());
  EXPECT_TRUE(url.value().tls);
  EXPECT_EQ(url.value().host, "host.example");
  EXPECT_EQ(url.value().port, "8443");
  EXPECT_EQ(url.value().target, "/camera?x=1");
  EXPECT_EQ(url.value().authority, "host.example:8443");
  EXPECT_EQ(parseUrl("ws://[::1]:80").value().host, "::1");
  EXPECT_EQ(parseUrl("ws://a").value().port, "80");
  EXPECT_EQ(parseUrl("wss://a").value().port, "443");
  EXPECT_EQ(parseUrl("ws://a?b").value().target, "/?b");
  for (const char* wrong : {"", "http://a", "ws://", "ws://:80", "ws://a:0", "ws://a:65536", "ws://a:x", "ws://a b",
                            "ws://me@a", "ws://[::1", "ws://[]:1", "ws://a/#b", "ws://a\r\nX: y"})
    EXPECT_FALSE(parseUrl(wrong).ok()) << wrong;
}

TEST(Urls, TargetsAreDecoded) {
  const auto target = parseTarget("/a%2Fb/%c3%a4?x=1&token=p%26q+r&empty&=no");
  ASSERT_TRUE(target);
  EXPECT_EQ(target->path, "/a/b/ä");
  EXPECT_EQ(target->query.at("token"), "p&q r");
  EXPECT_EQ(target->query.at("empty"), "");
  EXPECT_EQ(target->query.size(), 3u);
  for (const char* wrong : {"", "a", "*", "/%", "/%1", "/%g0", "/%00", "/?a=%0"})
    EXPECT_FALSE(parseTarget(wrong)) << wrong;
}

TEST(Urls, ReasonsAreCutBetweenCharacters) {
  EXPECT_EQ(cutText("abc", 3), "abc");
  EXPECT_EQ(cutText("abcd", 3), "abc");
  EXPECT_EQ(cutText("abä", 3), "ab");
}

}  // namespace
}  // namespace fourdvt::live
