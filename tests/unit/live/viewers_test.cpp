// SPDX-License-Identifier: Apache-2.0
#include "live/viewers.h"

#include "live/pages.h"
#include "service_fixture.h"

namespace fourdvt::live {
namespace {

// Connection with a queue length set by the test.
struct FakeConnection final : Connection {
  HttpRequest opened_with;
  std::vector<std::string> sent;
  size_t bytes = 0, messages = 0;
  const HttpRequest& request() const override { return opened_with; }
  void send(Bytes message, bool) override { sent.push_back(textOf(*message)); }
  size_t queuedBytes() const override { return bytes; }
  size_t queuedMessages() const override { return messages; }
  void close(uint16_t, const std::string&) override {}
};

using Sent = std::vector<std::string>;

TEST(SkipPolicy, BeginsWithTheManifestAndAKey) {
  Viewers viewers;
  const auto viewer = std::make_shared<FakeConnection>();
  viewers.add(viewer, "manifest");
  viewers.send(bytesOf("1"), false);
  viewers.send(bytesOf("2"), true);
  viewers.send(bytesOf("3"), false);
  EXPECT_EQ(viewer->sent, (Sent{"manifest", "2", "3"}));
  EXPECT_EQ(viewers.status().frames_skipped, 0u);
}

TEST(SkipPolicy, OneThatIsBehindMissesFramesUpToTheNextKeyAndOthersNone) {
  for (const bool by_bytes : {false, true}) {
    Viewers viewers;
    const auto slow = std::make_shared<FakeConnection>(), quick = std::make_shared<FakeConnection>();
    viewers.add(slow, "m");
    viewers.add(quick, "m");
    viewers.send(bytesOf("k1"), true);
    slow->messages = 2;  // still not too many
    slow->bytes = 96 << 10;
    viewers.send(bytesOf("2"), false);
    (by_bytes ? slow->bytes : slow->messages) += 1;
    viewers.send(bytesOf("3"), false);
    viewers.send(bytesOf("k4"), true);  // its queue is too long at a key, too
    slow->messages = slow->bytes = 0;
    viewers.send(bytesOf("5"), false);  // its queue is short, but earlier frames are missing
    viewers.send(bytesOf("k6"), true);
    viewers.send(bytesOf("7"), false);
    EXPECT_EQ(slow->sent, (Sent{"m", "k1", "2", "k6", "7"}));
    EXPECT_EQ(quick->sent, (Sent{"m", "k1", "2", "3", "k4", "5", "k6", "7"}));
    EXPECT_EQ(viewers.status().frames_skipped, 3u);
    EXPECT_EQ(viewers.status().viewers, 2u);
    viewers.remove(slow);
    viewers.send(bytesOf("8"), false);
    EXPECT_EQ(slow->sent.size(), 5u);
  }
}

std::span<const uint8_t> spanOf(const std::string& text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

TEST(PageMessages, OfViewersArePings) {
  const auto ping = readPageMessage(spanOf("{\"type\":\"ping\",\"t\":1.5}"), false);
  ASSERT_TRUE(ping.ok());
  EXPECT_EQ(ping.value().ping_t, 1.5);
  EXPECT_EQ(pongJson(1.5, 7), "{\"now\":7,\"t\":1.5,\"type\":\"pong\"}");
  for (const char* wrong : {"", "1", "[]", "{}", "{", "{\"type\":\"ping\"}", "{\"type\":\"ping\",\"t\":\"1\"}",
                            "{\"type\":\"pong\",\"t\":1}", "{\"type\":\"ping\",\"t\":1,\"x\":1}",
                            "{\"type\":\"ping\",\"t\":1e999}", "{\"crf\":20}", "{\"tolerance_px\":1}"})
    EXPECT_FALSE(readPageMessage(spanOf(wrong), false).ok()) << wrong;
  const std::string deep(1024, '[');
  EXPECT_FALSE(readPageMessage(spanOf(deep), false).ok());
  EXPECT_FALSE(readPageMessage(spanOf("{\"type\":\"ping\",\"t\":1}" + std::string(1024, ' ')), false).ok());
}

TEST(PageMessages, OfTheConsoleSetToleranceAndQuality) {
  const auto both = readPageMessage(spanOf("{\"tolerance_px\":2.5,\"crf\":30}"), true);
  ASSERT_TRUE(both.ok());
  EXPECT_EQ(both.value().tolerance_px, 2.5);
  EXPECT_EQ(both.value().crf, 30);
  EXPECT_TRUE(readPageMessage(spanOf("{\"tolerance_px\":0}"), true).ok());
  EXPECT_TRUE(readPageMessage(spanOf("{\"type\":\"ping\",\"t\":1}"), true).ok());
  for (const char* wrong : {"{}", "{\"crf\":20.5}", "{\"crf\":52}", "{\"crf\":-1}", "{\"tolerance_px\":65}",
                            "{\"tolerance_px\":null}", "{\"tolerance_px\":1,\"x\":2}"})
    EXPECT_FALSE(readPageMessage(spanOf(wrong), true).ok()) << wrong;
}

class LiveViewers : public ServiceTest {};

TEST_F(LiveViewers, GetTheManifestThenFramesFromAKeyOn) {
  start();
  LoggedClient viewer(url("/live"));
  ASSERT_TRUE(viewer.messages.waitFor(1));
  EXPECT_EQ(viewer.messages.values()[0], "{\"the\":\"manifest\"}");
  ASSERT_TRUE(pipeline_.waitFor("key"));
  frame("no key", false);
  frame("key", true);
  frame("next", false);
  ASSERT_TRUE(viewer.messages.waitFor(3));
  EXPECT_EQ(viewer.messages.values(), (Sent{"{\"the\":\"manifest\"}", "key", "next"}));
  EXPECT_EQ(service_->status().viewers.viewers, 1u);
}

TEST_F(LiveViewers, OneThatNeverReadsSlowsNobody) {
  start();
  const auto dead = open("/live", {}, 101, 4096);
  LoggedClient viewer(url("/live"));
  ASSERT_TRUE(viewer.messages.waitFor(1));
  ASSERT_TRUE(eventually([&] { return service_->status().viewers.viewers == 2; }));
  const std::string large(60000, 'x');
  for (size_t i = 0; i < 60; ++i) {
    frame(large, true);
    ASSERT_TRUE(viewer.messages.waitFor(2 + i));  // receives every frame
  }
  const uint64_t skipped = service_->status().viewers.frames_skipped;
  EXPECT_GE(skipped, 40u);  // all of the dead viewer's, except those in its socket
  EXPECT_LT(skipped, 60u);
}

TEST_F(LiveViewers, PingsAreAnsweredAndAnythingElseCloses) {
  start();
  const auto viewer = open("/live");
  viewer->receiveFrame();
  viewer->send(clientFrame("{\"type\":\"ping\",\"t\":12.5}", 1));
  const std::string pong = viewer->receiveFrame();
  EXPECT_NE(pong.find("\"t\":12.5"), std::string::npos) << pong;
  EXPECT_NE(pong.find("\"now\":1"), std::string::npos) << pong;
  viewer->send(clientFrame("{\"crf\":20}", 1));
  EXPECT_EQ(viewer->receiveClose(), kCloseInvalid);
  EXPECT_EQ(pipeline_.count("crf 20"), 0u);
  const auto bytes = open("/live"), large = open("/live"), often = open("/live");
  bytes->send(clientFrame("{\"type\":\"ping\",\"t\":1}", 2));
  EXPECT_EQ(bytes->receiveClose(), kCloseInvalid);
  large->send(clientFrame("{\"type\":\"ping\",\"t\":1}" + std::string(1100, ' '), 1));
  EXPECT_EQ(large->receiveClose(), 1009);
  std::string burst;
  for (int i = 0; i < 200; ++i) burst += clientFrame("{\"type\":\"ping\",\"t\":1}", 1);
  often->send(burst);
  EXPECT_EQ(often->receiveClose(), 1008);
  expectOthersServed();
}

TEST_F(LiveViewers, TheConsoleGetsTheStatusAndSetsThings) {
  start();
  LoggedClient console(url("/console"));
  ASSERT_TRUE(console.messages.waitFor(2));  // at once, and a second later
  EXPECT_NE(console.messages.values()[0].find("\"frames\":42"), std::string::npos);
  console.client->send(bytesOf("{\"tolerance_px\":4}"), true);
  console.client->send(bytesOf("{\"crf\":30}"), true);
  EXPECT_TRUE(pipeline_.waitFor("tolerance 4"));
  EXPECT_TRUE(pipeline_.waitFor("crf 30"));
  EXPECT_EQ(service_->status().viewers.viewers, 0u);
}

}  // namespace
}  // namespace fourdvt::live
