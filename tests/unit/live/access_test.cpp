// SPDX-License-Identifier: Apache-2.0
#include "live/access.h"

#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "live/pages.h"
#include "service_fixture.h"

namespace fourdvt::live {
namespace {

class Access : public ServiceTest {
 protected:
  Access() : folder_(testing::TempDir() + "live_access") {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~Access() override { std::filesystem::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& text) {
    const std::string path = folder_ + "/" + name;
    std::filesystem::create_directories(std::filesystem::path(path).parent_path());
    std::ofstream(path) << text;
    return path;
  }
  void demandTokens() { options_.access.tokens = {"camera-token-1234", "viewer-token-1234", "console-token-123"}; }
  // Expects that a page's WebSocket opens and is closed at once, without a message before.
  void expectClosed(const std::string& target, int code, const std::string& fields = {}) {
    int opcode = 0;
    const auto socket = open(target, fields);
    const std::string payload = socket->receiveFrame(&opcode);
    ASSERT_EQ(opcode, 8) << target << " " << fields;
    EXPECT_EQ(static_cast<uint8_t>(payload[0]) * 256 + static_cast<uint8_t>(payload[1]), code) << target << fields;
    EXPECT_GT(payload.size(), 12u);
  }
  void expectOpen(const std::string& target, const std::string& fields = {}) {
    int opcode = 0;
    const auto socket = open(target, fields);
    socket->receiveFrame(&opcode);
    EXPECT_EQ(opcode, 1) << target << " " << fields;  // the manifest or the status
  }
  int get(const std::string& target, const std::string& fields = {}) {
    return statusOf(ask(port_, "GET " + target, fields));
  }

  const std::string folder_;
};

TEST_F(Access, TokensServeTheirRolesOnly) {
  demandTokens();
  pipeline_.has_picture = true;
  start();
  for (const char* token : {"", "?token=", "?token=wrong", "?token=viewer-token-1234", "?token=console-token-123"})
    open(std::string("/camera") + token, {}, 401);
  open("/camera?token=camera-token-1234");
  for (const char* token : {"", "?token=camera-token-1234", "?token=viewer-token-123", "?token=viewer-token-12345"})
    expectClosed(std::string("/live") + token, kCloseToken);
  expectOpen("/live?token=viewer-token-1234");
  expectOpen("/live?token=console-token-123");
  for (const char* token : {"", "?token=camera-token-1234", "?token=viewer-token-1234"}) {
    expectClosed(std::string("/console") + token, kCloseToken);
    for (const char* path : {"/status.json", "/cameras/left.jpg", "/cameras/left.json"})
      EXPECT_EQ(get(std::string(path) + token), 401) << path << token;
  }
  expectOpen("/console?token=console-token-123");
  for (const char* path : {"/status.json", "/cameras/left.jpg", "/cameras/left.json"})
    EXPECT_EQ(get(std::string(path) + "?token=console-token-123"), 200) << path;
  EXPECT_EQ(get("/status.json", "Authorization: Bearer console-token-123\r\n"), 200);
  LoggedClient refused(url("/camera"), "wrong");
  EXPECT_TRUE(eventually([&] { return refused.refused.load(); }));
}

TEST_F(Access, RefusedViewersGetNoFrames) {
  demandTokens();
  start();
  LoggedClient viewer(url("/live"));
  ASSERT_TRUE(viewer.closes.waitFor(1));
  frame("key", true);
  EXPECT_TRUE(viewer.messages.values().empty());
  EXPECT_EQ(service_->status().viewers.viewers, 0u);
  EXPECT_EQ(pipeline_.count("key"), 0u);
}

TEST_F(Access, PagesOfOtherSitesMayNotConnect) {
  options_.access.origins = {"https://stage.example"};
  start();
  for (const char* origin :
       {"http://localhost:3000", "http://127.0.0.1", "http://[::1]:8090", "https://stage.example"}) {
    const std::string field = "Origin: " + std::string(origin) + "\r\n";
    expectOpen("/live", field);
    expectOpen("/console", field);
    EXPECT_EQ(get("/status.json", field), 200) << origin;
    open("/camera", field);
  }
  for (const char* origin : {"http://evil.example", "https://stage.example.evil", "http://stage.example", "null",
                             "http://localhost.evil.example", "http://127.0.0.1.evil.example", "http://evil/localhost",
                             "localhost", "http://"}) {
    const std::string field = "Origin: " + std::string(origin) + "\r\n";
    expectClosed("/live", kCloseOrigin, field);
    expectClosed("/console", kCloseOrigin, field);
    for (const char* path : {"/status.json", "/cameras/left.json"}) EXPECT_EQ(get(path, field), 403) << origin;
    open("/camera", field, 403);
  }
}

TEST_F(Access, OnlyItsOwnNamesReachAServerOnLoopback) {
  options_.access.hosts = {"stage.local"};
  start();
  for (const char* host : {"localhost", "LOCALHOST:8090", "127.0.0.1:1", "[::1]:8090", "stage.local:8090"}) {
    expectOpen("/live", "Host: " + std::string(host) + "\r\n");
    EXPECT_EQ(get("/status.json", "Host: " + std::string(host) + "\r\n"), 200) << host;
  }
  for (const char* host : {"rebound.example", "rebound.example:8090", "127.0.0.1.example", "[::1", ""}) {
    const std::string field = "Host: " + std::string(host) + "\r\n";
    // The page's own origin has the wrong name.
    expectClosed("/live", kCloseOrigin, field + "Origin: http://" + host + "\r\n");
    EXPECT_EQ(get("/status.json", field), 403) << host;
    EXPECT_EQ(get("/", field), 403) << host;
    open("/camera", field, 403);
  }
}

TEST_F(Access, OriginIsTheServersOwnElsewhere) {
  AccessRules rules;
  rules.loopback = false;
  HttpRequest request;
  request.host = "stage.example:8090";
  const auto verdict = [&](const std::string& origin) {
    request.origin = origin;
    return judge(rules, request, Role::Viewer);
  };
  EXPECT_EQ(verdict(""), Verdict::Allowed);
  EXPECT_EQ(verdict("https://stage.example"), Verdict::Allowed);
  EXPECT_EQ(verdict("https://STAGE.example:8090"), Verdict::Allowed);
  EXPECT_EQ(verdict("http://localhost:8090"), Verdict::WrongOrigin);
  EXPECT_EQ(verdict("https://evil.example"), Verdict::WrongOrigin);
  EXPECT_EQ(judge(rules, request, Role::Anyone), Verdict::Allowed);
}

TEST_F(Access, ServersThatOthersReachNeedTlsAndTokens) {
  const auto refuses = [&] {
    const auto started = LiveService::start(rig_, options_, [](const std::string&) {});
    if (started.ok()) return false;
    EXPECT_EQ(started.error().id, ErrorId::InvalidArgument);
    return started.error().message.find("--tokens") != std::string::npos;
  };
  options_.server.address = "0.0.0.0";
  EXPECT_TRUE(refuses());
  demandTokens();
  EXPECT_TRUE(refuses());
  options_.access.tokens = {};
  options_.server.certificate_file = options_.server.key_file = "x.pem";
  EXPECT_TRUE(refuses());
  EXPECT_TRUE(isLoopback("127.0.0.1") && isLoopback("127.1.2.3") && isLoopback("::1") && isLoopback("LocalHost"));
  EXPECT_FALSE(isLoopback("0.0.0.0") || isLoopback("127.evil.example") || isLoopback("::") || isLoopback(""));
}

TEST_F(Access, TokenFilesAreMadeForTheirOwnerAndRead) {
  const std::string path = folder_ + "/tokens";
  const auto made = readOrMakeTokens(path);
  ASSERT_TRUE(made.ok());
  EXPECT_TRUE(made.value().made);
  struct stat about {};
  ASSERT_EQ(stat(path.c_str(), &about), 0);
  EXPECT_EQ(about.st_mode & 0777, 0600u);
  const auto read = readOrMakeTokens(path);
  ASSERT_TRUE(read.ok());
  EXPECT_FALSE(read.value().made);
  EXPECT_EQ(read.value().tokens.camera, made.value().tokens.camera);
  EXPECT_EQ(read.value().tokens.console, made.value().tokens.console);
  EXPECT_GE(made.value().tokens.viewer.size(), kMinTokenCharacters);
  EXPECT_NE(made.value().tokens.viewer, made.value().tokens.camera);
  EXPECT_EQ(readOrMakeTokens(folder_ + "/no/folder").error().id, ErrorId::WriteFailed);
  const std::string right = "camera 1234567890123456\n# note\n\nviewer 2234567890123456\n";
  EXPECT_TRUE(readOrMakeTokens(write("right", right + "console 3234567890123456\n")).ok());
  for (const std::string& wrong : {right, right + "console short\n", right + "viewer 3234567890123456\n",
                                   right + "other 3234567890123456\n", right + "console 3234567890123456 x\n"}) {
    const auto tokens = readOrMakeTokens(write("wrong", wrong));
    ASSERT_FALSE(tokens.ok()) << wrong;
    EXPECT_EQ(tokens.error().id, ErrorId::FileUnreadable);
  }
}

TEST_F(Access, ServesCamerasPictures) {
  start();
  EXPECT_EQ(get("/cameras/left.jpg"), 404);  // none yet
  pipeline_.has_picture = true;
  const std::string jpeg = ask(port_, "GET /cameras/left.jpg");
  EXPECT_NE(jpeg.find("Content-Type: image/jpeg"), std::string::npos);
  EXPECT_EQ(bodyOf(jpeg), "\xff\xd8\xff");
  EXPECT_EQ(bodyOf(ask(port_, "GET /cameras/right.json")),
            "{\"crop\":[1,2,3,4],\"number\":9,\"rings\":[[[1.0,2.0],[1.5,2.0],[1.5,3.0]]],\"size\":[640,480]}");
  EXPECT_EQ(get("/cameras/nobody.jpg"), 404);
  EXPECT_EQ(get("/cameras/left"), 404);
  EXPECT_NE(bodyOf(ask(port_, "GET /status.json")).find("\"frames\":42"), std::string::npos);
  EXPECT_EQ(get("/live"), 400);
  open("/elsewhere", {}, 404);
}

TEST_F(Access, ServesTheFilesOfAFolderAndNothingElse) {
  write("secret.txt", "secret");
  write("web/live/index.html", "the page");
  write("web/app.wasm", "code");
  write("web/a b.mjs", "module");
  write("web/.hidden/file.txt", "secret");
  std::filesystem::create_symlink(folder_ + "/secret.txt", folder_ + "/web/link.txt");
  std::filesystem::create_directory_symlink(folder_, folder_ + "/web/up");
  options_.web_folder = folder_ + "/web";
  start();
  const std::string root = ask(port_, "GET /");
  EXPECT_EQ(statusOf(root), 302);
  EXPECT_NE(root.find("Location: /live/\r\n"), std::string::npos);
  EXPECT_NE(ask(port_, "GET /live/").find("Content-Type: text/html"), std::string::npos);
  EXPECT_EQ(bodyOf(ask(port_, "GET /live/index.html")), "the page");
  EXPECT_NE(ask(port_, "GET /app.wasm").find("Content-Type: application/wasm"), std::string::npos);
  EXPECT_NE(ask(port_, "GET /a%20b.mjs").find("Content-Type: text/javascript"), std::string::npos);
  for (const char* path : {"/../secret.txt", "/live/../../secret.txt", "/%2e%2e/secret.txt", "/..%2fsecret.txt",
                           "/live/%2e%2e/%2e%2e/secret.txt", "/..%5csecret.txt", "//secret.txt", "/link.txt",
                           "/up/secret.txt", "/.hidden/file.txt", "/nothing", "/web", "/live/index.html/"}) {
    const std::string answer = ask(port_, std::string("GET ") + path);
    EXPECT_EQ(statusOf(answer), 404) << path;
    EXPECT_EQ(answer.find("secret\n"), std::string::npos) << path;
  }
  EXPECT_EQ(get("/etc/passwd"), 404);
  const std::string absolute = "/" + folder_ + "/secret.txt";
  EXPECT_EQ(get(absolute), 404);
  EXPECT_EQ(webFile("", "/live/").status, 404);
  EXPECT_EQ(webFile(folder_ + "/web", "/live").location, "/live/");
}

}  // namespace
}  // namespace fourdvt::live
