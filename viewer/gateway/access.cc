#include "viewer/gateway/access.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "common/base/identity.h"

namespace troupe {
namespace {

// The host without its port, in lower case.
std::string NameIn(std::string_view host) {
  const std::size_t colon = host.rfind(':');
  std::string name(colon == std::string_view::npos ? host : host.substr(0, colon));
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name;
}

bool IsAddress(const std::string& name) {
  in_addr address{};
  return inet_pton(AF_INET, name.c_str(), &address) == 1;
}

// Takes the same time wherever the texts differ, so that a token cannot be guessed byte by byte.
bool AreEqual(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

}  // namespace

// The order matters for the message: a wrong host is told before a wrong token.
Access AccessRules::ForPage(std::string_view host, std::string_view given_token) const {
  const std::string name = NameIn(host);
  const bool known = name == "localhost" || (loopback_only ? IsLoopback(name) : IsAddress(name)) ||
                     std::find(names.begin(), names.end(), name) != names.end();
  if (!known) return Access::kWrongHost;
  if (!AreEqual(token, given_token) && !token.empty()) return Access::kWrongToken;
  return Access::kGranted;
}

// Browsers do not apply the same-origin policy to WebSockets, so that the server compares the origin.
Access AccessRules::ForSocket(std::string_view host, std::string_view origin, std::string_view given_token) const {
  const Access page = ForPage(host, given_token);
  if (page == Access::kWrongHost) return page;
  if (origin != fmt::format("http://{}", host) && origin != fmt::format("https://{}", host))
    return Access::kWrongOrigin;
  return page;
}

Access AccessRules::ForProgram(std::string_view host, std::string_view origin, std::string_view given_token) const {
  const Access page = ForPage(host, given_token);
  if (page == Access::kGranted && token.empty() && !origin.empty()) return Access::kWrongOrigin;
  return page;
}

// The header replaces the rule of hosts, not that of the token.
Access AccessRules::ForDownload(std::string_view host, std::string_view given_token, std::string_view bearer) const {
  if (bearer.empty() || token.empty()) return ForPage(host, given_token);
  return AreEqual(token, bearer) ? Access::kGranted : Access::kWrongToken;
}

std::string MakeToken() {
  return fmt::format("{:016x}{:016x}", MakeRandomId(), MakeRandomId());
}

// Names are none: "localhost" is compared as a word.
bool IsLoopback(const std::string& address) {
  in_addr parsed{};
  return inet_pton(AF_INET, address.c_str(), &parsed) == 1 && (ntohl(parsed.s_addr) >> 24) == 127;
}

}  // namespace troupe
