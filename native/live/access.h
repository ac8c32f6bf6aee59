// SPDX-License-Identifier: Apache-2.0
// Who may use a live server: tokens by role, and checks of the headers Origin and Host, because a page of any site can
// open connections to the machine that it is read on. Does NOT know sockets.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "live/net/websocket.h"

namespace fourdvt::live {

struct Tokens {
  std::string camera, viewer, console;  // empty: none is demanded
  bool demanded() const { return !camera.empty(); }
};

constexpr size_t kFewestTokenCharacters = 16;

struct TokenFile {
  Tokens tokens;
  bool made = false;  // there was no file: it has been written, for its owner to read only
};
// Lines "camera TOKEN", "viewer TOKEN", "console TOKEN", each once; empty lines and those with # are skipped. Errors:
// FileUnreadable, WriteFailed.
Result<TokenFile> readOrMakeTokens(const std::string& path);

struct AccessRules {
  Tokens tokens;
  bool loopback = true;              // the server listens on this machine only
  std::vector<std::string> origins;  // of pages that may connect besides the server's own, e.g. "https://example.org"
  std::vector<std::string> hosts;    // names of a server on loopback besides those of loopback
};

enum class Role { Anyone, Camera, Viewer, Console };  // Console may do what Viewer may
enum class Verdict { Allowed, WrongToken, WrongOrigin, WrongHost };

Verdict judge(const AccessRules& rules, const HttpRequest& request, Role role);
const char* verdictText(Verdict verdict);  // with the remedy
int verdictStatus(Verdict verdict);        // of HTTP
// 127.0.0.0/8, ::1 or localhost, without brackets and port.
bool isLoopback(const std::string& host);

}  // namespace fourdvt::live
