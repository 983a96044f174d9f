// ServiceGroup: the base of the classes that answer requests of ROS by requests to the control of the run, and the
// results in their responses.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "common/spatial/scene.h"
#include "ros/connection/ros_service.h"
#include "ros/connection/simulation_types.h"
#include "transport/dds/binding/wire.h"
#include "transport/protocol/messages.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// The codes of simulation_interfaces/msg/Result.
enum class ResultCode : std::uint8_t {
  kUnsupported = 0,
  kOk = 1,
  kNotFound = 2,
  kIncorrectState = 3,
  kOperationFailed = 4,
};

// Of the services about the loaded world.
inline constexpr std::uint8_t kNoWorldLoaded = 101;

// `code`: of ResultCode, or one that a service adds, from 101 on.
inline simulation_interfaces_msg_dds__Result_ MakeResult(std::uint8_t code, const std::string& problem,
                                                         dds::WireArena& arena) {
  return {code, arena.Copy(problem)};
}
inline simulation_interfaces_msg_dds__Result_ MakeResult(ResultCode code, const std::string& problem,
                                                         dds::WireArena& arena) {
  return MakeResult(static_cast<std::uint8_t>(code), problem, arena);
}

inline ResultCode CodeOf(const ControlReply& reply) {
  return reply.done ? ResultCode::kOk : ResultCode::kOperationFailed;
}
inline simulation_interfaces_msg_dds__Result_ MakeResult(const ControlReply& reply, dds::WireArena& arena) {
  return MakeResult(CodeOf(reply), reply.problem, arena);
}

// What simulation_interfaces calls the info of an entity. It changes no result.
struct EntityInfo {
  std::uint8_t category = 0;
  std::string description;
  std::vector<std::string> tags;
};

// The state that the groups share: the control of the run, its world, and the names of the world's entities in ROS. Any
// thread may call it.
class SimulationContext {
 public:
  // REQUIRES: the control outlives the context and every group of services that uses it.
  SimulationContext(const std::shared_ptr<const Scene>& scene, WorldControl& control);

  void ChangeWorld(const std::shared_ptr<const Scene>& scene);

  WorldControl& control() const { return control_; }
  std::shared_ptr<const Scene> scene() const;
  // False after the world was unloaded, until another one is loaded.
  bool has_world() const { return !scene()->world().models.empty(); }

  // A robot's name in ROS is its namespace; the names of all other entities are those of the world.
  std::string RosNameOf(const EntityReport& entity) const;

  // As SetInfo has set it; otherwise by the kind and type of the entity, without tags.
  EntityInfo InfoOf(const EntityReport& entity) const;
  void SetInfo(const EntityReport& entity, EntityInfo info);

 private:
  WorldControl& control_;
  mutable std::mutex mutex_;  // guards the members below
  std::shared_ptr<const Scene> scene_;
  std::map<std::string, std::string> ros_names_;  // of robots, by their name in the world
  std::map<std::string, EntityInfo> infos_;       // that were set, by the name in the world
};

// A ROS service that can be closed while requests still wait for their answer. Any thread may call it.
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
    service.Start();  // after the assignment: a waiting request is handled at once, and answers through the slot
  }
  // No handler runs after it returns.
  void Close() {
    std::unique_ptr<Service> service;
    {
      const std::lock_guard lock(mutex_);
      service.swap(service_);
    }
    // The service ends without the lock: a running handler may be waiting for the lock.
  }
  // Sends the response, unless the slot is closed.
  void Respond(const ros::RosCaller& caller, Response& response) {
    const std::lock_guard lock(mutex_);
    if (service_) service_->Respond(caller, response);
  }

 private:
  std::mutex mutex_;
  std::unique_ptr<Service> service_;
};

// The answer of the run may arrive after the end of the group; then it is dropped. So a group is always owned by a
// shared_ptr.
template <typename Self>
class ServiceGroup : public std::enable_shared_from_this<Self> {
 protected:
  explicit ServiceGroup(std::shared_ptr<SimulationContext> context) : context_(std::move(context)) {}

  SimulationContext& context() const { return *context_; }

  // A service's handler that calls a member function of Self.
  template <typename Method>
  auto Bind(Method method) {
    return [self = static_cast<Self*>(this), method](const ros::RosCaller& caller, const auto& request) {
      (self->*method)(caller, request);
    };
  }

  // Sends the request and calls `answered(self, reply)`, on any thread.
  template <typename Answered>
  void Ask(const ControlRequest& request, Answered answered) {
    context_->control().Request(request, [weak = this->weak_from_this(), answered](const ControlReply& reply) {
      if (const auto self = weak.lock()) answered(*self, reply);
    });
  }
  template <typename Answered>
  void Ask(ControlCommand command, Answered answered) {
    ControlRequest request;
    request.command = command;
    Ask(request, std::move(answered));
  }

  // Calls `respond(self, reply, entity)` with the entity of this name in ROS; null if there is none.
  template <typename Respond>
  void FindEntity(const std::string& ros_name, Respond respond) {
    Ask(ControlCommand::kEntities, [ros_name, respond](Self& self, const ControlReply& reply) {
      for (const EntityReport& entity : reply.entities) {
        if (self.context().RosNameOf(entity) == ros_name) return respond(self, reply, &entity);
      }
      respond(self, reply, nullptr);
    });
  }

 private:
  const std::shared_ptr<SimulationContext> context_;
};

// Success if the entity was found.
inline simulation_interfaces_msg_dds__Result_ MakeFound(const EntityReport* entity, const std::string& ros_name,
                                                        dds::WireArena& arena) {
  if (entity != nullptr) return MakeResult(ResultCode::kOk, "", arena);
  return MakeResult(ResultCode::kNotFound, "no entity '" + ros_name + "'", arena);
}

}  // namespace troupe
