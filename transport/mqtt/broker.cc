#include "transport/mqtt/broker.h"

#include <charconv>
#include <fstream>
#include <optional>
#include <string_view>

namespace troupe::mqtt {
namespace {

constexpr std::uint16_t kPlainPort = 1883;
constexpr std::uint16_t kTlsPort = 8883;

std::optional<std::uint16_t> ToPort(std::string_view text) {
  std::uint16_t port = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (problem != std::errc{} || end != text.data() + text.size() || port == 0) return std::nullopt;
  return port;
}

Error BadUrl(const std::string& url, const std::string& found) {
  return Error{{}, "the broker '" + url + "' has " + found + ", expected mqtt://HOST[:PORT] or mqtts://HOST[:PORT]"};
}

}  // namespace

std::string Broker::Url() const {
  const std::string name = host.find(':') == std::string::npos ? host : "[" + host + "]";
  return (tls ? "mqtts://" : "mqtt://") + name + ":" + std::to_string(port);
}

Result<Broker> ParseBrokerUrl(const std::string& url) {
  Broker broker;
  std::string_view rest = url;
  if (rest.starts_with("mqtts://")) {
    broker.tls = true;
    broker.port = kTlsPort;
    rest.remove_prefix(8);
  } else if (rest.starts_with("mqtt://")) {
    broker.port = kPlainPort;
    rest.remove_prefix(7);
  } else {
    return BadUrl(url, "no scheme mqtt:// or mqtts://");
  }
  if (rest.ends_with('/')) rest.remove_suffix(1);
  if (rest.find('/') != std::string_view::npos) return BadUrl(url, "a path");
  if (rest.find('@') != std::string_view::npos) return BadUrl(url, "a user (which belongs in a file)");
  std::string_view host = rest;
  std::optional<std::string_view> port;
  if (rest.starts_with('[')) {
    const std::size_t end = rest.find(']');
    if (end == std::string_view::npos) return BadUrl(url, "a bracket that is not closed");
    host = rest.substr(1, end - 1);
    rest.remove_prefix(end + 1);
    if (!rest.empty()) {
      if (rest.front() != ':') return BadUrl(url, "text behind the address");
      port = rest.substr(1);
    }
  } else if (const std::size_t colon = rest.find(':'); colon != std::string_view::npos) {
    host = rest.substr(0, colon);
    port = rest.substr(colon + 1);
  }
  if (host.empty()) return BadUrl(url, "no host");
  for (const char c : host) {
    if (static_cast<unsigned char>(c) <= ' ' || c == 0x7f) return BadUrl(url, "a blank or control character");
  }
  if (port) {
    const std::optional<std::uint16_t> number = ToPort(*port);
    if (!number) return BadUrl(url, "the port '" + std::string(*port) + "'");
    broker.port = *number;
  }
  broker.host = host;
  return broker;
}

Status ReadCredentials(const std::string& path, Broker& broker) {
  std::ifstream file(path);
  std::string line;
  if (!file || !std::getline(file, line)) return Error{{path}, "cannot be read, expected a line USER:PASSWORD"};
  if (!line.empty() && line.back() == '\r') line.pop_back();
  const std::size_t colon = line.find(':');
  if (colon == 0 || colon == std::string::npos) {
    return Error{{path, 1}, "found no user and password, expected a line USER:PASSWORD"};
  }
  broker.user = line.substr(0, colon);
  broker.password = line.substr(colon + 1);
  return {};
}

}  // namespace troupe::mqtt
