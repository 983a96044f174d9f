// Messages with every field filled in at random, for round trips.
#pragma once

#include <optional>

#include "tests/support/random_rows.h"
#include "transport/protocol/messages.h"

namespace troupe::test {

class RandomMessages : private RandomRows {
 public:
  using RandomRows::RandomRows;

  SessionMessage Session();
  JoinMessage Join();
  std::vector<AdmissionMessage> Admissions();
  FrameMessage Frame();
  HistoryMessage History();
  ProposalMessage Proposal();
  StatusMessage Status();
  ControlRequest Request();
  ControlReply Reply();
  RobotCommand Command(RobotId robot);

 private:
  std::vector<std::string> Texts();
  Pose RandomPose();
  Polygon RandomPolygon();
  Shape RandomShape();
  ModelDescription RandomModel(std::size_t index, std::size_t shapes);
  RobotDescription RandomRobot(ModelId root, const std::string& name);
  JointDescription RandomJoint(RobotId robot, ModelId model);
  // A robot with a gripper, after all other models and robots.
  void AddGripper(WorldDescription& world);
  void AddPeople(WorldDescription& world);
  WorldDescription RandomWorld();
  LaneGraph RandomLanes(const WorldDescription& world);  // without number
  // An id below `count`, or none.
  template <typename Id>
  std::optional<Id> MaybeId(std::size_t count) {
    if (count == 0 || Coin()) return std::nullopt;
    return Id(Below(count));
  }
};

}  // namespace troupe::test
