// The participant of a host in ROS, as the program ros-participant has it, on a thread of the test.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "common/base/random_id.h"
#include "common/base/wake_event.h"
#include "ros/link/host_connection.h"
#include "ros/link/socket_name.h"
#include "ros/messages/ros_options.h"
#include "ros/participant/participant_server.h"
#include "tests/support/ros_domain.h"

namespace troupe::test {

class HostParticipant {
 public:
  explicit HostParticipant(ros::RosOptions options) : options_(std::move(options)) {
    options_.participant_socket = "troupe-test/" + std::to_string(MakeRandomId());
    Start();
  }
  ~HostParticipant() { End(); }
  HostParticipant(const HostParticipant&) = delete;
  HostParticipant& operator=(const HostParticipant&) = delete;

  const std::string& socket() const { return options_.participant_socket; }

  void Start() {
    stop_.emplace();
    const Result<int> listening = ros::Listen(options_.participant_socket);
    server_ = std::make_unique<ros::ParticipantServer>(options_, listening.value(), *stop_,
                                                       [this](const std::string& line) { reports_.push_back(line); });
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
  ros::RosOptions options_;
  std::optional<WakeEvent> stop_;
  std::vector<std::string> reports_;
  std::unique_ptr<ros::ParticipantServer> server_;
  std::thread thread_;
};

// A connection of the scope, and for kHost the participant that it leads to.
class TestConnection {
 public:
  explicit TestConnection(ros::ParticipantScope scope, const ros::RosOptions& options = TestRosOptions()) {
    if (scope == ros::ParticipantScope::kProcess) {
      connection_ = std::make_unique<ros::RosParticipant>(options);
    } else {
      host_.emplace(options);
      connection_ = std::make_unique<ros::HostConnection>(options.distribution, host_->socket());
    }
  }
  ros::RosConnection& operator*() const { return *connection_; }
  ros::RosConnection* operator->() const { return connection_.get(); }

 private:
  std::optional<HostParticipant> host_;
  std::unique_ptr<ros::RosConnection> connection_;
};

inline std::string ScopeName(const testing::TestParamInfo<ros::ParticipantScope>& info) {
  return info.param == ros::ParticipantScope::kProcess ? "OwnParticipant" : "ParticipantOfTheHost";
}

// Of all tests that are the same for both.
inline auto AllScopes() {
  return testing::Values(ros::ParticipantScope::kProcess, ros::ParticipantScope::kHost);
}

}  // namespace troupe::test
