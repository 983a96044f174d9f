// The program ros-service-bridge: ROS clients on rmw_fastrtps call the services of a run through it. Such a client
// sends the number of a call beside the message, where Cyclone DDS gives no access; so the bridge is on Fast DDS.
#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <fastdds/dds/log/Log.hpp>
#include <memory>
#include <set>

#include "command_line/exit_status.h"
#include "common/base/flood_limiter.h"
#include "common/base/stop_signals.h"
#include "ros/service_bridge/command_line.h"
#include "ros/service_bridge/run_bridge.h"

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

void Serve(const BridgeCommandLine& line, ros::Inbox& inbox, FloodLimiter& reports) {
  ros::RunBridge bridge(line.ros, inbox, [&reports](const std::string& text) { reports.Add(text); });
  while (!inbox.stopped()) {
    const std::set<ros::Inbox::PartId> parts = inbox.Wait(bridge.NextDue());
    bridge.Process(parts, ros::PendingCalls::Clock::now());
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
