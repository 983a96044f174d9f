#include "robot-agent/controller/lane_goods.h"

#include <utility>

namespace troupe {
namespace {

constexpr double kNextJob = 60.0;  // s, after a job that it cannot do

}  // namespace

void LaneGoods::Watch(const WorldDescription& world, const WorldState& state, RobotId own) {
  order_ = {};
  target_.reset();
  missing_.clear();
  job_.reset();
  for (const Job& job : state.jobs) {
    if (job.robot != own) continue;
    job_ = Work{job.flow, job.number, job.is_loaded};
    const GoodsFlow& flow = world.flows[job.flow];
    const std::string& place = job.is_loaded ? flow.to : flow.from;
    seconds_ = job.is_loaded ? flow.unload_seconds : flow.load_seconds;
    target_ = graph_->Find(place);
    if (!target_) missing_ = place;
    return;
  }
}

void LaneGoods::Rest(double rested) {
  if (!job_ || rested < seconds_) return;
  (job_->is_loaded ? order_.delivers : order_.loads) = true;
}

void LaneGoods::GiveUp(double time) {
  if (!job_ || job_->is_loaded) return;
  leaves_out_ = true;
  after_ = time + kNextJob;
}

std::optional<JobOrder> LaneGoods::OrderFor(double time, bool may_take) {
  if (!missing_.empty()) GiveUp(time);
  if (std::exchange(leaves_out_, false)) return std::nullopt;
  order_.is_free = !job_ && may_take && time >= after_;
  return order_;
}

std::optional<std::string> LaneGoods::TakeReport() {
  if (missing_.empty() || reported_ == job_) return std::nullopt;
  reported_ = job_;
  return "has no lanes to " + missing_ + ", and leaves the goods to another robot";
}

}  // namespace troupe
