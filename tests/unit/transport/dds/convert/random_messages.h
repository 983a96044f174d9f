// Messages with every field filled in at random, for round trips.
#pragma once

#include <optional>
#include <random>

#include "transport/protocol/messages.h"

namespace troupe::test {

class RandomMessages {
 public:
  explicit RandomMessages(std::uint64_t seed) : engine_(seed) {}

  SessionMessage Session();
  JoinMessage Join();
  std::vector<AdmissionMessage> Admissions();
  FrameMessage Frame();
  HistoryMessage History();
  ProposalMessage Proposal();
  StatusMessage Status();
  ControlReply Reply();
  RobotCommand Command(RobotId robot);

 private:
  std::uint64_t Bits() { return engine_(); }
  std::uint64_t Below(std::uint64_t count) { return engine_() % count; }
  bool Coin() { return Below(2) == 1; }
  double Number(double min = -100.0, double max = 100.0) {
    return std::uniform_real_distribution<double>(min, max)(engine_);
  }
  std::string Text();
  std::vector<std::string> Texts();
  Pose RandomPose();
  Interval RandomInterval(double min, double max);
  TwistBounds RandomBounds(double min, double max);
  Polygon RandomPolygon();
  Shape RandomShape();
  ModelDescription RandomModel(std::size_t index, std::size_t shapes);
  SensorParameters RandomSensor();
  RobotDescription RandomRobot(ModelId root, const std::string& name);
  JointDescription RandomJoint(RobotId robot, ModelId model);
  // A robot with a gripper, after all other models and robots.
  void AddGripper(WorldDescription& world);
  WorldDescription RandomWorld();
  LaneGraph RandomLanes(const WorldDescription& world);  // without number
  // An id below `count`, or none.
  template <typename Id>
  std::optional<Id> MaybeId(std::size_t count) {
    if (count == 0 || Coin()) return std::nullopt;
    return Id(Below(count));
  }
  void FillManipulation(WorldState& state);
  std::optional<ControllerCheckpoint> RandomPlace();
  RadioMessage RandomMessage(std::size_t robots);

  std::mt19937_64 engine_;
};

}  // namespace troupe::test
