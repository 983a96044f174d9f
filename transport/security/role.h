// Role: the part that a participant has in the simulation domain. Its permissions follow from it.
#pragma once

#include <cstdint>
#include <string>

namespace troupe {

struct Role {
  enum class Kind : std::uint8_t { kService, kAgent, kOperator, kObserver };

  static Role Service() { return {Kind::kService, {}}; }
  // REQUIRES: IsAgentName(name)
  static Role Agent(std::string name) { return {Kind::kAgent, std::move(name)}; }
  static Role Operator() { return {Kind::kOperator, {}}; }  // reads all that a run publishes, and controls it
  static Role Observer() { return {Kind::kObserver, {}}; }  // reads only

  Kind kind = Kind::kObserver;
  std::string agent_name;  // of an agent: see AgentName; else empty
};

// Other names could match the names of other agents, because permissions are patterns: 1 to 64 of [0-9a-z].
bool IsAgentName(const std::string& name);

// "service", "operator", "observer", "agents/NAME": the folder of its keys in a folder of all keys.
std::string KeyFolder(const Role& role);

}  // namespace troupe
