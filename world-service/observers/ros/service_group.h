// ServiceGroup<Self>: the base of a class that answers requests of ROS by requests to the control of the run. The
// answer may arrive after the end of the group; then it is dropped. So a group is always owned by a shared_ptr.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "ros/connection/ros_service.h"
#include "world-service/observers/ros/service_result.h"
#include "world-service/observers/ros/simulation_context.h"

namespace troupe {

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
