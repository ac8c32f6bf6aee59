// SPDX-License-Identifier: Apache-2.0
// Access control of a live server: tokens by role, and checks of the headers Origin and Host, because a page of any
// site can open connections to its visitor's machine. Independent of sockets.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "live/net/websocket.h"

namespace fourdvt::live {

struct Tokens {
  std::string camera, viewer, console;  // empty: no token is required
  bool demanded() const { return !camera.empty(); }
};

constexpr size_t kMinTokenCharacters = 16;

struct TokenFile {
  Tokens tokens;
  bool made = false;  // true if the file did not exist and was written, readable by its owner only
};
// Parses lines "camera TOKEN", "viewer TOKEN", "console TOKEN", each once; empty lines and lines with # are skipped.
// Errors: FileUnreadable, WriteFailed.
Result<TokenFile> readOrMakeTokens(const std::string& path);

struct AccessRules {
  Tokens tokens;
  bool loopback = true;  // server listens on this machine only
  // Origins of pages that may connect besides the server's own, e.g. "https://example.org".
  std::vector<std::string> origins;
  std::vector<std::string> hosts;  // accepted host names of a server on loopback, besides those of loopback
};

enum class Role { Anyone, Camera, Viewer, Console };  // Console includes Viewer
enum class Verdict { Allowed, WrongToken, WrongOrigin, WrongHost };

Verdict judge(const AccessRules& rules, const HttpRequest& request, Role role);
const char* verdictText(Verdict verdict);  // message with the remedy
int verdictStatus(Verdict verdict);        // HTTP status
// True for 127.0.0.0/8, ::1 and localhost, without brackets and port.
bool isLoopback(const std::string& host);

}  // namespace fourdvt::live
