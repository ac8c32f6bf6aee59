// SPDX-License-Identifier: Apache-2.0
// Who may do what at a live server: tokens, and which pages may connect. A page
// of any origin can open a connection to this machine, and names of any server
// can be made to lead here, so that origin and host are checked on loopback,
// too. Does NOT touch sockets.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "live/net/websocket.h"

namespace fourdvt::live {

enum class Role { Camera, Viewer, Console };  // the console's token serves viewers, too

struct Tokens {
  std::string camera, viewer, console;
  bool any() const { return !camera.empty(); }
};

// Lines "camera TOKEN", "viewer TOKEN", "console TOKEN", 16 or more of A–Z a–z
// 0–9 _ - each. A file that is missing is made with random ones, for its
// owner's eyes only. Errors: FileUnreadable, WriteFailed.
Result<Tokens> readTokens(const std::string& path);

struct AccessRules {
  Tokens tokens;                     // none: nobody is asked for one
  bool loopback = true;              // the server listens on this machine alone
  std::vector<std::string> origins;  // of further pages that may connect, "https://example.org"
  std::vector<std::string> hosts;    // further names of this server; not on
                                     // loopback: its only names, if there are any
};

enum class Refusal { None, Token, Origin, Host };
Refusal refusalOf(const AccessRules& rules, const HttpRequest& request, Role role);
std::string refusalText(Refusal refusal);  // with the remedy

// "127.0.0.1", "::1", "localhost".
bool isLoopback(const std::string& host);

}  // namespace fourdvt::live
