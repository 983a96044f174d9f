// PoseCommands: the topics of RViz's tools command robots. A pose on <robot>/goal_pose becomes the goal of the robot's
// controller, and one on <robot>/initialpose the robot's pose in the world. A thread of its own follows the robots of
// the world, because a reader must not end on the thread that receives its samples.
//
// Both become control requests, recorded with their tick: a replay needs no ROS. Refused poses (another frame, a tilted
// pose, a controller without goals) are reported, because a topic has no answer; FloodLimiter bounds the lines of a
// peer that keeps sending them.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/base/text.h"
#include "common/spatial/scene.h"
#include "ros/connection/ros_connection.h"
#include "ros/messages/messages.h"
#include "ros/messages/ros_options.h"
#include "world-service/service/run_observer.h"

namespace troupe {

class PoseCommands {
 public:
  // `of_run`: the connection in the domain of the run. `report` receives refused poses, one line each, on any thread.
  // All outlive this; `control` and `report` outlive the replies, too.
  PoseCommands(ros::RosConnection& of_run, const ros::RosOptions& options, std::shared_ptr<const Scene> scene,
               WorldControl& control, std::function<void(const std::string&)> report);
  // After it no call into the control runs.
  ~PoseCommands();
  PoseCommands(const PoseCommands&) = delete;
  PoseCommands& operator=(const PoseCommands&) = delete;

  // An edit has replaced the world.
  void ChangeWorld(std::shared_ptr<const Scene> scene);

 private:
  struct Inputs;

  void Run();
  void Follow(const Scene& scene);
  void SetGoal(const std::string& robot, const char* frame, const ros::PoseMessage& pose);
  void SetPose(const std::string& robot, const char* frame, const ros::PoseMessage& pose);
  void Refuse(const std::string& robot, const std::string& topic, const std::string& reason);

  ros::RosConnection& of_run_;
  const ros::RosOptions options_;
  WorldControl& control_;
  const std::shared_ptr<FloodLimiter> reports_;
  std::mutex mutex_;  // guards the members up to scene_
  std::condition_variable changed_;
  bool stop_ = false;
  bool arrived_ = false;  // a sample
  bool follow_ = true;    // the scene is new
  std::shared_ptr<const Scene> scene_;
  std::vector<std::unique_ptr<Inputs>> inputs_;  // of the thread
  std::thread thread_;                           // last, because it uses all other members
};

}  // namespace troupe
