// The address of an MQTT broker, and what a client needs to be let in.
#pragma once

#include <cstdint>
#include <string>

#include "troupe/result.h"

namespace troupe::mqtt {

struct Broker {
  std::string host;
  std::uint16_t port = 1883;
  bool tls = false;
  std::string ca_file;  // of the authorities that may have signed the broker's certificate; empty: the system's
  std::string certificate_file;  // of the client, with key_file; empty: none
  std::string key_file;
  std::string user;  // empty: none
  std::string password;

  // "mqtt://HOST:PORT" or "mqtts://HOST:PORT"
  std::string Url() const;
};

// Reads "mqtt://HOST[:PORT]" (port 1883) or "mqtts://HOST[:PORT]" (8883). HOST may be an IPv6 address in brackets.
Result<Broker> ParseBrokerUrl(const std::string& url);

// Reads user and password from the first line of a file, "USER:PASSWORD": on a command line other users would see them.
Status ReadCredentials(const std::string& path, Broker& broker);

}  // namespace troupe::mqtt
