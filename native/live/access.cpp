// SPDX-License-Identifier: Apache-2.0
#include "live/access.h"

#include <fcntl.h>
#include <strings.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <random>
#include <sstream>

namespace fourdvt::live {
namespace {

std::string randomToken() {
  constexpr char kSymbols[] = "abcdefghijkmnpqrstuvwxyz23456789";  // 32 symbols: five bits each
  std::random_device random;
  std::string token;
  for (int i = 0; i < 32; ++i) token += kSymbols[random() % 32];
  return token;
}

Result<TokenFile> makeTokenFile(const std::string& path) {
  TokenFile out{{randomToken(), randomToken(), randomToken()}, true};
  const std::string text =
      "camera " + out.tokens.camera + "\nviewer " + out.tokens.viewer + "\nconsole " + out.tokens.console + "\n";
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  const bool is_written = file >= 0 && write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (file >= 0) close(file);
  if (is_written) return out;
  return Error{ErrorId::WriteFailed, path + ": cannot be written: " + std::strerror(errno)};
}

Error wrongTokens(const std::string& path, const std::string& problem) {
  return {ErrorId::FileUnreadable, path + ": " + problem +
                                       "; it needs the lines \"camera TOKEN\", \"viewer TOKEN\" and \"console TOKEN\", "
                                       "or remove it, and it is made"};
}

// Compares in constant time.
bool isSame(const std::string& given, const std::string& token) {
  volatile unsigned difference = given.size() == token.size() ? 0 : 1;
  for (size_t i = 0; i < token.size(); ++i)
    difference = difference | static_cast<unsigned>(token[i] ^ (given.empty() ? 0 : given[i % given.size()]));
  return difference == 0;
}

bool hasToken(const Tokens& tokens, const std::string& given, Role role) {
  if (!tokens.demanded() || role == Role::Anyone) return true;
  if (role == Role::Camera) return isSame(given, tokens.camera);
  const bool is_console = isSame(given, tokens.console), is_viewer = isSame(given, tokens.viewer);
  return is_console || (role == Role::Viewer && is_viewer);
}

bool isSameName(const std::string& a, const std::string& b) { return strcasecmp(a.c_str(), b.c_str()) == 0; }

// "host:8090" → "host", "[::1]:8090" → "::1".
std::string hostOf(const std::string& authority) {
  if (authority.empty() || authority[0] != '[') return authority.substr(0, authority.find(':'));
  const size_t end = authority.find(']');
  return end == std::string::npos ? "" : authority.substr(1, end - 1);
}

bool isOneOf(const std::string& name, const std::vector<std::string>& names) {
  return std::any_of(names.begin(), names.end(), [&](const std::string& n) { return isSameName(n, name); });
}

bool mayHaveOrigin(const AccessRules& rules, const HttpRequest& request) {
  if (request.origin.empty() || isOneOf(request.origin, rules.origins)) return true;
  const size_t scheme = request.origin.find("://");
  if (scheme == std::string::npos) return false;
  const std::string host = hostOf(request.origin.substr(scheme + 3));
  if (host.empty()) return false;
  return isSameName(host, hostOf(request.host)) || (rules.loopback && isLoopback(host));
}

}  // namespace

Result<TokenFile> readOrMakeTokens(const std::string& path) {
  if (access(path.c_str(), F_OK) != 0 && errno == ENOENT) return makeTokenFile(path);
  std::ifstream file(path);
  if (!file) return wrongTokens(path, "cannot be read");
  TokenFile out;
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string role, token, more;
    words >> role >> token >> more;
    if (role.empty() || role[0] == '#') continue;
    std::string* place = role == "camera"    ? &out.tokens.camera
                         : role == "viewer"  ? &out.tokens.viewer
                         : role == "console" ? &out.tokens.console
                                             : nullptr;
    if (!place || !more.empty() || !place->empty()) return wrongTokens(path, "has the line \"" + role + " …\"");
    if (token.size() < kMinTokenCharacters)
      return wrongTokens(path, "the token of " + role + " has fewer than 16 characters");
    *place = token;
  }
  if (out.tokens.camera.empty() || out.tokens.viewer.empty() || out.tokens.console.empty())
    return wrongTokens(path, "lacks a token");
  return out;
}

bool isLoopback(const std::string& host) {
  return isSameName(host, "localhost") || host == "::1" ||
         (host.compare(0, 4, "127.") == 0 && host.find_first_not_of("0123456789.") == std::string::npos);
}

Verdict judge(const AccessRules& rules, const HttpRequest& request, Role role) {
  const std::string host = hostOf(request.host);
  if (rules.loopback && !isLoopback(host) && !isOneOf(host, rules.hosts)) return Verdict::WrongHost;
  if (role != Role::Anyone && !mayHaveOrigin(rules, request)) return Verdict::WrongOrigin;
  return hasToken(rules.tokens, request.token, role) ? Verdict::Allowed : Verdict::WrongToken;
}

const char* verdictText(Verdict verdict) {
  switch (verdict) {
    case Verdict::WrongToken:
      return "no token, or not the one of this role; take it from the server's --tokens file";
    case Verdict::WrongOrigin:
      return "pages of this site may not connect; start the server with --allow-origin";
    case Verdict::WrongHost:
      return "the server does not go by this name; use localhost, or start it with --host";
    case Verdict::Allowed:
      break;
  }
  return "";
}

int verdictStatus(Verdict verdict) { return verdict == Verdict::WrongToken ? 401 : 403; }

}  // namespace fourdvt::live
