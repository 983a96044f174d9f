#include "tests/contract/transport_case.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <stop_token>

#include "robot-agent/agent/agent_host.h"
#include "tests/support/files.h"
#include "tests/support/small_world.h"
#include "tests/support/test_world.h"
#include "world-service/observers/recorder/recorder.h"

namespace troupe::test {
namespace {

Result<RunSummary> Serve(TransportRig& rig, const std::shared_ptr<const Scene>& scene, std::uint64_t ticks,
                         const std::string& hash_log) {
  ServiceOptions options;
  options.settings.ticks = ticks;
  const Result<std::unique_ptr<Recorder>> recorder =
      Recorder::Create(scene->world(), {.hash_log = hash_log, .poses = "", .record = ""});
  if (!recorder.ok()) return recorder.error();
  const std::atomic<bool> stop = false;
  return RunService(scene, options, rig.ForService().MakeServiceEndpoint(), {recorder.value().get()}, stop);
}

}  // namespace

WorldDescription BusyWorld() {
  TestWorld test;
  test.AddModel(Box(-3.0, -3.2, 3.0, -3.0));
  test.AddModel(Box(-3.0, 3.0, 3.0, 3.2));
  test.AddModel(Box(-3.2, -3.0, -3.0, 3.0));
  test.AddModel(Box(3.0, -3.0, 3.2, 3.0));
  for (int i = 0; i < 4; ++i) {
    const RobotId robot = test.AddRobot(Square(0.4), {0.0, 0.5}, {-1.5 + i, 0.3 * i, 0.0, 1.3 * i});
    RobotDescription& description = test.world.robots[robot.index()];
    description.name = "r" + std::to_string(i);
    test.model(description.root).name = description.name;

    ModelDescription eye{.name = description.name + ".ranger:0",
                         .type = "ranger",
                         .parent = description.root,
                         .shape = ShapeId(test.world.shapes.size())};
    test.world.shapes.emplace_back();
    test.world.models.push_back(eye);
    SensorDescription ranger{.name = "ranger:0", .model = ModelId(test.world.models.size() - 1)};
    RaySensors(ranger).push_back({.X_MS = {0.0, 0.0, 0.25, 0.0}, .range = {0.0, 4.0}, .fov = 3.0, .samples = 30});
    description.sensors.push_back(ranger);
    description.controller = {"wander", R"({"speed": 1.5})"};
  }
  test.world.name = "busy";
  return test.world;
}

WholeRunResult RunBusyWorld(TransportRig& rig, const WholeRun& run) {
  const auto scene = std::make_shared<const Scene>(BusyWorld());
  const TemporaryFolder folder;
  const auto serve = [&] { return Serve(rig, scene, run.ticks, folder.Path("hashes")); };

  std::stop_source stop;
  std::vector<std::future<Result<AgentEnd>>> agents;
  std::future<Result<RunSummary>> service;
  if (run.service_first) service = std::async(std::launch::async, serve);
  if (run.service_first && run.before_agents) run.before_agents();
  AgentId next_agent = 100;
  for (const std::vector<std::string>& robots : run.agents) {
    AgentOptions options{.agent = ++next_agent, .robots = robots, .session_timeout_seconds = 30.0};
    Transport& transport = rig.ForAgent();
    agents.push_back(std::async(std::launch::async, [&stop, &transport, options] {
      return RunAgent(transport.MakeAgentEndpoint(options.agent), options, stop.get_token());
    }));
  }
  if (!run.service_first) service = std::async(std::launch::async, serve);

  const Result<RunSummary> summary = service.get();
  // All agents end by the last frame, or because the service has ended. Neither depends on the flag.
  for (std::future<Result<AgentEnd>>& agent : agents) {
    if (agent.wait_for(std::chrono::seconds(30)) == std::future_status::ready) continue;
    ADD_FAILURE() << "an agent did not notice that the run is over";
    stop.request_stop();
  }
  for (std::future<Result<AgentEnd>>& agent : agents) {
    const Result<AgentEnd> ended = agent.get();
    EXPECT_TRUE(ended.ok()) << ended.error().ToString();
  }
  EXPECT_TRUE(summary.ok()) << summary.error().ToString();
  if (!summary.ok()) return {};
  return {summary.value(), folder.Read("hashes")};
}

}  // namespace troupe::test
