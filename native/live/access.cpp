// SPDX-License-Identifier: Apache-2.0
#include "live/access.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <sstream>

namespace fourdvt::live {
namespace {

constexpr size_t kFewestCharacters = 16, kMostCharacters = 256, kMadeCharacters = 32;

bool isToken(const std::string& text) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return text.size() >= kFewestCharacters && text.size() <= kMostCharacters &&
         std::all_of(text.begin(), text.end(), allowed);
}

// In a time that does not depend on how much of it is right.
bool isSame(const std::string& given, const std::string& token) {
  unsigned differs = given.size() != token.size();
  for (size_t i = 0; i < token.size(); ++i) differs |= unsigned(i < given.size() ? given[i] ^ token[i] : 1);
  return differs == 0;
}

std::string randomToken() {
  constexpr char kLetters[] = "abcdefghijklmnopqrstuvwxyz0123456789";
  std::random_device random;
  std::uniform_int_distribution<size_t> letter(0, sizeof kLetters - 2);
  std::string out;
  for (size_t i = 0; i < kMadeCharacters; ++i) out += kLetters[letter(random)];
  return out;
}

Result<Tokens> makeTokens(const std::string& path) {
  const Tokens made{randomToken(), randomToken(), randomToken()};
  const std::string text = "camera " + made.camera + "\nviewer " + made.viewer + "\nconsole " + made.console + "\n";
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  const bool written = file >= 0 && write(file, text.data(), text.size()) == ssize_t(text.size());
  if (file >= 0) close(file);
  if (!written) return Error{ErrorId::WriteFailed, path + ": tokens cannot be written; choose another place"};
  return made;
}

std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

// Without port and brackets.
std::string hostOf(const std::string& authority) {
  if (authority.starts_with("[")) return lowered(authority.substr(1, authority.find(']') - 1));
  return lowered(authority.substr(0, authority.find(':')));
}

bool contains(const std::vector<std::string>& list, const std::string& text) {
  return std::any_of(list.begin(), list.end(), [&](const std::string& entry) { return lowered(entry) == text; });
}

bool isOwnName(const AccessRules& rules, const std::string& host) {
  if (contains(rules.hosts, host)) return true;
  return rules.loopback ? isLoopback(host) : rules.hosts.empty();
}

bool mayConnect(const AccessRules& rules, const HttpRequest& request) {
  if (request.origin.empty()) return true;  // no page
  const std::string origin = lowered(request.origin);
  if (contains(rules.origins, origin)) return true;
  const size_t scheme = origin.find("://");
  if (scheme == std::string::npos) return false;
  const std::string authority = origin.substr(scheme + 3);
  return authority == lowered(request.host) || (rules.loopback && isLoopback(hostOf(authority)));
}

bool hasToken(const Tokens& tokens, const std::string& given, Role role) {
  const bool camera = isSame(given, tokens.camera), viewer = isSame(given, tokens.viewer),
             console = isSame(given, tokens.console);
  return role == Role::Camera ? camera : role == Role::Viewer ? viewer || console : console;
}

}  // namespace

bool isLoopback(const std::string& host) { return host == "localhost" || host == "::1" || host == "127.0.0.1"; }

Result<Tokens> readTokens(const std::string& path) {
  std::ifstream file(path);
  if (!file) return makeTokens(path);
  Tokens out;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string role, token;
    words >> role >> token;
    for (const auto& [name, at] :
         {std::pair{"camera", &out.camera}, {"viewer", &out.viewer}, {"console", &out.console}})
      if (role == name) *at = token;
  }
  if (isToken(out.camera) && isToken(out.viewer) && isToken(out.console)) return out;
  return Error{ErrorId::FileUnreadable, path +
                                            ": needs the lines \"camera TOKEN\", \"viewer TOKEN\" and "
                                            "\"console TOKEN\", each with 16 or more of "
                                            "A-Z a-z 0-9 _ -; correct it, or remove it to have one made"};
}

Refusal refusalOf(const AccessRules& rules, const HttpRequest& request, Role role) {
  if (!isOwnName(rules, hostOf(request.host))) return Refusal::Host;
  if (!mayConnect(rules, request)) return Refusal::Origin;
  if (rules.tokens.any() && !hasToken(rules.tokens, request.token, role)) return Refusal::Token;
  return Refusal::None;
}

std::string refusalText(Refusal refusal) {
  switch (refusal) {
    case Refusal::Token:
      return "the token is missing or wrong; the server's --tokens file has it";
    case Refusal::Origin:
      return "this page's address may not connect; start the server with "
             "--allow-origin";
    case Refusal::Host:
      return "the server has another name; use localhost, or start it with "
             "--host";
    case Refusal::None:
      break;
  }
  return "";
}

}  // namespace fourdvt::live
