// The program ros-service-bridge: ROS clients on rmw_fastrtps call the services of a run through it. Such a client
// sends the number of a call beside the message, where Cyclone DDS gives no access; so the bridge is on Fast DDS.
#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <fastdds/dds/log/Log.hpp>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "common/base/flood_limiter.h"
#include "common/base/random_id.h"
#include "common/base/stop_signals.h"
#include "common/command_line/exit_status.h"
#include "common/ros/bridge_call.h"
#include "ros-service-bridge/command_line.h"
#include "ros-service-bridge/domain_bridge.h"

namespace troupe {
namespace {

using eprosima::fastdds::dds::Log;
using eprosima::fastdds::dds::LogConsumer;

// The errors of Fast DDS, as about messages of strangers.
class LimitedLog final : public LogConsumer {
 public:
  explicit LimitedLog(FloodLimiter& lines) : lines_(lines) {}
  void Consume(const Log::Entry& entry) override { lines_.Add(entry.message); }

 private:
  FloodLimiter& lines_;
};

std::vector<std::uint32_t> DomainsOf(const BridgeCommandLine& line) {
  std::vector<std::uint32_t> domains = {line.ros.domain};
  for (const std::uint32_t domain : line.robot_domains) {
    if (std::find(domains.begin(), domains.end(), domain) == domains.end()) domains.push_back(domain);
  }
  return domains;
}

void Serve(const BridgeCommandLine& line, ros::Inbox& inbox, FloodLimiter& reports) {
  const std::uint64_t client_guid = ros::kBridgeMark | (MakeRandomId() & 0xffffffffU);
  std::int64_t last_call = 0;
  std::vector<std::unique_ptr<ros::DomainBridge>> bridges;
  for (const std::uint32_t domain : DomainsOf(line)) {
    ros::RosOptions options = line.ros;
    options.domain = domain;
    bridges.push_back(std::make_unique<ros::DomainBridge>(options, inbox, client_guid, last_call,
                                                          [&reports](const std::string& text) { reports.Add(text); }));
  }
  std::optional<ros::Inbox::Time> next;
  while (!inbox.stopped()) {
    const std::set<ros::Inbox::PartId> parts = inbox.Wait(next);
    next.reset();
    for (const auto& bridge : bridges) {
      bridge->Process(parts, ros::PendingCalls::Clock::now());
      if (const auto due = bridge->NextDue()) next = std::min(next.value_or(*due), *due);
    }
  }
}

int Main(int argc, const char* const* argv) {
  const std::variant<BridgeCommandLine, int> parsed = ParseBridgeCommandLine(argc, argv);
  if (const int* exit_status = std::get_if<int>(&parsed)) return *exit_status;
  std::signal(SIGPIPE, SIG_IGN);
  ros::Inbox inbox;
  const StopSignals signals([&inbox] { inbox.Stop(); });
  FloodLimiter reports([](const std::string& text) { fmt::print(stderr, "ros-service-bridge: warning: {}\n", text); });
  Log::ClearConsumers();
  Log::SetVerbosity(Log::Error);
  Log::RegisterConsumer(std::make_unique<LimitedLog>(reports));
  int exit_status = kExitDone;
  try {
    Serve(std::get<BridgeCommandLine>(parsed), inbox, reports);
  } catch (const std::exception& exception) {
    fmt::print(stderr, "ros-service-bridge: error: {}\n", exception.what());
    exit_status = ExitStatusOf(FailureOf(exception));
  }
  Log::ClearConsumers();  // they write to `reports`
  return exit_status;
}

}  // namespace
}  // namespace troupe

// An exception while another is reported ends the program.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
  return troupe::Main(argc, argv);
}
