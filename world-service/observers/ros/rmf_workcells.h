// RmfWorkcells: the dispensers and ingestors of a world as Open-RMF sees them. Their states are on /dispenser_states
// and /ingestor_states; a request moves an item by an edit of the run, whose outcome is on /dispenser_results and
// /ingestor_results. A repeated request has the same result again, and moves nothing.
//
// A request that is no repetition goes through these stages (Stage):
//
//   kAccepted: acknowledged; its move is not planned yet ──PlanNext──► kMoving, or answered as refused
//   kMoving: an edit moves the item ──Finish──► answered
//
// Clients repeat requests until they see the result, so results are remembered (kMaxPast of them) by workcell and
// request number.
//
// RmfTopics calls it, in turns of the run, and makes and ends it. PlanNext is the slow call: a search with at most 25
// trials of an edit, each with a step's memory of the whole world. So a turn calls it once.
#pragma once

#include <compare>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ros/connection/ros_connection.h"
#include "ros/messages/rmf.h"
#include "world-service/observers/ros/workcell_moves.h"
#include "world-service/service/run_observer.h"

namespace troupe {

class RmfWorkcells {
 public:
  // When a result is written: at once; or, where ticks wait for nodes, with the first tick after that of its request,
  // so that the announcement of the tick counts it.
  enum class Results : std::uint8_t { kAtOnce, kWithTicks };

  // `notify`: called when a request has arrived, on a thread of the connection. `report`: a line for each request that
  // fails.
  RmfWorkcells(const ros::RosNode& node, const std::function<void()>& notify, Results results,
               std::function<void(const std::string&)> report);
  ~RmfWorkcells();
  RmfWorkcells(const RmfWorkcells&) = delete;
  RmfWorkcells& operator=(const RmfWorkcells&) = delete;

  void ChangeWorld(const WorldDescription& world);
  // Reads the requests that have arrived; with kWithTicks in the order of their numbers.
  void Read();
  bool has_accepted() const;
  // The edit that moves the item of the oldest accepted request. Nothing: there is none, or it was answered as refused.
  std::optional<control::SetPose> PlanNext(const std::shared_ptr<const Scene>& scene, const WorldState& state);
  // The edit that moves the item has been answered.
  void Finish(const std::string& item, bool is_done, const std::string& problem);
  // Writes the states, if they are due, and the states of workcells that have become busy or idle.
  void OnTick(Tick tick, const ros::Time& stamp, bool is_due);

  class Topics;
  enum class ResultStatus : std::uint8_t { kAcknowledged = 0, kFulfilled = 1, kRefused = 2 };
  // A request, whatever its type.
  struct Request {
    std::string number;  // request_guid
    std::string workcell;
    WorkcellOrder order;
  };

 private:
  // The name of a request, which a repetition has, too.
  struct RequestId {
    WorkcellKind kind = WorkcellKind::kDispenser;
    std::string workcell;
    std::string number;
    auto operator<=>(const RequestId&) const = default;
  };
  enum class Stage : std::uint8_t { kAccepted, kMoving };
  struct OpenRequest {
    RequestId id;
    WorkcellOrder order;
    Stage stage = Stage::kAccepted;
    std::string item = {};  // that moves
  };
  static bool IsAccepted(const OpenRequest& open) { return open.stage == Stage::kAccepted; }

  Topics& TopicsOf(WorkcellKind kind) { return *topics_[static_cast<std::size_t>(kind)]; }
  const Workcell* Find(WorkcellKind kind, const std::string& name) const;
  void Accept(WorkcellKind kind, const Request& request);
  bool IsOpen(const RequestId& id) const;
  void Answer(const RequestId& id, bool is_done);
  void Fail(const RequestId& id, const std::string& reason);
  void WriteResult(const RequestId& id, ResultStatus status);

  const Results results_;
  const std::function<void(const std::string&)> report_;
  std::vector<std::unique_ptr<Topics>> topics_;  // by kind
  std::vector<Workcell> workcells_;
  std::deque<OpenRequest> open_;                               // in the sequence of their arrival
  std::map<RequestId, bool> past_;                             // whether it was fulfilled
  std::map<std::pair<WorkcellKind, std::string>, bool> busy_;  // by workcell: as it was shown last
  Tick tick_ = 0;                                              // the newest, and its time
  ros::Time stamp_ = {};
  struct LateResult {
    RequestId id;
    ResultStatus status;
    ros::Time stamp;
  };
  std::vector<LateResult> late_results_;  // to be written with the next tick
};

}  // namespace troupe
