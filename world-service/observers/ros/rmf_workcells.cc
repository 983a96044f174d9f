#include "world-service/observers/ros/rmf_workcells.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"

namespace troupe {
namespace {

constexpr std::int32_t kWorkcellDepth = 10;          // as of the plugins of Open-RMF
constexpr std::int32_t kWorkcellRequestDepth = 100;  // of all workcells
constexpr std::size_t kMostPast = 10'000;
constexpr std::size_t kLongestNumber = 256;  // bytes

enum class ResultStatus : std::uint8_t { kAcknowledged = 0, kFulfilled = 1, kRefused = 2 };
enum class WorkcellMode : std::int32_t { kIdle = 0, kBusy = 1 };

const char* Word(WorkcellKind kind) {
  return kind == WorkcellKind::kDispenser ? "dispenser" : "ingestor";
}

}  // namespace

class RmfWorkcells::Topics {
 public:
  Topics() = default;
  virtual ~Topics() = default;
  Topics(const Topics&) = delete;
  Topics& operator=(const Topics&) = delete;

  virtual void Drain(const std::function<void(const Request&)>& consume) = 0;
  virtual void WriteResult(const ros::Time& stamp, const std::string& workcell, const std::string& number,
                           ResultStatus status) = 0;
  virtual bool wants_states() const = 0;
  virtual void WriteState(const ros::Time& stamp, const std::string& workcell,
                          const std::vector<std::string>& numbers) = 0;
};

namespace {

// The messages of dispensers and ingestors have the same fields.
template <typename RequestMessage, typename ResultMessage, typename StateMessage>
class TopicsOfKind final : public RmfWorkcells::Topics {
 public:
  TopicsOfKind(const ros::RosNode& node, WorkcellKind kind, const std::function<void()>& notify)
      : requests_(node, fmt::format("/{}_requests", Word(kind)), ros::Stream(kWorkcellRequestDepth),
                  ros::Part::kOnlyReader, notify),
        results_(node, fmt::format("/{}_results", Word(kind)), ros::Stream(kWorkcellDepth)),
        states_(node, fmt::format("/{}_states", Word(kind)), ros::Stream(kWorkcellDepth)) {}

  void Drain(const std::function<void(const RmfWorkcells::Request&)>& consume) override {
    requests_.Drain([&](const RequestMessage& message) {
      const auto items = dds::Elements(message.items);
      consume({dds::Text(message.request_guid),
               dds::Text(message.target_guid),
               {dds::Text(message.transporter_type), items.empty() ? "" : dds::Text(items.front().type_guid)}});
    });
  }
  void WriteResult(const ros::Time& stamp, const std::string& workcell, const std::string& number,
                   ResultStatus status) override {
    dds::WireArena arena;
    results_.Write({stamp, arena.Copy(number), arena.Copy(workcell), static_cast<std::uint8_t>(status)});
  }
  bool wants_states() const override { return states_.wanted(); }
  void WriteState(const ros::Time& stamp, const std::string& workcell,
                  const std::vector<std::string>& numbers) override {
    dds::WireArena arena;
    StateMessage message{};
    message.time = stamp;
    message.guid = arena.Copy(workcell);
    message.mode = static_cast<std::int32_t>(numbers.empty() ? WorkcellMode::kIdle : WorkcellMode::kBusy);
    arena.FillStrings(message.request_guid_queue, numbers);
    states_.Write(message);
  }

