// SimulationContext: what the services of a run share: its control, its world, and the names of the world's entities in
// ROS. ServiceSet: services of ROS that answer by requests to that control.
//
// All services are asynchronous: a handler sends a control request and returns, and the reply of the run answers the
// call, on whatever thread the run replies. So no thread waits, and a call may stay open during a long step. Handlers
// run on the thread of the ROS connection; replies with the lock of the run held, so that they only fill a message.
//
// Names: a robot is called by its namespace in ROS, because that is the name its topics have; any other entity by its
// name in the world file.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/text.h"
#include "common/spatial/scene.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/connection/topic_types.h"
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

// A result of the services about the loaded world.
inline constexpr std::uint8_t kNoWorldLoaded = 101;

// The problem of a request that would wait for the end of steps that another request has asked for.
inline constexpr const char* kIsStepping = "the run is making the steps of another request";

// The problem of a call that the world service before has not answered.
inline constexpr const char* kServiceHasDied = "the world service has died and returned; the call may have had effect";

// `code`: of ResultCode, or one that a service adds, from 101 on. The problem is cut: it may have texts of the request.
inline simulation_interfaces_msg_dds__Result_ MakeResult(std::uint8_t code, std::string_view problem,
                                                         dds::WireArena& arena) {
  constexpr std::size_t kMaxProblem = 4000;  // bytes
  return {code, arena.Copy(CutUtf8(problem, kMaxProblem))};
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

// Any thread may call it. It is always owned by a shared_ptr: the answer of the run may arrive after the end of the
// services; then it is dropped.
class SimulationContext : public std::enable_shared_from_this<SimulationContext> {
 public:
  // REQUIRES: the control outlives the context.
  SimulationContext(const std::shared_ptr<const Scene>& scene, WorldControl& control);

  void ChangeWorld(const std::shared_ptr<const Scene>& scene);

  std::shared_ptr<const Scene> scene() const;
  // False after the world was unloaded, until another one is loaded.
  bool has_world() const { return !scene()->world().models.empty(); }

  // A robot's name in ROS is its namespace; all other entities have their names of the world.
  std::string RosNameOf(const EntityReport& entity) const;

  // As SetInfo has set it; otherwise by the kind and type of the entity, without tags.
  EntityInfo InfoOf(const EntityReport& entity) const;
  void SetInfo(const EntityReport& entity, EntityInfo info);

  // Sends the request and calls `answered(context, reply)`, on any thread.
  template <typename Answered>
  void Ask(const control::Request& request, Answered answered) {
    control_.Request(request, [weak = weak_from_this(), answered](const ControlReply& reply) {
      if (const auto self = weak.lock()) answered(*self, reply);
    });
  }
  // As Ask, with a request to step.
  template <typename Answered>
  void AskToStep(std::uint64_t ticks, Answered answered) {
    ++steps_;
    Ask(control::Step{ticks}, [answered](SimulationContext& self, const ControlReply& reply) {
      --self.steps_;
      answered(self, reply);
    });
  }
  // A request to step is not answered yet: the run answers no edit before it.
  bool is_stepping() const { return steps_.load() > 0; }

  // Calls `respond(context, reply, entity)` with the entity of this name in ROS; null if there is none.
  template <typename Respond>
  void FindEntity(const std::string& ros_name, Respond respond, bool with_boxes = false) {
    Ask(control::Entities{.with_boxes = with_boxes},
        [ros_name, respond](SimulationContext& self, const ControlReply& reply) {
          for (const EntityReport& entity : reply.entities) {
            if (self.RosNameOf(entity) == ros_name) return respond(self, reply, &entity);
          }
          respond(self, reply, nullptr);
        });
  }

  std::atomic<std::int64_t> stopped_edition = -1;  // of the world after the last stop; -1: none yet

 private:
  WorldControl& control_;
  std::atomic<int> steps_ = 0;  // requests that are not answered yet
  mutable std::mutex mutex_;    // guards the members below
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

// A call of a service, which is answered once, at any time: without effect after the end of the service.
template <typename Request, typename Response>
class Call {
 public:
  using Slot = ServiceSlot<Request, Response>;

  Call(std::shared_ptr<Slot> slot, const ros::RosCaller& caller) : slot_(std::move(slot)), caller_(caller) {}

  void Respond(Response& response) const { slot_->Respond(caller_, response); }
  // A response that is no more than its result.
  template <typename Code>
  void Answer(Code code, const std::string& problem) const {
    dds::WireArena arena;
    Response response{};
    response.result = MakeResult(code, problem, arena);
    Respond(response);
  }
  void Answer(const ControlReply& reply) const { Answer(CodeOf(reply), reply.problem); }

 private:
  std::shared_ptr<Slot> slot_;
  ros::RosCaller caller_;
};

class ServiceSet {
 public:
  // `prefix`: of the services' names, with a slash at its end.
  ServiceSet(ros::RosNode node, std::string prefix, std::shared_ptr<SimulationContext> context)
      : node_(std::move(node)), prefix_(std::move(prefix)), context_(std::move(context)) {}
  // No service answers after it returns.
  ~ServiceSet() {
    for (const auto& close : closers_) close();
  }
  ServiceSet(const ServiceSet&) = delete;
  ServiceSet& operator=(const ServiceSet&) = delete;

  bool has_interfaces_2() const { return ros::HasSimulationInterfaces2(node_.connection->distribution()); }

  // `name`: of the service; one that begins with a slash has no prefix.
  template <typename Request, typename Response>
  void Add(const std::string& name,
           void (*handle)(SimulationContext& context, const Call<Request, Response>& call, const Request& request)) {
    auto slot = std::make_shared<ServiceSlot<Request, Response>>();
    closers_.push_back([slot] { slot->Close(); });
    slot->Open(
        node_, name.starts_with("/") ? name : prefix_ + name,
        [handle, context = context_, weak = std::weak_ptr(slot)](const ros::RosCaller& caller, const Request& request) {
          const Call<Request, Response> call(weak.lock(), caller);
          if (!caller.is_repeated) return handle(*context, call, request);
          // It was executed perhaps, and is not a second time.
          if constexpr (requires { Response().result.result; }) {
            call.Answer(ResultCode::kOperationFailed, kServiceHasDied);
          } else {
            Response response{};
            call.Respond(response);
          }
        });
  }

 private:
  const ros::RosNode node_;
  const std::string prefix_;
  const std::shared_ptr<SimulationContext> context_;
  std::vector<std::function<void()>> closers_;
};

// The types of a service of package simulation_interfaces, and a call of it.
#define TROUPE_SIMULATION_SERVICE(Name)                                     \
  using Name##Request = simulation_interfaces_srv_dds__##Name##_Request_;   \
  using Name##Response = simulation_interfaces_srv_dds__##Name##_Response_; \
  using Name##Call = Call<Name##Request, Name##Response>

// The services of package simulation_interfaces, by subject, and std_srvs/Empty /reset.
void AddRunServices(ServiceSet& services);
void AddWorldServices(ServiceSet& services);
void AddEntityQueries(ServiceSet& services);
void AddEntityEdits(ServiceSet& services);

// Success if the entity was found.
inline simulation_interfaces_msg_dds__Result_ MakeFound(const EntityReport* entity, const std::string& ros_name,
                                                        dds::WireArena& arena) {
  if (entity != nullptr) return MakeResult(ResultCode::kOk, "", arena);
  return MakeResult(ResultCode::kNotFound, "no entity '" + ros_name + "'", arena);
}

}  // namespace troupe
