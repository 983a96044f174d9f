// Where a web server listens, as an option of a command.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace troupe {

struct ListenAddress {
  std::string address;
  std::uint16_t port = 0;
};

// "ADDRESS:PORT", with an IPv4 address.
std::optional<ListenAddress> ParseListen(const std::string& text);

// Adds --listen, which sets `listen` to a text that ParseListen reads.
void AddListenOption(CLI::App& command, std::string& listen);

}  // namespace troupe
