#include "world-service/observers/ros/ros_world_gateway.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "common/base/print.h"
#include "ros/connection/clock_output.h"
#include "ros/connection/parameter_services.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_log.h"
#include "ros/connection/ros_qos.h"
#include "ros/connection/type_description_service.h"
#include "ros/link/host_connection.h"
#include "ros/messages/convert.h"
#include "ros/messages/convert_world.h"
#include "ros/messages/messages.h"
#include "ros/messages/robot_in_ros.h"
#include "transport/dds/binding/wire.h"
#include "world-service/observers/ros/pose_commands.h"
#include "world-service/observers/ros/simulation_services.h"
#include "world-service/observers/ros/world_pictures.h"
#include "world-service/service/event_text.h"

namespace troupe {
namespace {

constexpr std::int32_t kEventDepth = 100;
constexpr const char* kNodeName = "world";

class RosWorldGateway final : public RunObserver {
 public:
  RosWorldGateway(const ros::RosOptions& options, std::shared_ptr<const Scene> scene)
      : options_(options),
        scene_(std::move(scene)),
        connection_(options.network.distribution, options.socket, options.network.domain,
                    ros::HostConnection::Sending::kAtOnce),
        node_(ros::MakeNode(connection_, "/", kNodeName)),
        clock_(node_, options.world.clock_rate),
        events_(node_, "/events", ros::Stream(kEventDepth)),
        objects_(node_, "/objects", ros::Latched()),
        pictures_(node_, options, scene_),
        parameters_(node_, kNodeName, ros::Parameters{{"use_sim_time", true}, {"world", scene_->world().name}}),
        type_descriptions_(node_, kNodeName),
        log_(node_) {
    connection_.Announce();
  }

  Status OnBegin(const RunStart& start) override {
    ExchangeServices(std::make_unique<SimulationServices>(node_, kNodeName, scene_, start.control));
    connection_.Announce();
    ReportNames();
    if (options_.pose_topics.goals || options_.pose_topics.poses) {
      poses_.emplace(connection_, options_, scene_, start.control, [this](const std::string& text) { Warn(text); });
    }
    return Status();
  }
  Status OnEnd() override {
    poses_.reset();
    ExchangeServices(nullptr);
    return Status();
  }

  void OnWorldChange(const std::shared_ptr<const Scene>& scene, Edition) override {
    scene_ = scene;
    shown_objects_.clear();
    objects_replaced_ = true;
    pictures_.ChangeWorld(scene);
    if (poses_) poses_->ChangeWorld(scene);
    ReportNames();
    const std::lock_guard lock(mutex_);
    if (simulation_) simulation_->ChangeWorld(scene);
  }

  Status OnTick(const CommittedTick& tick) override {
    const FrameMessage& frame = tick.frame;
    {
      const std::lock_guard lock(mutex_);
      if (simulation_) simulation_->Publish(frame);
    }
    clock_.Show(frame.state.tick, scene_->world().interval_ns, frame.paused || frame.last);
    if (!frame.events.empty() && events_.wanted()) {
      for (const Event& event : frame.events) {
        dds::WireArena arena;
        events_.Write({arena.Copy(EventLine(scene_->world(), event))});
      }
    }
    // In a pause even without a reader, for one that comes before the next tick.
    const bool is_wanted = objects_.wanted() || frame.paused;
    if (is_wanted && (objects_replaced_ || frame.state.objects != shown_objects_)) {
      shown_objects_ = frame.state.objects;
      dds::WireArena arena;
      objects_.Write(ros::MakeObjectMarkers(*scene_, frame.state, arena, std::exchange(objects_replaced_, false)));
    }
    return Status();
  }

  void OnNotice(const std::string& text) override {
    const std::lock_guard lock(log_mutex_);
    log_.Write(ros::LogLevel::kInfo, "/world", text);
  }

 private:
  void Warn(const std::string& text) {
    PrintPlain(stderr, "ROS: {}\n", text);
    const std::lock_guard lock(log_mutex_);
    log_.Write(ros::LogLevel::kWarning, "/world", text);
  }
  // Each notice once.
  void ReportNames() {
    for (const std::string& notice : ros::NoticesOfNames(scene_->world(), options_.network.domain, options_.names)) {
      if (told_names_.insert(notice).second) Warn(notice);
    }
  }

  // Replaces the services, and ends the ones before.
  void ExchangeServices(std::unique_ptr<SimulationServices> services) {
    {
      const std::lock_guard lock(mutex_);
      services.swap(simulation_);
    }
    services.reset();  // without the lock: their requests may be waiting for a world that is being changed
  }

  const ros::RosOptions options_;
  std::shared_ptr<const Scene> scene_;
  ros::HostConnection connection_;
  ros::RosNode node_;
  ros::ClockOutput clock_;
  ros::RosWriter<ros::String> events_;
  ros::RosWriter<ros::MarkerArray> objects_;
  std::vector<ObjectState> shown_objects_;
  std::set<std::string> told_names_;
  bool objects_replaced_ = false;  // viewers may show markers of the world before
  WorldPictures pictures_;
  ros::ParameterServices parameters_;
  ros::TypeDescriptionService type_descriptions_;
  std::mutex log_mutex_;
  ros::RosLog log_;
  std::optional<PoseCommands> poses_;               // between OnBegin and OnEnd, if the options ask for it
  std::mutex mutex_;                                // guards the pointer
  std::unique_ptr<SimulationServices> simulation_;  // between OnBegin and OnEnd
};

}  // namespace

std::unique_ptr<RunObserver> MakeRosWorldGateway(const ros::RosOptions& options, std::shared_ptr<const Scene> scene) {
  return std::make_unique<RosWorldGateway>(options, std::move(scene));
}

}  // namespace troupe
