#include "launcher/commands/listen_address.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>

#include "viewer/gateway/viewer_gateway.h"

namespace troupe {
namespace {

std::string CheckListen(const std::string& text) {
  return ParseListen(text)
             ? ""
             : "found '" + text + "', expected ADDRESS:PORT with an IPv4 address, for instance 127.0.0.1:8470";
}

}  // namespace

std::optional<ListenAddress> ParseListen(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) return std::nullopt;
  ListenAddress listen{text.substr(0, colon)};
  in_addr address{};
  const char* const end = text.data() + text.size();
  const auto port = std::from_chars(text.data() + colon + 1, end, listen.port);
  const bool good =
      inet_pton(AF_INET, listen.address.c_str(), &address) == 1 && port.ec == std::errc() && port.ptr == end;
  return good ? std::optional(listen) : std::nullopt;
}

void AddListenOption(CLI::App& command, std::string& listen) {
  command
      .add_option("--listen", listen,
                  fmt::format("Where the web server listens (default: 127.0.0.1:{}, or another port if that one is in "
                              "use)",
                              kViewerPort))
      ->check(CLI::Validator(CheckListen, ""))
      ->type_name("ADDRESS:PORT");
}

}  // namespace troupe