 private:
  ros::RosReader<RequestMessage> requests_;
  ros::RosWriter<ResultMessage> results_;
  ros::RosWriter<StateMessage> states_;
};

}  // namespace

RmfWorkcells::RmfWorkcells(const ros::RosNode& node, const std::function<void()>& notify,
                           std::function<void(const std::string&)> report)
    : report_(std::move(report)) {
  topics_.push_back(
      std::make_unique<TopicsOfKind<ros::DispenserRequest, ros::DispenserResult, ros::DispenserStateMessage>>(
          node, WorkcellKind::kDispenser, notify));
  topics_.push_back(
      std::make_unique<TopicsOfKind<ros::IngestorRequest, ros::IngestorResult, ros::IngestorStateMessage>>(
          node, WorkcellKind::kIngestor, notify));
}

RmfWorkcells::~RmfWorkcells() = default;

void RmfWorkcells::ChangeWorld(std::shared_ptr<const Scene> scene) {
  scene_ = std::move(scene);
  workcells_ = FindWorkcells(scene_->world());
}

void RmfWorkcells::Take(const WorldState& state, std::vector<ControlRequest>& edits) {
  for (const WorkcellKind kind : {WorkcellKind::kDispenser, WorkcellKind::kIngestor}) {
    TopicsOf(kind).Drain([&](const Request& request) { TakeRequest(kind, request, state, edits); });
  }
}

// As for the plugins, another dispenser or ingestor may have the workcell's name: it is no error.
void RmfWorkcells::TakeRequest(WorkcellKind kind, const Request& request, const WorldState& state,
                               std::vector<ControlRequest>& edits) {
  const auto workcell = std::find_if(workcells_.begin(), workcells_.end(), [&](const Workcell& each) {
    return each.kind == kind && each.name == request.workcell;
  });
  if (workcell == workcells_.end()) return;
  if (request.number.size() > kLongestNumber) {
    report_(fmt::format("/{}_requests: {} '{}': found a request_guid of {} bytes, expected at most {}", Word(kind),
                        Word(kind), request.workcell, request.number.size(), kLongestNumber));
    return;
  }
  const Move move{request.workcell, request.number, kind};
  if (const auto past = past_.find({kind, request.workcell, request.number}); past != past_.end())
    return Answer(move, past->second);
  std::set<std::string> moving;
  for (const auto& [item, open] : moves_) {
    if (open.kind == kind && open.workcell == request.workcell && open.number == request.number) return;
    moving.insert(item);
  }
  TopicsOf(kind).WriteResult(stamp_, move.workcell, move.number, ResultStatus::kAcknowledged);
  const Result<ItemMove> planned = PlanMove(scene_, state, *workcell, request.order, moving);
  if (!planned.ok()) return Fail(move, planned.error().message);
  moves_.emplace(planned.value().item, move);
  ControlRequest edit;
  edit.command = ControlCommand::kSetPose;
  edit.name = planned.value().item;
  edit.pose = planned.value().X_WO;
  edits.push_back(std::move(edit));
}

void RmfWorkcells::Finish(const std::string& item, bool is_done, const std::string& problem) {
  const auto found = moves_.find(item);
  if (found == moves_.end()) return;
  const Move move = found->second;
  moves_.erase(found);
  if (is_done) {
    Answer(move, true);
  } else {
    Fail(move, problem);
  }
}

void RmfWorkcells::Fail(const Move& move, const std::string& reason) {
  report_(fmt::format("/{}_requests: {} '{}', request '{}': {}", Word(move.kind), Word(move.kind), move.workcell,
                      move.number, reason));
  Answer(move, false);
}

void RmfWorkcells::Answer(const Move& move, bool is_done) {
  if (past_.size() >= kMostPast) past_.clear();
  past_[{move.kind, move.workcell, move.number}] = is_done;
  TopicsOf(move.kind).WriteResult(stamp_, move.workcell, move.number,
                                  is_done ? ResultStatus::kFulfilled : ResultStatus::kRefused);
}

void RmfWorkcells::OnTick(const ros::Time& stamp, bool is_due) {
  stamp_ = stamp;
  for (const Workcell& workcell : workcells_) {
    if (!TopicsOf(workcell.kind).wants_states()) continue;
    std::vector<std::string> numbers;
    for (const auto& [item, move] : moves_) {
      if (move.kind == workcell.kind && move.workcell == workcell.name) numbers.push_back(move.number);
    }
    const auto [shown, is_new] = busy_.emplace(std::pair(workcell.kind, workcell.name), false);
    if (!is_due && !is_new && shown->second == !numbers.empty()) continue;
    shown->second = !numbers.empty();
    TopicsOf(workcell.kind).WriteState(stamp, workcell.name, numbers);
  }
}

}  // namespace troupe
