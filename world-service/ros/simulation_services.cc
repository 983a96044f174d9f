#include "world-service/ros/simulation_services.h"

#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "common/ros/convert.h"
#include "common/ros/names.h"
#include "common/ros_dds/ros_service.h"

namespace troupe {
namespace {

using ros::RosCaller;
using ros::RosService;

enum class ResultCode : std::uint8_t {
  kUnsupported = 0,
  kOk = 1,
  kNotFound = 2,
  kIncorrectState = 3,
  kOperationFailed = 4,
  kAlreadyInTargetState = 101,  // of SetSimulationState
};

// As in SimulationState.
constexpr std::uint8_t kStopped = 0;
constexpr std::uint8_t kPlaying = 1;
constexpr std::uint8_t kPaused = 2;
constexpr std::uint8_t kQuitting = 3;

// As in SimulatorFeatures: getting states and entities' states, pausing, one step, several.
constexpr std::uint16_t kFeatures[] = {10, 24, 25, 26, 31, 32};

simulation_interfaces_msg_dds__Result_ MakeResult(ResultCode code, const std::string& problem, dds::WireArena& arena) {
  return {static_cast<std::uint8_t>(code), arena.Copy(problem)};
}

std::uint8_t ToState(RunState state) {
  switch (state) {
    case RunState::kStarting:
      return kStopped;
    case RunState::kPlaying:
      return kPlaying;
    case RunState::kPaused:
      return kPaused;
    case RunState::kOver:
      return kQuitting;
  }
  return kStopped;
}

}  // namespace

class SimulationServices::Services : public std::enable_shared_from_this<Services> {
 public:
  Services(const Scene& scene, WorldControl& control) : scene_(scene), control_(control) {
    const WorldDescription& world = scene.world();
    const std::vector<std::string> names = ros::RobotNames(world);
    for (std::size_t i = 0; i < names.size(); ++i) robots_[names[i]] = i;
  }

  void Open(const ros::RosNode& node, const std::string& name) {
    const std::string prefix = name + "/";
    const auto bind = [this](auto method) {
      return [this, method](const RosCaller& caller, const auto& request) { (this->*method)(caller, request); };
    };
    Keep(features_, std::make_unique<Features>(node, prefix + "get_simulator_features", bind(&Services::GetFeatures)));
    Keep(get_state_, std::make_unique<GetState>(node, prefix + "get_simulation_state", bind(&Services::OnGetState)));
    Keep(set_state_, std::make_unique<SetState>(node, prefix + "set_simulation_state", bind(&Services::OnSetState)));
    Keep(step_, std::make_unique<Step>(node, prefix + "step_simulation", bind(&Services::OnStep)));
    Keep(entities_, std::make_unique<Entities>(node, prefix + "get_entities", bind(&Services::OnGetEntities)));
    Keep(entity_, std::make_unique<Entity>(node, prefix + "get_entity_state", bind(&Services::OnGetEntity)));
  }

  // No service answers any more when it returns.
  void Close() {
    // First the readers, without the lock, because their handlers may be waiting for it.
    auto features = Take(features_);
    auto get_state = Take(get_state_);
    auto set_state = Take(set_state_);
    auto step = Take(step_);
    auto entities = Take(entities_);
    auto entity = Take(entity_);
  }

 private:
  using Features = RosService<simulation_interfaces_srv_dds__GetSimulatorFeatures_Request_,
                              simulation_interfaces_srv_dds__GetSimulatorFeatures_Response_>;
  using GetState = RosService<simulation_interfaces_srv_dds__GetSimulationState_Request_,
                              simulation_interfaces_srv_dds__GetSimulationState_Response_>;
  using SetState = RosService<simulation_interfaces_srv_dds__SetSimulationState_Request_,
                              simulation_interfaces_srv_dds__SetSimulationState_Response_>;
  using Step = RosService<simulation_interfaces_srv_dds__StepSimulation_Request_,
                          simulation_interfaces_srv_dds__StepSimulation_Response_>;
  using Entities = RosService<simulation_interfaces_srv_dds__GetEntities_Request_,
                              simulation_interfaces_srv_dds__GetEntities_Response_>;
  using Entity = RosService<simulation_interfaces_srv_dds__GetEntityState_Request_,
                            simulation_interfaces_srv_dds__GetEntityState_Response_>;

  template <typename Service>
  void Keep(std::unique_ptr<Service>& service, std::unique_ptr<Service> made) {
    const std::lock_guard lock(mutex_);
    service = std::move(made);
  }
  template <typename Service>
  std::unique_ptr<Service> Take(std::unique_ptr<Service>& service) {
    const std::lock_guard lock(mutex_);
    return std::move(service);
  }

  template <typename Service, typename Response>
  void Respond(const std::unique_ptr<Service>& service, const RosCaller& caller, Response& response) {
    const std::lock_guard lock(mutex_);
    if (service) service->Respond(caller, response);
  }

  // Asks, and calls `answered` with the reply unless the services are gone by then: it may come much later.
  template <typename Answered>
  void Ask(ControlCommand command, std::uint64_t ticks, Answered answered) {
    ControlRequest request;
    request.command = command;
    request.ticks = ticks;
    control_.Request(request, [weak = weak_from_this(), answered](const ControlReply& reply) {
      if (const auto self = weak.lock()) answered(*self, reply);
    });
  }

