#include "tests/unit/world-service/service/coordinator_fixture.h"

#include "common/base/identity.h"
#include "tests/support/test_world.h"

namespace troupe::test {

WorldDescription PlaneWorld(std::size_t robots) {
  TestWorld test;
  for (std::size_t i = 0; i < robots; ++i) {
    const RobotId robot = test.AddRobot(Square(0.4), {0.0, 0.5}, {0.0, 10.0 * static_cast<double>(i), 0.0, 0.0});
    RobotDescription& description = test.world.robots[robot.index()];
    description.name = "r" + std::to_string(i);
    description.drive.velocity.x = {-10.0, 10.0};
    test.model(description.root).name = description.name;
  }
  test.world.name = "plane";
  return test.world;
}

void CoordinatorTest::Make(std::size_t robots) {
  scene = std::make_shared<const Scene>(PlaneWorld(robots));
  options.run = kRun;
  coordinator.emplace(scene, options, endpoint, observers, now);
}

void CoordinatorTest::MakeAndStart(std::size_t robots) {
  Make(robots);
  for (AgentId agent = 1; agent <= robots; ++agent) Join(agent);
  ASSERT_EQ(coordinator->phase(), TickCoordinator::Phase::kRunning);
  Events();
}

JoinMessage CoordinatorTest::JoinOf(AgentId agent, const std::vector<std::string>& robots) const {
  return {.run = kRun,
          .agent = agent,
          .protocol_version = kProtocolVersion,
          .world_hash = Hash(scene->world()),
          .host = "host" + std::to_string(agent),
          .pid = static_cast<std::uint32_t>(agent),
          .robots = robots};
}

void CoordinatorTest::Join(AgentId agent, const std::vector<std::string>& robots) {
  coordinator->OnJoin(JoinOf(agent, robots), now);
}

ProposalMessage CoordinatorTest::ProposalOf(AgentId agent, double vx, std::optional<Tick> for_tick) const {
  ProposalMessage message{kRun, agent, for_tick.value_or(tick() + 1), {{RobotId(agent - 1), {vx, 0.0, 0.0}}}, {}};
  if (!endpoint.frames.empty()) message.edition = endpoint.frames.back().edition;
  return message;
}

ControlReply CoordinatorTest::Ask(const control::Request& request) {
  const auto reply = std::make_shared<ControlReply>();  // which may follow later
  coordinator->Control(
      request, [reply](const ControlReply& made) { *reply = made; }, now);
  return *reply;
}

void CoordinatorTest::Wait(double seconds) {
  now += seconds;
  coordinator->Poll(now);
}

double CoordinatorTest::Travel(std::size_t robot) const {
  return endpoint.frames.back().state.robots[robot].X_WR.x;
}

std::vector<std::string> CoordinatorTest::Events() {
  std::vector<std::string> texts;
  for (const Event& event : coordinator->DrainEvents()) {
    texts.push_back(NameOf(event.type));
    if (event.robot) texts.back() += " " + scene->world().robot(*event.robot).name;
  }
  return texts;
}

}  // namespace troupe::test
