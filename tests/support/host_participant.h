// The participants of a host in ROS, as the program ros-participant has them, on a thread of the test.
// On a thread instead of a process: a test can end it and start it again at a known moment, and sanitizers see both
// sides.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/wake_event.h"
#include "ros/link/host_connection.h"
#include "ros/link/host_program.h"
#include "ros/link/link.h"
#include "ros/messages/ros_options.h"
#include "ros/participant/participant_server.h"
#include "tests/support/ros_domain.h"

namespace troupe::test {

class HostParticipant {
 public:
  explicit HostParticipant(ros::RosNetwork network = TestRosNetwork()) : network_(std::move(network)) { Start(); }
  ~HostParticipant() { End(); }
  HostParticipant(const HostParticipant&) = delete;
  HostParticipant& operator=(const HostParticipant&) = delete;

  const std::string& socket() const { return socket_; }
  // Connects a process with nodes.
  std::unique_ptr<ros::HostConnection> Connect(
      ros::HostConnection::Sending sending = ros::HostConnection::Sending::kByFlush) const {
    return std::make_unique<ros::HostConnection>(network_.distribution, socket_, network_.domain, sending);
  }

  void Start() {
    stop_.emplace();
    const Result<int> listening = ros::Bind(socket_);
    server_ =
        std::make_unique<ros::ParticipantServer>(network_, listening.value(), ros::ParticipantServer::Serving::kAlways,
                                                 *stop_, [this](const std::string& line) { reports_.push_back(line); });
    thread_ = std::thread([this] { server_->Run(); });
  }
  // All connections end, as when the program is killed.
  void End() {
    if (!server_) return;
    stop_->Signal();
    thread_.join();
    server_.reset();
  }
  // After End.
  const std::vector<std::string>& reports() const { return reports_; }

 private:
  const ros::RosNetwork network_;
  const std::string socket_ = ros::NewSocketName();
  std::optional<WakeEvent> stop_;
  std::vector<std::string> reports_;
  std::unique_ptr<ros::ParticipantServer> server_;
  std::thread thread_;
};

}  // namespace troupe::test
