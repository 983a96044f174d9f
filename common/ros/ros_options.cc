#include "common/ros/ros_options.h"

#include <charconv>
#include <cstdlib>
#include <string_view>

namespace troupe::ros {
namespace {

constexpr Distribution kDistributions[] = {Distribution::kHumble, Distribution::kIron, Distribution::kJazzy,
                                           Distribution::kKilted, Distribution::kRolling};
constexpr std::uint32_t kMaxDomain = 230;

std::string_view Environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string_view() : std::string_view(value);
}

}  // namespace

RosOptions OptionsFromEnvironment() {
  RosOptions options;
  const std::string_view domain = Environment("ROS_DOMAIN_ID");
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(domain.data(), domain.data() + domain.size(), number);
  if (!domain.empty() && error == std::errc() && end == domain.data() + domain.size() && number <= kMaxDomain) {
    options.domain = number;
  }
  if (const auto distribution = ParseDistribution(std::string(Environment("ROS_DISTRO")))) {
    options.distribution = *distribution;
  }
  if (Environment("ROS_LOCALHOST_ONLY") == "1" || Environment("ROS_AUTOMATIC_DISCOVERY_RANGE") == "LOCALHOST") {
    options.network_interface = "lo";
  }
  options.security = SecurityFromEnvironment();
  return options;
}

std::optional<Distribution> ParseDistribution(const std::string& name) {
  for (const Distribution distribution : kDistributions) {
    if (name == ToString(distribution)) return distribution;
  }
  return std::nullopt;
}

const char* ToString(Distribution distribution) {
  switch (distribution) {
    case Distribution::kHumble:
      return "humble";
    case Distribution::kIron:
      return "iron";
    case Distribution::kJazzy:
      return "jazzy";
    case Distribution::kKilted:
      return "kilted";
    case Distribution::kRolling:
      return "rolling";
  }
  return "";
}

const char* ToString(CommandType type) {
  switch (type) {
    case CommandType::kTwist:
      return "twist";
    case CommandType::kTwistStamped:
      return "stamped";
    case CommandType::kBoth:
      return "both";
  }
  return "";
}

}  // namespace troupe::ros
