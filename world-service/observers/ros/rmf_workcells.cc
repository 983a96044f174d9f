#include "world-service/observers/ros/rmf_workcells.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "common/base/or_failure.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"

namespace troupe {
namespace {

constexpr std::int32_t kWorkcellDepth = 10;          // as of the plugins of Open-RMF
constexpr std::int32_t kWorkcellRequestDepth = 100;  // of all workcells
constexpr std::size_t kMaxOpen = 1000;
constexpr std::size_t kMaxPast = 10'000;
constexpr std::size_t kMaxLateResults = 10'000;
constexpr std::size_t kMaxWorkcellText = 256;  // bytes

enum class WorkcellMode : std::int32_t { kIdle = 0, kBusy = 1 };

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
      : requests_(node, fmt::format("/{}_requests", NameOf(kind)), ros::Stream(kWorkcellRequestDepth),
                  ros::Part::kOnlyReader, notify),
        results_(node, fmt::format("/{}_results", NameOf(kind)), ros::Stream(kWorkcellDepth)),
        states_(node, fmt::format("/{}_states", NameOf(kind)), ros::Stream(kWorkcellDepth)) {}

  void Drain(const std::function<void(const RmfWorkcells::Request&)>& consume) override {
    requests_.Drain([&](const RequestMessage& message) {
      const auto items = dds::Elements(message.items);
      consume({dds::Text(message.request_guid),
               dds::Text(message.target_guid),
               {dds::Text(message.transporter_type), items.empty() ? "" : dds::Text(items.front().type_guid)}});
    });
  }
  void WriteResult(const ros::Time& stamp, const std::string& workcell, const std::string& number,
                   RmfWorkcells::ResultStatus status) override {
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

RmfWorkcells::RmfWorkcells(const ros::RosNode& node, const std::function<void()>& notify, Results results,
                           std::function<void(const std::string&)> report)
    : results_(results), report_(std::move(report)) {
  topics_.push_back(
      std::make_unique<TopicsOfKind<ros::DispenserRequest, ros::DispenserResult, ros::DispenserStateMessage>>(
          node, WorkcellKind::kDispenser, notify));
  topics_.push_back(
      std::make_unique<TopicsOfKind<ros::IngestorRequest, ros::IngestorResult, ros::IngestorStateMessage>>(
          node, WorkcellKind::kIngestor, notify));
}

RmfWorkcells::~RmfWorkcells() = default;

void RmfWorkcells::ChangeWorld(const WorldDescription& world) {
  workcells_ = FindWorkcells(world);
}

const Workcell* RmfWorkcells::Find(WorkcellKind kind, const std::string& name) const {
  const auto found = std::find_if(workcells_.begin(), workcells_.end(),
                                  [&](const Workcell& each) { return each.kind == kind && each.name == name; });
  return found == workcells_.end() ? nullptr : &*found;
}

void RmfWorkcells::Read() {
  for (const WorkcellKind kind : {WorkcellKind::kDispenser, WorkcellKind::kIngestor}) {
    std::vector<Request> requests;
    TopicsOf(kind).Drain([&](const Request& request) { requests.push_back(request); });
    if (results_ == Results::kWithTicks) {
      std::stable_sort(requests.begin(), requests.end(), [](const Request& a, const Request& b) {
        return std::tie(a.number, a.workcell) < std::tie(b.number, b.workcell);
      });
    }
    for (const Request& request : requests) Accept(kind, request);
  }
}

// As for the plugins, another dispenser or ingestor may have the workcell's name: it is no error.
void RmfWorkcells::Accept(WorkcellKind kind, const Request& request) {
  if (Find(kind, request.workcell) == nullptr) return;
  for (const auto& [field, text] : {std::pair("request_guid", &request.number),
                                    {"transporter_type", &request.order.fleet},
                                    {"type_guid", &request.order.item}}) {
    if (text->size() <= kMaxWorkcellText) continue;
    report_(fmt::format("/{}_requests: {} '{}': found a {} of {} bytes, expected at most {}", NameOf(kind),
                        NameOf(kind), request.workcell, field, text->size(), kMaxWorkcellText));
    return;
  }
  const RequestId id{kind, request.workcell, request.number};
  if (const auto past = past_.find(id); past != past_.end()) return Answer(id, past->second);
  if (IsOpen(id) || open_.size() >= kMaxOpen) return;  // without an acknowledgement it is repeated
  WriteResult(id, ResultStatus::kAcknowledged);
  open_.push_back({id, request.order});
}

bool RmfWorkcells::IsOpen(const RequestId& id) const {
  return std::any_of(open_.begin(), open_.end(), [&](const OpenRequest& open) { return open.id == id; });
}

bool RmfWorkcells::has_accepted() const {
  return std::any_of(open_.begin(), open_.end(), IsAccepted);
}

std::optional<control::SetPose> RmfWorkcells::PlanNext(const std::shared_ptr<const Scene>& scene,
                                                       const WorldState& state) {
  std::set<std::string> moving;
  for (const OpenRequest& open : open_) {
    if (open.stage == Stage::kMoving) moving.insert(open.item);
  }
  const auto next = std::find_if(open_.begin(), open_.end(), IsAccepted);
  if (next == open_.end()) return std::nullopt;
  const Workcell* const workcell = Find(next->id.kind, next->id.workcell);
  if (workcell == nullptr) {  // another world has come, without it
    open_.erase(next);
    return std::nullopt;
  }
  const Result<ItemMove> planned = OrFailure([&] { return PlanMove(scene, state, *workcell, next->order, moving); });
  if (!planned.ok()) {
    const RequestId id = std::move(next->id);
    open_.erase(next);
    Fail(id, planned.error().message);
    return std::nullopt;
  }
  control::SetPose move{planned.value().item, planned.value().X_WO};
  next->item = move.name;
  next->stage = Stage::kMoving;
  return move;
}

void RmfWorkcells::Finish(const std::string& item, bool is_done, const std::string& problem) {
  const auto found = std::find_if(open_.begin(), open_.end(), [&](const OpenRequest& open) {
    return open.stage == Stage::kMoving && open.item == item;
  });
  if (found == open_.end()) return;
  const RequestId id = std::move(found->id);
  open_.erase(found);
  if (is_done) {
    Answer(id, true);
  } else {
    Fail(id, problem);
  }
}

void RmfWorkcells::Fail(const RequestId& id, const std::string& reason) {
  report_(fmt::format("/{}_requests: {} '{}', request '{}': {}", NameOf(id.kind), NameOf(id.kind), id.workcell,
                      id.number, reason));
  Answer(id, false);
}

void RmfWorkcells::Answer(const RequestId& id, bool is_done) {
  // Forgetting all at once costs at most a second move for a request that is repeated after 10,000 others.
  if (past_.size() >= kMaxPast) past_.clear();
  past_[id] = is_done;
  WriteResult(id, is_done ? ResultStatus::kFulfilled : ResultStatus::kRefused);
}

void RmfWorkcells::WriteResult(const RequestId& id, ResultStatus status) {
  if (results_ == Results::kAtOnce) return TopicsOf(id.kind).WriteResult(stamp_, id.workcell, id.number, status);
  if (late_results_.size() < kMaxLateResults) return late_results_.push_back({id, status, stamp_});
  report_(fmt::format("/{}_results: the run is paused; left out a result of request '{}'", NameOf(id.kind), id.number));
}

void RmfWorkcells::OnTick(Tick tick, const ros::Time& stamp, bool is_due) {
  // An edit shows its tick again.
  if (std::exchange(tick_, tick) != tick) {
    for (const LateResult& late : std::exchange(late_results_, {})) {
      TopicsOf(late.id.kind).WriteResult(late.stamp, late.id.workcell, late.id.number, late.status);
    }
  }
  stamp_ = stamp;
  for (const Workcell& workcell : workcells_) {
    if (!TopicsOf(workcell.kind).wants_states()) continue;
    std::vector<std::string> numbers;
    for (const OpenRequest& open : open_) {
      const bool is_here = open.id.kind == workcell.kind && open.id.workcell == workcell.name;
      if (is_here && open.stage == Stage::kMoving) numbers.push_back(open.id.number);
    }
    const auto [shown, is_new] = busy_.emplace(std::pair(workcell.kind, workcell.name), false);
    if (!is_due && !is_new && shown->second == !numbers.empty()) continue;
    shown->second = !numbers.empty();
    TopicsOf(workcell.kind).WriteState(stamp, workcell.name, numbers);
  }
}

}  // namespace troupe
