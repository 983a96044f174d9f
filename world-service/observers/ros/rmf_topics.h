// RmfTopics: the doors and lifts of a world as Open-RMF sees them. Their states are on /door_states and /lift_states;
// requests on /door_requests and /lift_requests become inputs of the next tick, as the requests of other tools.
// It acts as the plugins of rmf_simulation: a door follows the newest request; a lift finishes a request before it
// accepts another. It also has the dispensers, ingestors and fleets of the world (RmfWorkcells, RmfFleets).
//
// Threads: it has no lock and no thread. All calls between constructor and destructor, and the replies to its requests,
// are in turns of the run (run_observer.h), one at a time. The notice that a sample has arrived comes on the thread of
// the connection, and sets a flag; so the connection has to be one whose readers may end on any thread: HostConnection.
// Constructor and destructor are in OnBegin and OnEnd, without the lock of the run. No turn needs it then: every path
// to the end of a run refuses the open requests in its last turn, and WatchTopics({}) comes before the destructor.
//
// No exception leaves a turn but those of OnCommit: as for lack of memory, it is a line for users, and the run goes on.
//
// When requests are read (Intake):
//
//   kAwaitsState ──frame──► kOpen, or kCollecting if nodes of ROS have to answer the tick (RosLockstepWait)
//   kOpen: requests are read as they arrive
//   kCollecting: they stay in the readers ──Settle: all nodes have answered──► kSettling
//   kSettling: they were read, and are executed ──none is open or without a plan──► kOpen
//
// A frame leads from any of them to kOpen or kCollecting, and a new world to kAwaitsState. In kCollecting the sequence
// of requests would depend on threads; Settle reads them sorted, so that equal answers of nodes make equal runs.
// A request for a door or a lift is answered in its turn; a move of an item is an edit of the run, which needs a pause.
// A turn plans one move, and asks for another turn while accepted requests are left, so that no message waits for all.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/text.h"
#include "common/spatial/scene.h"
#include "ros/messages/rmf.h"
#include "world-service/observers/ros/rmf_fleets.h"
#include "world-service/observers/ros/rmf_workcells.h"
#include "world-service/service/run_observer.h"

namespace troupe {

class RmfTopics {
 public:
  // `node`: of a HostConnection. `report` receives refused requests, one line each. All outlive this; `control`
  // outlives the replies, too.
  RmfTopics(const ros::RosNode& node, std::shared_ptr<const Scene> scene, WorldControl& control,
            RmfWorkcells::Results results, std::function<void(const std::string&)> report);
  ~RmfTopics();
  RmfTopics(const RmfTopics&) = delete;
  RmfTopics& operator=(const RmfTopics&) = delete;

  // An edit has replaced the world.
  void ChangeWorld(std::shared_ptr<const Scene> scene);
  // Before the agents see the frame: the requests from now on are judged by its state. `awaits_nodes`: Settle follows.
  void OnCommit(const FrameMessage& frame, bool awaits_nodes);
  // Writes the states that have changed, or are due.
  void OnTick(const FrameMessage& frame);
  // Whether a request has arrived since the last call; then WorldControl::Wake is to lead to OnWake. From any thread.
  bool ConsumeArrival() { return has_arrived_.exchange(false); }
  void OnWake();
  // All nodes have answered the tick. False: requests are not answered yet; WorldControl::Wake follows.
  bool Settle();

 private:
  struct Topics;
  enum class Intake : std::uint8_t { kAwaitsState, kOpen, kCollecting, kSettling };
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
  // The newest request to a door or a lift, until the state has it.
  struct Wanted {
    control::Request request;              // a Door or a Lift
    std::optional<Tick> answered_at = {};  // an input of the tick after this one; nothing: not answered yet
  };

  // False: it has thrown, which is reported.
  template <typename Call>
  bool Attempt(const Call& call);
  // Makes or ends the topics, as the world needs; none exists after a failure.
  void FollowWorld();
  void ExchangeTopics();
  // Reads the requests that have arrived, and executes them, but only one move.
  void ExecuteRequests();
  // Where ticks wait for nodes, those of one requester after those of another, by name.
  void ReadRequests();
  void PlanMove();
  void OperateDoor(const DoorAsk& ask);
  void CallLift(const LiftAsk& ask);
  // Sends the request to a door or a lift, unless the newest one, which the state may not have yet, is the same.
  // `already_there`: the state of now has what is asked for.
  template <typename Request>
  void Ask(const Request& request, bool already_there);
  void Send(const control::Request& request);
  void OnReply(const control::Request& request, const ControlReply& reply);
  void Finish(const control::Request& request, const ControlReply& reply);
  // Whether a request whose longest text has that many bytes is not refused for it.
  bool HasShortTexts(const char* topic, std::size_t longest);
  // Once for each line.
  void Refuse(const std::string& line);
  // Ends the tasks of lifts that have arrived.
  void AdvanceLifts();
  void WriteStates(const FrameMessage& frame);
  void WriteDoors(const FrameMessage& frame, const ros::Time& stamp, bool is_due);
  void WriteLifts(const FrameMessage& frame, const ros::Time& stamp, bool is_due);
  std::string SessionOf(std::size_t lift, const LiftState& state) const;

  const ros::RosNode node_;
  WorldControl& control_;
  const RmfWorkcells::Results results_;
  FloodLimiter reports_;
  std::shared_ptr<RmfTopics*> self_;  // of replies, which find nothing after the end
  std::atomic<bool> has_arrived_ = false;
  std::shared_ptr<const Scene> scene_;
  Intake intake_ = Intake::kAwaitsState;
  bool has_late_ = false;                             // requests may have arrived in kSettling
  WorldState state_;                                  // of the newest frame; not in kAwaitsState
  std::size_t open_ = 0;                              // requests without a reply
  std::vector<std::size_t> doors_;                    // with requests of their own
  std::map<std::string, Wanted> wanted_;              // by door or lift
  std::map<std::string, LiftTask> tasks_;             // by lift
  std::map<std::string, ros::DoorMode> shown_doors_;  // by door
  std::map<std::string, LiftView> shown_lifts_;
  std::set<std::string> refused_;
  std::unique_ptr<Topics> topics_;           // null: the world has neither doors nor lifts
  std::unique_ptr<RmfWorkcells> workcells_;  // null: it has none
  std::unique_ptr<RmfFleets> fleets_;        // null: it has nothing for Open-RMF
};

}  // namespace troupe
