// The options by which a program reaches a broker of MQTT: --vda5050 and its relatives.
#pragma once

#include <string>

#include "transport/mqtt/broker.h"
#include "troupe/result.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace troupe {

struct BrokerOptions {
  std::string url;          // empty: not given
  std::string credentials;  // names of files, as of mqtt::Broker; empty: none
  std::string authorities;
  std::string certificate;
  std::string key;
};

// Adds --vda5050 with this help text, and its relatives. The option of the URL is returned.
CLI::Option* AddBrokerOptions(CLI::App& command, BrokerOptions& options, const std::string& help);

// REQUIRES: a URL. The error names the option or the file.
Result<mqtt::Broker> BrokerOf(const BrokerOptions& options);

}  // namespace troupe
