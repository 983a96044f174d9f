// RosEditRun: a run with --ros, a tool that edits its world, and a tool of ROS that lists its nodes.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/ros_graph.h"
#include "transport/dds/tools/control_client.h"

namespace troupe::test {

class RosEditRun {
 public:
  RosEditRun(const std::string& file, std::vector<std::string> more)
      : session_(TestSession("ros-edit")), run_(Troupe(Arguments(file, std::move(more)))) {
    run_.WaitForLine(", ready");
  }

  Program& program() { return run_; }

  ControlReply Ask(const control::Request& request) {
    EXPECT_TRUE(client_.WaitForService(kSeconds).ok()) << run_.output();
    const Result<ControlReply> reply = client_.Call(request, kSeconds);
    if (reply.ok()) {
      EXPECT_TRUE(reply.value().done) << reply.value().problem;
      return reply.value();
    }
    ADD_FAILURE() << reply.error().message << "\n" << run_.output();
    return {};
  }
  ControlReply Step(std::uint64_t ticks) {
    control::Step request{.ticks = ticks};
    const ControlReply reply = Ask(request);
    const ControlReply before = std::exchange(newest_, reply);
    if (reply.edition == before.edition) {
      EXPECT_EQ(reply.tick, before.tick + ticks);
    }
    return reply;
  }
  ControlReply Reset() { return Edit(control::Reset()); }
  ControlReply Delete(const std::string& name) { return Edit(control::Delete{name}); }
  ControlReply Load(const std::string& file) { return Edit(control::LoadWorld{file}); }
  ControlReply Spawn(const std::string& name, const Pose& pose) {
    return Edit(control::Spawn{.source = "rover", .name = name, .pose = pose});
  }

  // Awaits a graph with these robots, each with one node and topics, and the node of the world.
  void ExpectRobots(const std::vector<std::string>& robots) {
    std::vector<std::string> expected = {"/world"};
    for (const std::string& robot : robots) expected.push_back("/" + robot + "/robot");
    std::sort(expected.begin(), expected.end());
    std::vector<std::string> nodes;
    EXPECT_TRUE(Eventually([&] { return (nodes = graph_.Nodes()) == expected; }, kSeconds))
        << testing::PrintToString(nodes) << "\n"
        << run_.output();
    for (const std::string& robot : robots) {
      EXPECT_TRUE(Eventually([&] { return graph_.Topics("/" + robot + "/").contains("/" + robot + "/odom"); }));
    }
  }
  // The participants of other programs in the ROS domain.
  std::size_t participants() { return graph_.Participants(); }
  void ExpectNoTopicsOf(const std::string& robot) {
    EXPECT_TRUE(Eventually([&] { return graph_.Topics("/" + robot + "/").empty(); }))
        << testing::PrintToString(graph_.Topics("/" + robot + "/"));
  }

  // The processes of agents that simulate a robot.
  std::vector<pid_t> AgentsOf(const std::string& robot) const { return Children("--robot=" + robot + " "); }
  pid_t Service() const { return Only("/world-service "); }
  // That of this host, which its robots share.
  pid_t Participant() const { return Only("/ros-participant "); }

  void End() {
    run_.Interrupt();
    EXPECT_THAT(run_.output(), testing::Not(testing::HasSubstr("the agent (process"))) << "an agent failed";
  }

 private:
  std::vector<std::string> Arguments(const std::string& file, std::vector<std::string> more) const {
    return Words("run % --headless --domain % --session % --ros --ros-interface lo --ros-domain %",
                 {file, std::to_string(TestDomain()), session_, std::to_string(TestRosNetwork().domain)}) +
           more;
  }
  // The child processes whose command lines contain `part`.
  std::vector<pid_t> Children(const std::string& part) const {
    std::vector<pid_t> children;
    for (const pid_t child : ChildrenOf(run_.pid())) {
      if ((CommandLineOf(child) + " ").find(part) != std::string::npos) children.push_back(child);
    }
    return children;
  }
  pid_t Only(const std::string& part) const {
    const std::vector<pid_t> children = Children(part);
    EXPECT_EQ(children.size(), 1u);
    return children.empty() ? 0 : children.front();
  }
  ControlReply Edit(const control::Request& request) { return newest_ = Ask(request); }

  const std::string session_;
  RosGraph graph_;
  Program run_;
  ControlClient client_{NetworkOf(session_)};
  ControlReply newest_;
};

}  // namespace troupe::test
