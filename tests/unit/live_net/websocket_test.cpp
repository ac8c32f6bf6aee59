// SPDX-License-Identifier: Apache-2.0
#include "live/net/websocket.h"

#include "echo_server.h"

namespace fourdvt::live {
namespace {

class WebSockets : public EchoServer {};

TEST_F(WebSockets, EchoesEveryMessageInOrder) {
  handler_.limits = {1 << 20, 1e6, 64 << 20};
  start();
  LoggedClient client(url("/?token=a%20b"));
  ASSERT_TRUE(client.opens.waitFor(1));
  std::vector<std::string> sent;
  for (size_t i = 0; i < 200; ++i) sent.push_back(std::string(i * 997 % 70000, static_cast<char>('a' + i % 26)));
  for (const std::string& message : sent) client.client->send(bytesOf(message));
  ASSERT_TRUE(client.messages.waitFor(sent.size()));
  EXPECT_EQ(client.messages.values(), sent);
  EXPECT_EQ(handler_.opens.values()[0]->request().token, "a b");
  EXPECT_TRUE(eventually([&] { return client.client->queuedBytes() == 0 && client.client->queuedMessages() == 0; }));
}

TEST_F(WebSockets, CloseHandshakeEndsTheConnectionOnce) {
  start();
  const auto socket = openRaw();
  socket->send(clientFrame(std::string("\x03\xe8", 2), 8));
  EXPECT_EQ(socket->receiveClose(), 1000);
  EXPECT_EQ(socket->receive(), "");
  ASSERT_TRUE(handler_.closes.waitFor(1));
  expectEcho();
  server_.reset();
  EXPECT_EQ(handler_.closes.values().size(), 2u);  // the other one is expectEcho()'s
}

TEST_F(WebSockets, RefusesAMessageThatIsTooLarge) {
  handler_.limits.max_message_bytes = 1000;
  start();
  const auto socket = openRaw();
  socket->send(clientFrame(std::string(1000, 'x')));
  EXPECT_EQ(socket->receiveFrame().size(), 1000u);
  socket->send(clientFrame(std::string(1001, 'x')));
  EXPECT_EQ(socket->receiveClose(), 1009);
  ASSERT_TRUE(handler_.closes.waitFor(1));
  EXPECT_EQ(handler_.messages.values().size(), 1u);
  expectEcho();
}

TEST_F(WebSockets, NeverWaitsForAMessageThatSaysItIsTooLarge) {
  start();
  const auto socket = openRaw();
  socket->send(std::string("\x82\xff\x7f\xff\xff\xff\xff\xff\xff\xff", 10) + std::string(4, '\0') + "some");
  const int code = socket->receiveClose();
  EXPECT_TRUE(code == 1009 || code == 1002) << code;
  ASSERT_TRUE(handler_.closes.waitFor(1));
  expectEcho();
}

TEST_F(WebSockets, ClosesWhoSendsTooManyMessages) {
  handler_.limits.max_messages_per_s = 5;
  start();
  const auto socket = openRaw();
  std::string burst;
  for (int i = 0; i < 1000; ++i) burst += clientFrame("m", 1);
  socket->send(burst);
  EXPECT_EQ(socket->receiveClose(), 1008);
  ASSERT_TRUE(handler_.closes.waitFor(1));
  const size_t count = handler_.messages.values().size();
  EXPECT_GE(count, 10u);  // a burst of two seconds' messages
  EXPECT_LT(count, 500u);
  expectEcho();
}

TEST_F(WebSockets, CountsPingsAsMessages) {
  handler_.limits.max_messages_per_s = 5;
  start();
  const auto socket = openRaw();
  std::string burst;
  for (int i = 0; i < 1000; ++i) burst += clientFrame("p", 9);
  socket->send(burst);
  EXPECT_EQ(socket->receiveClose(), 1008);
  expectEcho();
}

TEST_F(WebSockets, GarbageInPlaceOfAFrameEndsThatConnectionOnly) {
  start();
  const auto bad = openRaw(), unmasked = openRaw();
  bad->send(std::string(500, '\xff'));
  EXPECT_EQ(bad->receiveClose(), 1002);
  unmasked->send(std::string("\x82\x01x", 3));  // client frames must be masked
  EXPECT_EQ(unmasked->receiveClose(), 1002);
  ASSERT_TRUE(handler_.closes.waitFor(2));
  EXPECT_TRUE(handler_.messages.values().empty());
  expectEcho();
}

TEST_F(WebSockets, TextThatIsNoUtf8EndsTheConnection) {
  start();
  const auto socket = openRaw();
  socket->send(clientFrame("\xc3\x28", 1));
  EXPECT_EQ(socket->receiveClose(), 1007);
  expectEcho();
}

TEST_F(WebSockets, DoesNotWaitForAPeerThatNeverCloses) {
  start();
  const auto bad = openRaw(), asked = openRaw();
  bad->send(std::string(500, '\xff'));
  ASSERT_TRUE(handler_.opens.waitFor(2));
  handler_.opens.values()[1]->close(4001, "enough");
  EXPECT_TRUE(handler_.closes.waitFor(2));
}

TEST_F(WebSockets, CutInTheMiddleOfAFrame) {
  start();
  openRaw()->send(clientFrame(std::string(1000, 'x')).substr(0, 500));
  ASSERT_TRUE(handler_.closes.waitFor(1));
  EXPECT_TRUE(handler_.messages.values().empty());
  expectEcho();
}

TEST_F(WebSockets, TruncatedHandshakesHarmNobody) {
  options_.handshake_s = 0.05;
  start();
  const std::string request = upgradeRequest("/");
  for (const size_t bytes : {size_t{0}, size_t{1}, size_t{40}, request.size() - 1}) {
    RawSocket cut(port_), waiting(port_);
    cut.send(request.substr(0, bytes));
    waiting.send(request.substr(0, bytes));
    EXPECT_EQ(waiting.receive(), "") << bytes;  // closed by the server at its timeout
  }
  options_.handshake_s = 10;
  start();
  expectEcho();
  EXPECT_EQ(handler_.opens.values().size(), 1u);
}

TEST_F(WebSockets, ADeadClientIsCutAtItsLimitAndOthersGoOn) {
  handler_.limits.max_queued_bytes = 1 << 20;
  options_.idle_s = 10 * kPatience;  // excludes the idle timeout
  start();
  const auto dead = openRaw(4096);  // never reads
  ASSERT_TRUE(handler_.opens.waitFor(1));
  const auto connection = handler_.opens.values()[0];
  const Bytes message = bytesOf(std::string(50000, 'x'));
  const auto isCut = [&] {
    for (const auto& closed : handler_.closes.values())
      if (closed == connection) return true;
    return false;
  };
  for (int sent = 0; sent < 50; ++sent) {  // more than its socket holds, and twice the queue's limit
    connection->send(message);
    if (sent == 10) expectEcho();
  }
  ASSERT_TRUE(eventually(isCut));
  EXPECT_TRUE(eventually([&] { return connection->queuedBytes() == 0; }));  // its queue is released
  connection->send(message);
  EXPECT_EQ(connection->queuedBytes(), 0u);
  expectEcho();
}

TEST_F(WebSockets, AClientThatAnswersNoPingIsClosed) {
  options_.idle_s = 0.1;
  start();
  const auto silent = openRaw();  // reads nothing, sends nothing
  ASSERT_TRUE(handler_.opens.waitFor(1));
  EXPECT_TRUE(handler_.closes.waitFor(1));
}

TEST_F(WebSockets, AnExceptionOfTheHandlerEndsThatConnectionOnly) {
  start();
  const auto socket = openRaw();
  socket->send(clientFrame("throw"));
  EXPECT_EQ(socket->receiveClose(), 1011);
  expectEcho();
}

TEST_F(WebSockets, AClosedConnectionReceivesWhatWasSentBefore) {
  start();
  const auto socket = openRaw();
  ASSERT_TRUE(handler_.opens.waitFor(1));
  const auto connection = handler_.opens.values()[0];
  connection->send(bytesOf("last words"), true);
  connection->close(4001, "enough");
  connection->send(bytesOf("never sent"), true);
  EXPECT_EQ(socket->receiveFrame(), "last words");
  EXPECT_EQ(socket->receiveClose(), 4001);
  ASSERT_TRUE(handler_.closes.waitFor(1));
}

TEST_F(WebSockets, EndingTheServerClosesAll) {
  start();
  const auto one = openRaw(), two = openRaw();
  RawSocket idle(port_);
  ASSERT_TRUE(handler_.opens.waitFor(2));
  server_.reset();
  EXPECT_EQ(one->receiveClose(), 1001);
  EXPECT_EQ(two->receiveClose(), 1001);
  EXPECT_EQ(idle.receive(), "");
  EXPECT_EQ(handler_.closes.values().size(), 2u);
  handler_.opens.values()[0]->send(bytesOf("too late"));  // harmless
}

TEST_F(WebSockets, CallsActionsPeriodically) {
  start();
  Log<int> calls;
  server_->every(0.001, [&] { calls.add(1); });
  EXPECT_TRUE(calls.waitFor(5));
  server_.reset();  // no call may come after the end of `calls`
}

}  // namespace
}  // namespace fourdvt::live
