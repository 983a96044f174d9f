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

// Files for a connection; empty: none.
struct BrokerFiles {
  std::string ca = {};  // as in Broker, like the next two
  std::string certificate = {};
  std::string key = {};
  std::string credentials = {};  // its first line is "USER:PASSWORD": on a command line other users would see them
};

// Reads the address and the file of credentials. The error is also a certificate without TLS or without its key.
Result<Broker> ReadBroker(const std::string& url, const BrokerFiles& files);

}  // namespace troupe::mqtt
