// What the simulation services share: the control of the run, and what its entities are called in ROS.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "common/dds/wire.h"
#include "common/ros_dds/ros_service.h"
#include "common/ros_dds/simulation_types.h"
#include "common/spatial/scene.h"
#include "world-service/service/world_control.h"

namespace troupe {

// The codes of simulation_interfaces/msg/Result.
enum class ResultCode : std::uint8_t {
  kUnsupported = 0,
  kOk = 1,
  kNotFound = 2,
  kIncorrectState = 3,
  kOperationFailed = 4,
};

inline simulation_interfaces_msg_dds__Result_ MakeResult(std::uint8_t code, const std::string& problem,
                                                         dds::WireArena& arena) {
  return {code, arena.Copy(problem)};
}
inline simulation_interfaces_msg_dds__Result_ MakeResult(ResultCode code, const std::string& problem,
                                                         dds::WireArena& arena) {
  return MakeResult(static_cast<std::uint8_t>(code), problem, arena);
}
// Of a request that was carried out or not.
inline simulation_interfaces_msg_dds__Result_ MakeResult(const ControlReply& reply, dds::WireArena& arena) {
  return MakeResult(reply.done ? ResultCode::kOk : ResultCode::kOperationFailed, reply.problem, arena);
}

// A service that may be gone when an answer is ready. Safe to use from any thread.
template <typename Request, typename Response>
class ServiceSlot {
 public:
  using Service = ros::RosService<Request, Response>;

  void Open(const ros::RosNode& node, const std::string& name, typename Service::Handler handler) {
    auto made = std::make_unique<Service>(node, name, std::move(handler), ros::Service(), ros::Serving::kWhenStarted);
    Service& service = *made;
    {
      const std::lock_guard lock(mutex_);
      service_ = std::move(made);
    }
    service.Start();  // a request may have come already, and its answer goes by the pointer
  }
  // No handler runs any more when it returns.
  void Close() {
    std::unique_ptr<Service> service;
    {
      const std::lock_guard lock(mutex_);
      service.swap(service_);
    }
    // Without the lock, because a handler may be waiting for it.
  }
  void Respond(const ros::RosCaller& caller, Response& response) {
    const std::lock_guard lock(mutex_);
    if (service_) service_->Respond(caller, response);
  }

 private:
  std::mutex mutex_;
  std::unique_ptr<Service> service_;
};

class SimulationContext {
 public:
  // The control must outlive it.
  SimulationContext(const std::shared_ptr<const Scene>& scene, WorldControl& control);

  void ChangeWorld(const std::shared_ptr<const Scene>& scene);
  std::shared_ptr<const Scene> scene() const;

  // What an entity is called in ROS: robots by their namespaces, everything else as in the world.
  std::string RosNameOf(const EntityReport& entity) const;
  // The name in the world of what is called so in ROS.
  std::string NameInWorld(const std::string& ros_name) const;

  // Asks, and calls `answered(self, reply)` unless `self` is gone by then: the answer may come much later.
  template <typename Self, typename Answered>
  void Ask(const ControlRequest& request, std::weak_ptr<Self> weak, Answered answered) const {
    control_.Request(request, [weak = std::move(weak), answered](const ControlReply& reply) {
      if (const auto self = weak.lock()) answered(*self, reply);
    });
  }

 private:
  WorldControl& control_;
  mutable std::mutex mutex_;  // guards the others
  std::shared_ptr<const Scene> scene_;
  std::map<std::string, std::string> ros_names_;    // of robots, by name
  std::map<std::string, std::string> world_names_;  // the other way round
};

}  // namespace troupe
