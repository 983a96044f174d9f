#include "world-service/ros/ros_world_gateway.h"

#include <memory>
#include <mutex>
#include <utility>

#include "common/ros/convert.h"
#include "common/ros/convert_world.h"
#include "common/ros_dds/parameter_services.h"
#include "common/ros_dds/ros_endpoints.h"
#include "common/ros_dds/ros_qos.h"
#include "world-service/ros/simulation_services.h"
#include "world-service/ros/world_pictures.h"

namespace troupe {
namespace {

constexpr std::int32_t kClockDepth = 10;
constexpr std::int32_t kEventDepth = 100;
constexpr const char* kNodeName = "world";

class RosWorldGateway final : public WorldGateway {
 public:
  RosWorldGateway(const ros::RosOptions& options, const Scene& scene)
      : options_(options),
        scene_(std::shared_ptr<void>(), &scene),  // the caller's
        participant_(options),
        node_(ros::MakeNode(participant_, "/", kNodeName)),
        clock_(node_, "/clock", ros::Stream(kClockDepth)),
        events_(node_, "/events", ros::Stream(kEventDepth)),
        objects_(node_, "/objects", ros::Latched()),
        pictures_(node_, options, scene_),
        parameters_(node_, kNodeName, ros::Parameters{{"use_sim_time", true}, {"world", scene.world().name}}) {
    participant_.Announce();
  }

  void Connect(WorldControl* control) override {
    std::unique_ptr<SimulationServices> simulation;
    if (control != nullptr)
      simulation = std::make_unique<SimulationServices>(node_, kNodeName, options_, scene_, *control);
    {
      const std::lock_guard lock(mutex_);
      simulation.swap(simulation_);
    }
    simulation.reset();  // without the lock: its requests may be waiting for a world that is being changed
    if (control != nullptr) participant_.Announce();
  }

  void ChangeWorld(std::shared_ptr<const Scene> scene) override {
    scene_ = scene;
    shown_objects_.clear();
    objects_replaced_ = true;
    pictures_.ChangeWorld(scene);
    const std::lock_guard lock(mutex_);
    if (simulation_) simulation_->ChangeWorld(scene);
  }

  void Publish(const FrameMessage& frame) override {
    {
      const std::lock_guard lock(mutex_);
      if (simulation_) simulation_->Publish(frame);
    }
    if (clock_.wanted()) clock_.Write({ros::ToTime(frame.state.tick, scene_->world().interval_ns)});
    if (!frame.events.empty() && events_.wanted()) {
      for (const Event& event : frame.events) {
        dds::WireArena arena;
        events_.Write({arena.Copy(ros::EventJson(scene_->world(), event))});
      }
    }
    if ((objects_replaced_ || frame.state.objects != shown_objects_) && objects_.wanted()) {
      shown_objects_ = frame.state.objects;
      dds::WireArena arena;
      objects_.Write(ros::MakeObjectMarkers(*scene_, frame.state, arena, std::exchange(objects_replaced_, false)));
    }
  }

 private:
  const ros::RosOptions options_;
  std::shared_ptr<const Scene> scene_;
  ros::RosParticipant participant_;
  ros::RosNode node_;
  ros::RosWriter<ros::Clock> clock_;
  ros::RosWriter<ros::String> events_;
  ros::RosWriter<ros::MarkerArray> objects_;
  std::vector<ObjectState> shown_objects_;
  bool objects_replaced_ = false;  // there may be markers of another world
  WorldPictures pictures_;
  ros::ParameterServices parameters_;
  std::mutex mutex_;                                // guards the pointer
  std::unique_ptr<SimulationServices> simulation_;  // while there is a control
};

}  // namespace

MakeWorldGateway MakeRosWorldGateway(const ros::RosOptions& options) {
  return [options](const Scene& scene) -> std::unique_ptr<WorldGateway> {
    return std::make_unique<RosWorldGateway>(options, scene);
  };
}

}  // namespace troupe
