// The options of a run with a fleet control that speaks VDA 5050, for the programs that start one.
#pragma once

#include <string>
#include <vector>

#include "command_line/broker_options.h"
#include "world-service/observers/fleet/answer_round.h"

namespace CLI {
class App;
}

namespace troupe {

struct FleetOptions {
  BrokerOptions broker;  // without a URL: no gateway
  AnswerWait wait;
};

// --vda5050 with this help text, its relatives (command_line/broker_options.h), and --vda5050-wait. `options` must
// outlive the parsing.
void AddFleetFlags(CLI::App& app, FleetOptions& options, const std::string& url_help);

// The arguments that give another program the same options.
std::vector<std::string> FleetArguments(const FleetOptions& options);

}  // namespace troupe
