#include "launcher/supervise/host_participants.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "command_line/ros_flags.h"
#include "common/base/random_id.h"

namespace troupe {

Status HostParticipants::Start(std::vector<AgentSite>& sites, const RunOptions& options) {
  const std::string name = fmt::format("troupe-ros-participant/{:016x}", MakeRandomId());
  Status first;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const std::string socket = fmt::format("{}/{}", name, i);
    std::vector<std::string> arguments = {"--session=" + options.network.session, "--socket=" + socket};
    for (std::string& argument : RosArguments(options.ros)) arguments.push_back(std::move(argument));
    SupervisedProcess& process = processes_.emplace_back(SupervisedProcess::Settings{
        "ros-participant", "the ROS participant of the robots", "the robots are not in ROS"});
    const Status started = process.Start(*sites[i].host, std::move(arguments));
    if (started.ok()) {
      sites[i].ros_participant = socket;
    } else if (first.ok()) {
      first = started;
    }
  }
  return first;
}

std::vector<std::string> HostParticipants::Poll(double now) {
  std::vector<std::string> lines;
  for (SupervisedProcess& process : processes_) {
    if (std::optional<std::string> line = process.Poll(now)) lines.push_back(*std::move(line));
  }
  return lines;
}

std::optional<double> HostParticipants::NextDue() const {
  std::optional<double> next;
  for (const SupervisedProcess& process : processes_) {
    if (process.NextDue()) next = std::min(next.value_or(*process.NextDue()), *process.NextDue());
  }
  return next;
}

bool HostParticipants::running() const {
  return std::any_of(processes_.begin(), processes_.end(),
                     [](const SupervisedProcess& process) { return process.running(); });
}

void HostParticipants::Stop() {
  for (SupervisedProcess& process : processes_) process.Stop();
}

void HostParticipants::Kill() {
  for (SupervisedProcess& process : processes_) process.Kill();
}

}  // namespace troupe
