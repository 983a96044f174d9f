// The options of a connection to an MQTT broker.
#pragma once

#include <string>
#include <vector>

#include "transport/mqtt/broker.h"

namespace CLI {
class App;
}

namespace troupe {

// --mqtt-ca, --mqtt-cert, --mqtt-key and --mqtt-user. `files` must outlive the parsing.
void AddBrokerFlags(CLI::App& app, mqtt::BrokerFiles& files, const std::string& group = "Options");

// The arguments that give another program the same options.
std::vector<std::string> BrokerArguments(const mqtt::BrokerFiles& files);

}  // namespace troupe