  void GetFeatures(const RosCaller& caller, const simulation_interfaces_srv_dds__GetSimulatorFeatures_Request_&) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__GetSimulatorFeatures_Response_ response{};
    std::uint16_t* feature = arena.Fill(response.features.features, std::size(kFeatures));
    for (const std::uint16_t number : kFeatures) *feature++ = number;
    response.features.custom_info = arena.Copy("Troupe: world " + scene_.world().name);
    Respond(features_, caller, response);
  }

  void OnGetState(const RosCaller& caller, const simulation_interfaces_srv_dds__GetSimulationState_Request_&) {
    Ask(ControlCommand::kStatus, 0, [caller](Services& self, const ControlReply& reply) {
      dds::WireArena arena;
      simulation_interfaces_srv_dds__GetSimulationState_Response_ response{};
      response.state.state = ToState(reply.state);
      response.result = MakeResult(ResultCode::kOk, "", arena);
      self.Respond(self.get_state_, caller, response);
    });
  }

  void AnswerSetState(const RosCaller& caller, ResultCode code, const std::string& problem) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__SetSimulationState_Response_ response{};
    response.result = MakeResult(code, problem, arena);
    Respond(set_state_, caller, response);
  }

  void OnSetState(const RosCaller& caller, const simulation_interfaces_srv_dds__SetSimulationState_Request_& request) {
    const std::uint8_t wanted = request.state.state;
    if (wanted != kPlaying && wanted != kPaused) {
      return AnswerSetState(caller, ResultCode::kUnsupported, "expected the state playing (1) or paused (2)");
    }
    Ask(ControlCommand::kStatus, 0, [caller, wanted](Services& self, const ControlReply& status) {
      self.already_ = ToState(status.state) == wanted;
    });
    if (already_) return AnswerSetState(caller, ResultCode::kAlreadyInTargetState, "it is so already");
    Ask(wanted == kPlaying ? ControlCommand::kPlay : ControlCommand::kPause, 0,
        [caller](Services& self, const ControlReply& reply) {
          self.AnswerSetState(caller, reply.done ? ResultCode::kOk : ResultCode::kOperationFailed, reply.problem);
        });
  }

  void OnStep(const RosCaller& caller, const simulation_interfaces_srv_dds__StepSimulation_Request_& request) {
    Ask(ControlCommand::kStep, request.steps, [caller](Services& self, const ControlReply& reply) {
      dds::WireArena arena;
      simulation_interfaces_srv_dds__StepSimulation_Response_ response{};
      const ResultCode failure =
          reply.state == RunState::kPlaying ? ResultCode::kIncorrectState : ResultCode::kOperationFailed;
      response.result = MakeResult(reply.done ? ResultCode::kOk : failure, reply.problem, arena);
      self.Respond(self.step_, caller, response);
    });
  }

  // Entities are the robots, by their names in ROS, and everything else that can move.
  void OnGetEntities(const RosCaller& caller, const simulation_interfaces_srv_dds__GetEntities_Request_&) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__GetEntities_Response_ response{};
    response.result = MakeResult(ResultCode::kOk, "", arena);
    std::vector<std::string> names;
    for (const auto& [name, robot] : robots_) names.push_back(name);
    for (const ModelId object : scene_.world().objects) names.push_back(scene_.world().model(object).name);
    arena.FillStrings(response.entities, names);
    Respond(entities_, caller, response);
  }

  void OnGetEntity(const RosCaller& caller, const simulation_interfaces_srv_dds__GetEntityState_Request_& request) {
    dds::WireArena arena;
    simulation_interfaces_srv_dds__GetEntityState_Response_ response{};
    const FrameMessage frame = control_.CurrentFrame();
    const std::string name = dds::Text(request.entity);
    const ros::Time stamp = ros::ToTime(frame.state.tick, scene_.world().interval_ns);
    response.state.header = ros::MakeHeader(stamp, ros::kMapFrame, arena);
    response.result = MakeResult(ResultCode::kNotFound, "no entity '" + name + "'", arena);
    if (const auto robot = robots_.find(name); robot != robots_.end()) {
      const RobotState& state = frame.state.robots[robot->second];
      response.state.pose = ros::ToMessage(state.X_WR);
      response.state.twist = ros::ToMessage(state.twist);
      response.result = MakeResult(ResultCode::kOk, "", arena);
    }
    for (std::size_t i = 0; i < frame.state.objects.size(); ++i) {
      if (scene_.world().model(scene_.world().objects[i]).name != name) continue;
      response.state.pose = ros::ToMessage(frame.state.objects[i].X_WO);
      response.result = MakeResult(ResultCode::kOk, "", arena);
    }
    Respond(entity_, caller, response);
  }

  const Scene& scene_;
  WorldControl& control_;
  std::map<std::string, std::size_t> robots_;  // by name in ROS
  bool already_ = false;                       // for OnSetState, whose calls come one at a time
  std::mutex mutex_;                           // guards the pointers
  std::unique_ptr<Features> features_;
  std::unique_ptr<GetState> get_state_;
  std::unique_ptr<SetState> set_state_;
  std::unique_ptr<Step> step_;
  std::unique_ptr<Entities> entities_;
  std::unique_ptr<Entity> entity_;
};

SimulationServices::SimulationServices(const ros::RosNode& node, const std::string& name, const Scene& scene,
                                       WorldControl& control)
    : services_(std::make_shared<Services>(scene, control)) {
  services_->Open(node, name);
}

SimulationServices::~SimulationServices() {
  services_->Close();
}

}  // namespace troupe
