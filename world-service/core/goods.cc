// Goods and the robots that bring them (step_workspace.h: MoveGoods).
//
// Each flow has goods that arrive at its start. Each is a job: the oldest one without a robot gets the nearest robot
// that is free, by the straight way, a level of difference counting as a detour. A robot reports when it has loaded and
// delivered. One that reports nothing in a tick, because it is lost or has no energy, loses a job that it has not
// loaded yet, so that another robot can have it.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "common/base/glob.h"
#include "common/model/states.h"
#include "troupe/random.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

constexpr std::uint64_t kArrivals = 0x676f6f6473;  // the stream of random numbers
constexpr double kPerHeight = 10.0;                // m of a way for each m of height

class Dispatcher {
 public:
  Dispatcher(const TickOrders& orders, StepWorkspace& workspace)
      : workspace_(workspace), world_(workspace.world()), state_(workspace.next) {
    orders_.resize(world_.robots.size());
    orders.ForEachOfRobots<JobOrder>([&](RobotId robot, const JobOrder& order) {
      std::optional<JobOrder>& own = orders_[robot.index()];
      if (!own) own = order;  // the first one counts
    });
  }

  void Act() {
    for (std::size_t i = 0; i < world_.flows.size(); ++i) Receive(i);
    for (Job& job : state_.jobs) Follow(job);
    std::erase_if(state_.jobs, [&](const Job& job) { return IsDelivered(job); });
    Assign();
  }

 private:
  // The goods of a flow that arrive in this tick: at most one.
  void Receive(std::size_t number) {
    const GoodsFlow& flow = world_.flows[number];
    const double share = std::min(flow.per_hour * workspace_.seconds() / 3600.0, 1.0);  // of goods in a tick
    const bool arrives = flow.is_random ? RandomUniform({world_.seed, kArrivals, number, state_.tick}) < share
                                        : std::floor(share * static_cast<double>(state_.tick)) >
                                              std::floor(share * static_cast<double>(state_.tick - 1));
    if (!arrives) return;
    const auto flow_id = static_cast<std::uint32_t>(number);
    const auto waiting = std::count_if(state_.jobs.begin(), state_.jobs.end(),
                                       [&](const Job& job) { return job.flow == flow_id && !job.is_loaded; });
    FlowState& counts = state_.flows[number];
    if (waiting >= static_cast<std::ptrdiff_t>(flow.room)) {
      ++counts.refused;
      return;
    }
    state_.jobs.push_back({.flow = flow_id,
                           .number = counts.arrived++,
                           .since = state_.tick,
                           .due = state_.tick + TicksIn(world_, flow.due)});
  }

  const std::optional<JobOrder>& OrderOf(const Job& job) const { return orders_[job.robot->index()]; }

  void Follow(Job& job) {
    if (!job.robot) return;
    const bool exists = RobotExists(world_, *job.robot);
    const std::optional<JobOrder>& order = OrderOf(job);
    if (!exists || (!order && !job.is_loaded)) {
      job.robot.reset();
      job.is_loaded = false;
    } else if (order && order->loads) {
      job.is_loaded = true;
    }
  }

  bool IsDelivered(const Job& job) {
    if (!job.robot || !job.is_loaded) return false;
    const std::optional<JobOrder>& order = OrderOf(job);
    if (!order || !order->delivers) return false;
    FlowState& counts = state_.flows[job.flow];
    ++counts.delivered;
    if (state_.tick > job.due) {
      ++counts.late;
      counts.lateness += state_.tick - job.due;
    }
    return true;
  }

  void Assign() {
    std::vector<RobotId> free;
    for (std::size_t i = 0; i < orders_.size(); ++i) {
      if (orders_[i] && orders_[i]->is_free) free.emplace_back(i);
    }
    std::erase_if(free, [&](RobotId robot) {
      return std::any_of(state_.jobs.begin(), state_.jobs.end(), [&](const Job& job) { return job.robot == robot; });
    });
    for (Job& job : state_.jobs) {
      if (free.empty()) return;
      if (job.robot) continue;
      const GoodsFlow& flow = world_.flows[job.flow];
      std::optional<std::size_t> nearest;
      double least = 0.0;
      for (std::size_t i = 0; i < free.size(); ++i) {
        if (!MatchesGlob(flow.robots, world_.robot(free[i]).name)) continue;
        const Pose& X_WR = state_.robots[free[i].index()].X_WR;
        const double way = (X_WR.translation() - flow.place).norm() + kPerHeight * std::fabs(X_WR.z - flow.z);
        if (nearest && way >= least) continue;
        nearest = i;
        least = way;
      }
      if (!nearest) continue;
      job.robot = free[*nearest];
      free.erase(free.begin() + static_cast<std::ptrdiff_t>(*nearest));
    }
  }

  StepWorkspace& workspace_;
  const WorldDescription& world_;
  WorldState& state_;
  std::vector<std::optional<JobOrder>> orders_;  // by robot
};

}  // namespace

void MoveGoods(const TickOrders& orders, StepWorkspace& workspace) {
  if (workspace.world().flows.empty()) return;
  Dispatcher(orders, workspace).Act();
}

}  // namespace troupe
