// RmfTopics: the doors and lifts of a world as Open-RMF sees them. Their states are on /door_states and /lift_states;
// requests on /door_requests and /lift_requests become inputs of the next tick, as those of other tools are. It does
// what the plugins of rmf_simulation do: a door follows the newest request; a lift finishes a request before it accepts
// another. It also has the dispensers, ingestors and fleets of the world (RmfWorkcells, RmfFleets).
//
// A thread of its own makes and ends the topics, because a reader must not end on the thread that receives its samples.
//
// Order of locks: the observer's calls come with the lock of the run held, and lock the mutex of Shared; so no request
// to the control, which locks the run, is made with that mutex held. Requests are collected under it and sent after it.
//
// Where ticks wait for nodes (--ros-lockstep), the requests of one tick are ordered by requester and name instead of by
// arrival: the run then does not depend on the threads of the middleware.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "common/base/text.h"
#include "common/spatial/scene.h"
#include "ros/connection/ros_connection.h"
#include "ros/messages/rmf.h"
#include "world-service/observers/ros/rmf_fleets.h"
#include "world-service/observers/ros/rmf_workcells.h"
#include "world-service/service/run_observer.h"

namespace troupe {

class RmfTopics {
 public:
  // `report` receives refused requests, one line each, on any thread. All outlive this; `control` and `report` outlive
  // the replies, too.
  RmfTopics(const ros::RosNode& node, std::shared_ptr<const Scene> scene, WorldControl& control,
            RmfWorkcells::Results results, std::function<void(const std::string&)> report);
  // After it no call into the control runs.
  ~RmfTopics();
  RmfTopics(const RmfTopics&) = delete;
  RmfTopics& operator=(const RmfTopics&) = delete;

  // An edit has replaced the world.
  void ChangeWorld(std::shared_ptr<const Scene> scene);
  // Before the agents see the frame: the requests from now on are judged by its state.
  void OnCommit(const FrameMessage& frame);
  // Writes the states that have changed, or are due.
  void OnTick(const FrameMessage& frame);
  // Requests wait for Settle from here on: nodes have not answered the tick. Else their order would depend on threads.
  void Hold();
  // Passes on the requests that have arrived. False: some are not answered yet; WorldControl::Wake follows.
  bool Settle();

 private:
  struct Shared;
  struct Topics;
  // The newest request to a lift that counted.
  struct LiftTask {
    std::string session;  // as it asked; LiftState has none after its end
    ros::LiftRequestType type = ros::LiftRequestType::kAgv;
    std::string floor;  // "": none yet
    bool is_done = true;
    bool operator==(const LiftTask&) const = default;
  };
  struct DoorAsk {
    std::string requester;
    std::string door;
    bool opens = false;
  };
  struct LiftAsk {
    std::string session;
    std::string lift;
    std::string floor;
    std::uint8_t type = 0;
  };
  // What a lift has shown.
  struct LiftView {
    std::size_t floor = 0;
    LiftState state = {};
    ros::DoorMode doors = ros::DoorMode::kClosed;
    LiftTask task = {};
    bool operator==(const LiftView&) const = default;
  };

  void Run();
  // Makes or ends the topics as the world, and the readers of fleets, need.
  void Follow();
  // Makes or ends one of them; whether it has. A new one enters the world of now.
  template <typename Part, typename Make, typename Enter>
  bool FollowPart(std::unique_ptr<Part>& part, bool is_needed, const Make& make, const Enter& enter);
  // Plans the moves that workcells are asked for, and sends them, without the mutex: no tick waits for it but one that
  // nodes have answered. Whether there were some.
  bool PlanMoves();
  // REQUIRES of those below: the mutex is held.
  // False before the first frame of a world: samples wait until then.
  bool KnowsState() const;
  // Reads the requests that have arrived, and adds the edits of doors and lifts. Where ticks wait for nodes, those of
  // one requester after those of another, by name.
  void ReadRequests();
  // Tells the workcells of the edits that have been answered.
  void FinishMoves();
  void OperateDoor(const DoorAsk& ask);
  void CallLift(const LiftAsk& ask);
  // Adds the request to a door or a lift, unless the newest one, which the state may not have yet, is the same.
  // `already_there`: the state of now has what is asked for.
  template <typename Request>
  void Ask(const Request& request, bool already_there);
  // Memory for one edit more, and for its reply, which must not fail. Then AddEdit does not.
  void ReserveEdit();
  void AddEdit(control::Request edit);
  // Once for each line.
  void Refuse(const std::string& line);
  std::string SessionOf(std::size_t lift, const LiftState& state) const;
  // REQUIRES of this: the mutex is not held. An edit that cannot be sent, as without memory, has failed.
  void SendEdits();

  const ros::RosNode node_;
  WorldControl& control_;
  const RmfWorkcells::Results results_;
  const std::shared_ptr<FloodLimiter> reports_;
  const std::shared_ptr<Shared> shared_;  // its mutex guards the members below
  std::shared_ptr<const Scene> scene_;
  // Of the newest frame: doors and lifts, and in a world with workcells all. Empty before the first.
  WorldState state_;
  bool has_workcells_ = false;
  bool holds_ = false;                                // requests stay in the readers
  bool has_held_ = false;                             // some may have arrived since they were read last
  std::vector<control::Request> edits_;               // to be sent
  std::vector<std::size_t> doors_;                    // with requests of their own
  std::map<std::string, LiftTask> tasks_;             // by lift
  std::map<std::string, ros::DoorMode> shown_doors_;  // by door
  std::map<std::string, LiftView> shown_lifts_;
  std::set<std::string> refused_;
  std::unique_ptr<Topics> topics_;           // null: the world has neither doors nor lifts
  std::unique_ptr<RmfWorkcells> workcells_;  // null: it has none
  std::unique_ptr<RmfFleets> fleets_;        // null: it has nothing for Open-RMF
  std::thread thread_;                       // last, because it uses all other members
};

}  // namespace troupe
