// The options of a run with a fleet control that speaks VDA 5050, for the programs that start one.
#pragma once

#include <string>
#include <vector>

#include "world-service/observers/fleet/fleet_gateway.h"

namespace CLI {
class App;
}

namespace troupe {

// --vda5050, --vda-wait and those of the broker (command_line/broker_flags.h). `url_help`: of --vda5050. `options` must
// outlive the parsing.
void AddFleetFlags(CLI::App& app, FleetOptions& options, const std::string& url_help, const std::string& group);

// The arguments that give another program the same options.
std::vector<std::string> FleetArguments(const FleetOptions& options);

}  // namespace troupe
