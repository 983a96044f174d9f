// source and sink: stations for robots that carry units (fasr). A station counts the visitors that its sensors see, and
// shows by a flag, a joint that it raises, whether it has a unit to give, or room for one.
//
// A visit is one unbroken time within reach; a visitor gets or brings one unit in it, after load_time. Visitors are
// told apart by the models that a fiducial finder sees. Units are counted, not objects: nothing is moved in the world
// but the flag.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include "robot-agent/controller/built_in.h"
#include "robot-agent/navigation/rays.h"
#include "troupe/parameters.h"

namespace troupe {
namespace {

struct StationParameters {
  double interval = 5.0;   // s, in which a source makes a unit, or a sink uses one up
  double capacity = 1.0;   // units in stock
  double reach = 1.5;      // m: a visitor is nearer
  double load_time = 2.5;  // s, of a visit for one unit
};

template <bool kIsSource>
constexpr const char* kStation = kIsSource ? "source" : "sink";

template <bool kIsSource>
Result<StationParameters> ParseStation(const std::string& text) {
  StationParameters p;
  Parameters reader(kStation<kIsSource>, text);
  p.interval = reader.ReadNumber("interval", {0.0, 1e6}).value_or(p.interval);
  p.capacity = reader.ReadNumber("capacity", {1.0, 1e9}).value_or(p.capacity);
  p.reach = reader.ReadNumber("reach", {0.0, 1000.0}).value_or(p.reach);
  p.load_time = reader.ReadNumber("load_time", {0.0, 3600.0}).value_or(p.load_time);
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return p;
}

// The first joint that is no part of a gripper.
std::optional<std::size_t> FindFlag(const RobotInfo& info) {
  for (std::size_t i = 0; i < info.joints.size(); ++i) {
    const bool is_of_gripper = std::any_of(info.grippers.begin(), info.grippers.end(), [&](const GripperInfo& gripper) {
      return gripper.left == i || gripper.right == i || gripper.lift == i;
    });
    if (!is_of_gripper) return i;
  }
  return std::nullopt;
}

template <bool kIsSource>
class StationController final : public Controller {
 public:
  StationController(const RobotInfo& info, const StationParameters& parameters, std::optional<std::size_t> finder,
                    std::optional<std::size_t> ranger)
      : parameters_(parameters), finder_(finder), ranger_(ranger), flag_(FindFlag(info)) {
    if (flag_) flag_range_ = info.joints[*flag_]->position;
    if (ranger_) rays_ = RaysOf(info, *ranger_);
    stock_ = kIsSource ? parameters.capacity : 0.0;
  }

  std::vector<std::size_t> Subscriptions() const override { return {finder_ ? *finder_ : *ranger_}; }

  Command Update(const Observation& observation) override {
    ChangeStock(observation.time);
    const std::uint64_t before = units_;
    SeeVisitors(observation);
    Command command;
    if (units_ != before) {
      command.report = fmt::format("{} unit{} {}", units_, units_ == 1 ? "" : "s", kIsSource ? "given" : "received");
    }
    const bool shows = is_ready();
    if (flag_ && shows != flag_shows_) {
      command.joints.push_back({.joint = *flag_, .position = shows ? flag_range_.max : flag_range_.min});
    }
    flag_shows_ = shows;
    return command;
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<StationController>(*this); }

 private:
  struct Visit {
    double since = 0.0;  // s, simulated
    bool served = false;
  };

  // It can give a unit, or has room for one.
  bool is_ready() const { return kIsSource ? stock_ >= 1.0 : stock_ + 1.0 <= parameters_.capacity; }

  void ChangeStock(double now) {
    while (now >= next_change_ && parameters_.interval > 0.0) {
      next_change_ += parameters_.interval;
      if (now == 0.0) continue;
      stock_ = kIsSource ? std::min(stock_ + 1.0, parameters_.capacity) : std::max(stock_ - 1.0, 0.0);
    }
    if (parameters_.interval <= 0.0) stock_ = kIsSource ? parameters_.capacity : 0.0;
  }

  // A visitor receives or brings one unit in each visit.
  void SeeVisitors(const Observation& observation) {
    std::map<ModelId, Visit> present;
    for (const ModelId visitor : VisitorsOf(observation)) {
      const auto known = visits_.find(visitor);
      Visit& visit = present[visitor];
      visit = known != visits_.end() ? known->second : Visit{observation.time};
      if (visit.served || !is_ready() || observation.time - visit.since < parameters_.load_time) continue;
      visit.served = true;
      stock_ += kIsSource ? -1.0 : 1.0;
      ++units_;
    }
    visits_ = std::move(present);
  }

  // A ranger tells no robots apart: all that it sees within reach is one visitor.
  std::vector<ModelId> VisitorsOf(const Observation& observation) const {
    std::vector<ModelId> visitors;
    if (finder_) {
      const auto* const reading = observation.sensors[*finder_].template As<FiducialReading>();
      if (reading == nullptr) return visitors;
      for (const Fiducial& fiducial : reading->fiducials) {
        if (fiducial.range <= parameters_.reach) visitors.push_back(fiducial.model);
      }
      return visitors;
    }
    const SensorReading& reading = observation.sensors[*ranger_];
    const bool near = std::any_of(rays_->begin(), rays_->end(), [&](const RangerRay& ray) {
      const double range = RangeOf(reading, ray);
      return range <= parameters_.reach && range < ray.max_range;
    });
    if (near) visitors.emplace_back(0);
    return visitors;
  }

  StationParameters parameters_;
  std::optional<std::size_t> finder_;
  std::optional<std::size_t> ranger_;
  std::optional<std::size_t> flag_;
  Interval flag_range_;
  std::optional<bool> flag_shows_;
  Shared<std::vector<RangerRay>> rays_;
  double stock_ = 0.0;
  double next_change_ = 0.0;  // s, simulated
  std::map<ModelId, Visit> visits_;
  std::uint64_t units_ = 0;
};

template <bool kIsSource>
Status CheckStation(const std::string& parameters) {
  const Result<StationParameters> parsed = ParseStation<kIsSource>(parameters);
  return parsed.ok() ? Status() : parsed.error();
}

template <bool kIsSource>
Result<std::unique_ptr<Controller>> CreateStation(const RobotInfo& info) {
  const Result<StationParameters> parameters = ParseStation<kIsSource>(info.parameters);
  if (!parameters.ok()) return parameters.error();
  const std::optional<std::size_t> finder = FindFinder(info);
  const std::optional<std::size_t> ranger = FindBestRanger(info);
  if (!finder && !ranger) {
    return Error{{},
                 fmt::format("{}: the robot has neither a fiducial finder nor a ranger to see its visitors, expected "
                             "one of them",
                             kStation<kIsSource>)};
  }
  return std::unique_ptr<Controller>(
      std::make_unique<StationController<kIsSource>>(info, parameters.value(), finder, ranger));
}

}  // namespace

BuiltInController Source() {
  return {kStation<true>, CheckStation<true>, CreateStation<true>};
}

BuiltInController Sink() {
  return {kStation<false>, CheckStation<false>, CreateStation<false>};
}

}  // namespace troupe
