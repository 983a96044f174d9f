#include "ros/messages/ros_options.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "common/base/paths.h"

namespace troupe::ros {
namespace {

constexpr std::uint32_t kMaxDomain = 230;

std::string_view Environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string_view() : std::string_view(value);
}

// "SYSTEM_DEFAULT" as "system-default".
std::string OptionWord(std::string_view text) {
  std::string word;
  for (const char c : text) word += c == '_' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return word;
}

std::vector<std::string> SplitAtSemicolons(std::string_view text) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(';'), text.size());
    if (end > 0) parts.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

std::string Found(const char* variable, std::string_view value, const char* expected) {
  return std::string(variable) + ": found '" + std::string(value) + "', expected " + expected;
}

// As ROS reads it: decimal, octal ("017") or hexadecimal ("0x11").
std::optional<std::uint32_t> ParseDomain(std::string_view text) {
  int base = 10;
  if (text.starts_with("0x") || text.starts_with("0X")) {
    base = 16;
    text.remove_prefix(2);
  } else if (text.size() > 1 && text.front() == '0') {
    base = 8;
  }
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  if (error != std::errc() || end != text.data() + text.size() || number > kMaxDomain) return std::nullopt;
  return number;
}

// The older variable prevails, as in ROS.
void SetDiscovery(RosNetwork& network, EnvironmentFaults& faults) {
  if (Environment("ROS_LOCALHOST_ONLY") == "1") {
    network.discovery = DiscoveryRange::kLocalhost;
    return;
  }
  const std::string_view range = Environment("ROS_AUTOMATIC_DISCOVERY_RANGE");
  if (!range.empty()) {
    const std::optional<DiscoveryRange> parsed = FindByName<DiscoveryRange>(OptionWord(range));
    network.discovery = parsed.value_or(DiscoveryRange::kLocalhost);
    if (!parsed) {
      faults.discovery =
          Found("ROS_AUTOMATIC_DISCOVERY_RANGE", range, "OFF, LOCALHOST, SUBNET or SYSTEM_DEFAULT; using LOCALHOST");
    }
  }
  network.static_peers = SplitAtSemicolons(Environment("ROS_STATIC_PEERS"));
}

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

// A faulty variable is kept as a fault and reported only by a run that uses ROS: others must not fail for it.
RosOptions OptionsFromEnvironment() {
  RosOptions options;
  RosNetwork& network = options.network;
  EnvironmentFaults& faults = options.faults;
  const std::string_view domain = Environment("ROS_DOMAIN_ID");
  if (const std::optional<std::uint32_t> number = ParseDomain(domain)) {
    network.domain = *number;
  } else if (!domain.empty()) {
    faults.domain = Found("ROS_DOMAIN_ID", domain, "a number from 0 to 230");
  }
  const std::string_view name = Environment("ROS_DISTRO");
  if (const auto distribution = FindByName<Distribution>(name)) {
    network.distribution = *distribution;
  } else if (!name.empty()) {
    faults.distribution =
        Found("ROS_DISTRO", name, "humble, iron, jazzy, kilted, lyrical or rolling (--ros-distro overrides it)");
  }
  SetDiscovery(network, faults);
  const std::string_view rmw = Environment("RMW_IMPLEMENTATION");
  if (rmw.find("zenoh") != std::string_view::npos) {
    faults.rmw = Found("RMW_IMPLEMENTATION", rmw,
                       "rmw_cyclonedds_cpp or rmw_fastrtps_cpp: programs on another one do not find this run");
  }
  network.security = SecurityFromEnvironment();
  return options;
}

// The inverse of the flags, for child processes: they must not read the environment of another host.
std::vector<std::string> NetworkArguments(const RosNetwork& network) {
  std::vector<std::string> arguments = {
      "--ros-domain=" + std::to_string(network.domain),
      "--ros-interface=" + network.network_interface,
      std::string("--ros-discovery=") + NameOf(network.discovery),
      std::string("--ros-distro=") + NameOf(network.distribution),
      std::string("--ros-security=") + NameOf(network.security.strategy),
  };
  if (!network.security.keystore.empty()) arguments.push_back("--ros-keystore=" + network.security.keystore);
  if (!network.security.enclave.empty()) arguments.push_back("--ros-enclave=" + network.security.enclave);
  for (const std::string& peer : network.static_peers) arguments.push_back("--ros-peers=" + peer);
  if (network.service_clients) {
    arguments.push_back(std::string("--ros-services=") + NameOf(*network.service_clients));
  }
  return arguments;
}

bool HasFastDds() {
  return TROUPE_HAS_FAST_DDS;
}

// Services for clients on Fast DDS need a participant of it. It has no keys, so that a secured run has none.
bool UsesFastDds(const RosNetwork& network) {
  return HasFastDds() && network.service_clients != ServiceClients::kCyclone &&
         network.security.strategy == SecurityStrategy::kOff && network.discovery != DiscoveryRange::kOff;
}

// The variables of SROS 2; security is on only if ROS_SECURITY_ENABLE is true.
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

// Missing keys are an error where security is enforced, and a warning where it is permissive.
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

}  // namespace troupe::ros
