#include "launcher/run_to_tick.h"

#include <memory>

#include "common/spatial/body_index.h"
#include "robot-agent/agent/robot.h"
#include "robot-agent/sensors/ranger.h"
#include "world-service/core/step.h"
#include "world-service/core/validate_proposal.h"

namespace troupe {

Result<WorldState> RunToTick(const Scene& scene, Tick tick, std::vector<std::string>& failures) {
  WorldState state = InitialState(scene.world());
  if (tick == 0) return state;
  std::vector<std::unique_ptr<Robot>> robots;
  for (std::size_t i = 0; i < scene.world().robots.size(); ++i) {
    Result<std::unique_ptr<Robot>> robot = Robot::Create(scene, RobotId(i), nullptr);
    if (!robot.ok()) return robot.error();
    robots.push_back(std::move(robot).value());
  }
  BodyIndex index(scene);
  std::vector<Proposal> proposals;
  while (state.tick < tick) {
    index.Assign(state);
    proposals.clear();
    for (const std::unique_ptr<Robot>& robot : robots) {
      const bool worked = robot->failure().empty();
      const Proposal proposal = robot->Decide(state, index);
      if (worked && !robot->failure().empty()) failures.push_back(robot->failure());
      if (ValidateProposal(scene.world(), state, proposal).empty()) proposals.push_back(proposal);
    }
    state = Step(scene, state, proposals).state;
  }
  return state;
}

std::vector<ScanFan> MeasureFans(const Scene& scene, const WorldState& state) {
  BodyIndex index(scene);
  index.Assign(state);
  std::vector<ScanFan> fans;
  for (std::size_t i = 0; i < scene.world().robots.size(); ++i) {
    const RobotDescription& robot = scene.world().robots[i];
    for (std::size_t j = 0; j < robot.rangers.size(); ++j) {
      RangerReading reading;
      MeasureRanger(scene, index, RobotId(i), j, state.tick, reading);
      const Pose X_WM = index.X_WM(robot.rangers[j].model);
      for (std::size_t k = 0; k < reading.scans.size(); ++k) {
        const RaySensorDescription& sensor = robot.rangers[j].sensors[k];
        fans.push_back({X_WM * sensor.X_MS, sensor.fov, sensor.range.max, Bearings(sensor), reading.scans[k].ranges});
      }
    }
  }
  return fans;
}

}  // namespace troupe
