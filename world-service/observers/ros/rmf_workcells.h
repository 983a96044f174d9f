// RmfWorkcells: the dispensers and ingestors of a world as Open-RMF sees them. Their states are on /dispenser_states
// and /ingestor_states; a request moves an item by an edit of the run, whose outcome is on /dispenser_results and
// /ingestor_results. A repeated request has the same result again, and moves nothing.
//
// RmfTopics calls it, one call at a time; it makes and ends it on its own thread. What a request moves is planned
// between two calls (NextQuestion, Plan), because that may take long.
//
// A request goes through: acknowledged, planned against the newest state, executed as a set-pose edit, answered.
// Clients repeat requests until they see the result, so results are remembered (kMaxPast of them) by workcell and
// request number.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
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

  void ChangeWorld(const std::shared_ptr<const Scene>& scene);
  // Reads the requests that have arrived, unless some are not planned yet: those stay in the readers, which have a
  // bound. With kWithTicks in the order of their numbers.
  void Read();
  bool has_requests() const { return !requests_.empty(); }
  // Arguments of PlanMove.
  struct Question {
    Workcell workcell;
    WorkcellOrder order;
    std::set<std::string> moving;
  };
  // Of the oldest request; nothing if there is none.
  std::optional<Question> NextQuestion();
  // The answer to that. Returns the edit that moves the item, if there is one. REQUIRES: the world is the same.
  std::optional<control::SetPose> Plan(const Result<ItemMove>& planned);
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
  struct Move {
    std::string workcell;
    std::string number;  // of the request
    WorkcellKind kind = WorkcellKind::kDispenser;
    bool operator==(const Move&) const = default;
  };
  struct Waiting {
    Move move;
    WorkcellOrder order;
  };

  Topics& TopicsOf(WorkcellKind kind) { return *topics_[static_cast<std::size_t>(kind)]; }
  const Workcell* Find(WorkcellKind kind, const std::string& name) const;
  void Accept(WorkcellKind kind, const Request& request);
  bool IsOpen(const Move& move) const;
  void Answer(const Move& move, bool is_done);
  void Fail(const Move& move, const std::string& reason);
  void WriteResult(const Move& move, ResultStatus status);

  const Results results_;
  const std::function<void(const std::string&)> report_;
  std::vector<std::unique_ptr<Topics>> topics_;  // by kind
  std::vector<Workcell> workcells_;
  std::deque<Waiting> requests_;       // without a plan
  std::map<std::string, Move> moves_;  // by item: those without an answer
  // By request, with the workcell and number: whether it was fulfilled.
  std::map<std::tuple<WorkcellKind, std::string, std::string>, bool> past_;
  std::map<std::pair<WorkcellKind, std::string>, bool> busy_;  // by workcell: as it was shown last
  Tick tick_ = 0;                                              // the newest, and its time
  ros::Time stamp_ = {};
  struct LateResult {
    Move move;
    ResultStatus status;
    ros::Time stamp;
  };
  std::vector<LateResult> late_results_;  // to be written with the next tick
};

}  // namespace troupe
