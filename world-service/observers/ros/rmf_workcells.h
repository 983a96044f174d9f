// RmfWorkcells: the dispensers and ingestors of a world as Open-RMF sees them. Their states are on /dispenser_states
// and /ingestor_states; a request moves an item by an edit of the run, whose outcome is on /dispenser_results and
// /ingestor_results. A repeated request has the same result again, and moves nothing.
//
// RmfTopics calls it, one call at a time; it makes and ends it on its own thread.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "ros/connection/ros_connection.h"
#include "ros/messages/rmf.h"
#include "world-service/observers/ros/workcell_moves.h"
#include "world-service/service/run_observer.h"

namespace troupe {

class RmfWorkcells {
 public:
  // `notify`: called when a request has arrived, on a thread of the connection. `report`: a line for each request that
  // fails.
  RmfWorkcells(const ros::RosNode& node, const std::function<void()>& notify,
               std::function<void(const std::string&)> report);
  ~RmfWorkcells();
  RmfWorkcells(const RmfWorkcells&) = delete;
  RmfWorkcells& operator=(const RmfWorkcells&) = delete;

  void ChangeWorld(std::shared_ptr<const Scene> scene);
  // Adds the edits of the requests that have arrived.
  void Take(const WorldState& state, std::vector<ControlRequest>& edits);
  // The edit that moves the item has been answered.
  void Finish(const std::string& item, bool is_done, const std::string& problem);
  // Writes the states, if they are due, and those of workcells that have become busy or idle.
  void OnTick(const ros::Time& stamp, bool is_due);

  class Topics;
  // A request, whatever its type.
  struct Request {
    std::string number;  // request_guid
    std::string workcell;
    WorkcellOrder order;
  };

 private:
  struct Move {
    std::string workcell;
    std::string number;  // of the request
    WorkcellKind kind = WorkcellKind::kDispenser;
  };

  Topics& TopicsOf(WorkcellKind kind) { return *topics_[static_cast<std::size_t>(kind)]; }
  void TakeRequest(WorkcellKind kind, const Request& request, const WorldState& state,
                   std::vector<ControlRequest>& edits);
  void Answer(const Move& move, bool is_done);
  void Fail(const Move& move, const std::string& reason);

  const std::function<void(const std::string&)> report_;
  std::vector<std::unique_ptr<Topics>> topics_;  // by kind
  std::shared_ptr<const Scene> scene_;
  std::vector<Workcell> workcells_;
  std::map<std::string, Move> moves_;  // by item: those without an answer
  // By request, with the workcell and number: whether it was fulfilled.
  std::map<std::tuple<WorkcellKind, std::string, std::string>, bool> past_;
  std::map<std::pair<WorkcellKind, std::string>, bool> busy_;  // by workcell: as it was shown last
  ros::Time stamp_ = {};                                       // of the newest tick
};

}  // namespace troupe
