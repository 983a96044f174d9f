#include "ros/messages/ros_security.h"

#include <cstdlib>
#include <filesystem>

#include "common/base/enclave.h"

namespace troupe::ros {
namespace {

std::string Variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? std::string() : std::string(value);
}

// Why the enclave has no keys; success if it has.
Status CheckKeys(const RosSecurity& security, const std::string& folder) {
  if (security.keystore.empty()) return Error{{}, "ROS_SECURITY_KEYSTORE: found no value, expected a folder of keys"};
  return CheckEnclave(folder);
}

}  // namespace

RosSecurity SecurityFromEnvironment() {
  RosSecurity security;
  security.keystore = Variable("ROS_SECURITY_KEYSTORE");
  security.enclave = Variable("ROS_SECURITY_ENCLAVE_OVERRIDE");
  const std::string enable = Variable("ROS_SECURITY_ENABLE");
  const std::string strategy = Variable("ROS_SECURITY_STRATEGY");
  if (enable != "true") {
    if (!enable.empty() && enable != "false") {
      security.fault = "ROS_SECURITY_ENABLE: found '" + enable + "', expected true or false";
    }
    return security;
  }
  if (!strategy.empty() && strategy != "Enforce" && strategy != "Permissive") {
    security.fault = "ROS_SECURITY_STRATEGY: found '" + strategy + "', expected Enforce or Permissive";
  }
  security.strategy = strategy == "Enforce" ? SecurityStrategy::kEnforce : SecurityStrategy::kPermissive;
  return security;
}

Result<Enclave> FindEnclave(const RosSecurity& security, const std::string& own_name) {
  if (!security.fault.empty()) return Error{{}, security.fault};
  if (security.strategy == SecurityStrategy::kOff) return Enclave{};
  const std::string& name = security.enclave.empty() ? own_name : security.enclave;
  if (!name.starts_with("/")) return Error{{}, "enclave of ROS: found '" + name + "', expected a name such as /world"};
  const std::string folder = (std::filesystem::path(security.keystore) / "enclaves" / name.substr(1)).string();
  const Status keys = CheckKeys(security, folder);
  if (keys.ok()) return Enclave{name, folder, {}};
  const Error error{keys.error().where, keys.error().message + " (enclave " + name + " of ROS 2)"};
  if (security.strategy == SecurityStrategy::kEnforce) return error;
  return Enclave{name, {}, Warning{error.where, error.message + "; continuing without security"}.ToString()};
}

const char* ToString(SecurityStrategy strategy) {
  switch (strategy) {
    case SecurityStrategy::kOff:
      return "off";
    case SecurityStrategy::kPermissive:
      return "permissive";
    case SecurityStrategy::kEnforce:
      return "enforce";
  }
  return "";
}

}  // namespace troupe::ros
