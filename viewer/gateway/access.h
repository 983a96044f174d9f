// Access: the rules by which the gateway serves requests of browsers. A page of another site that the user has open can
// send requests to this machine, too; the headers tell them apart.
//
// Two attacks decide the rules. A foreign page opens a WebSocket to a loopback port: its Origin header names its own
// site. And a site points its own name at 127.0.0.1 (DNS rebinding): the Host header has that name. Where other
// machines can connect, neither helps, and a random token in the page's address is needed.
//
// Pure functions of the headers, without state; they are called on the web server's thread, once per request.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "troupe/enum_names.h"

namespace troupe {

// The first rule that is violated decides.
enum class Access : std::uint8_t { kGranted, kWrongHost, kWrongOrigin, kWrongToken };
// One line for the user.
constexpr auto NamesOf(Access) {
  return std::array{"granted", "the address of this page is not one of the viewer",
                    "the request comes from a page of another site", "the address lacks the token that troupe printed"};
}

struct AccessRules {
  // The gateway listens on a loopback address: requests must be addressed to one.
  bool loopback_only = true;
  // Beside addresses and "localhost", the names by which browsers may reach the gateway. Other names would let a site
  // point its own name at this machine (DNS rebinding).
  std::vector<std::string> names;
  std::string token;  // in each request; empty: none is needed

  // `host`: the Host header.
  Access ForPage(std::string_view host, std::string_view given_token) const;
  // `origin`: the Origin header; a browser sends it, and it must be the page that this host has served.
  Access ForSocket(std::string_view host, std::string_view origin, std::string_view given_token) const;
  // For a program that the page did not come from (Foxglove). In a browser it is of another site, which only a token
  // tells apart from any other.
  Access ForProgram(std::string_view host, std::string_view origin, std::string_view given_token) const;
  // For a file that is made on request. `bearer`: the token of the Authorization header, empty without one. No page of
  // another site can send that, so the host may then have any name: a scraper knows the gateway by its own.
  Access ForDownload(std::string_view host, std::string_view given_token, std::string_view bearer) const;
};

// 128 random bits, as 32 hexadecimal digits.
std::string MakeToken();

// True for an address of the loopback network 127.0.0.0/8.
bool IsLoopback(const std::string& address);

}  // namespace troupe
