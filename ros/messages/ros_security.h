// RosSecurity: the keys of participants in a ROS domain, in a keystore as ROS 2's own tools (sros2) make it.
#pragma once

#include <cstdint>
#include <string>

#include "troupe/result.h"

namespace troupe::ros {

enum class SecurityStrategy : std::uint8_t {
  kOff,
  kPermissive,  // a participant without keys has no security
  kEnforce,     // a participant without keys is an error
};

struct RosSecurity {
  SecurityStrategy strategy = SecurityStrategy::kOff;
  std::string keystore;  // a folder; empty: none
  std::string enclave;   // of all participants, "/swarm"; empty: each has its own
  std::string fault;     // of the environment, as an error message; empty: none
};

// ROS_SECURITY_ENABLE (true or false), ROS_SECURITY_STRATEGY (Enforce or Permissive, the default),
// ROS_SECURITY_KEYSTORE and ROS_SECURITY_ENCLAVE_OVERRIDE.
RosSecurity SecurityFromEnvironment();

// The keys of one participant.
struct Enclave {
  std::string name = "/";  // as the participant announces it
  std::string folder;      // of its keys; empty: without security
  std::string warning;     // its reason, if security was wanted; else empty
};

inline constexpr const char* kWorldEnclave = "/world";

// `own_name`: "/world", or "/<robot>" with the robot's name in ROS. Fails if files are missing and the strategy is
// kEnforce, and for a fault of the environment.
Result<Enclave> FindEnclave(const RosSecurity& security, const std::string& own_name);

const char* ToString(SecurityStrategy strategy);  // "off", "permissive", "enforce"

}  // namespace troupe::ros
