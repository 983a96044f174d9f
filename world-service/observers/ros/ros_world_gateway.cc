#include "world-service/observers/ros/ros_world_gateway.h"

#include <fmt/format.h>

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <exception>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "common/base/print.h"
#include "ros/connection/node_services.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/world_topics.h"
#include "ros/link/host_connection.h"
#include "ros/messages/convert.h"
#include "ros/messages/messages.h"
#include "ros/messages/names.h"
#include "ros/messages/robot_frames.h"
#include "transport/dds/binding/wire.h"
#include "world-service/observers/ros/building_topics.h"
#include "world-service/observers/ros/pose_commands.h"
#include "world-service/observers/ros/rmf_topics.h"
#include "world-service/observers/ros/ros_lockstep.h"
#include "world-service/observers/ros/run_services.h"
#include "world-service/observers/ros/simulation_context.h"
#include "world-service/service/event_log.h"

namespace troupe {
namespace {

// SimulationServices: the services and the action of package simulation_interfaces, and std_srvs/Empty /reset, all over
// the control of one run. docs/ros2.md lists them.
class SimulationServices {
 public:
  // `name`: the node's, in the service names. REQUIRES: the control outlives the services.
  SimulationServices(const ros::RosNode& node, const std::string& name, const std::shared_ptr<const Scene>& scene,
                     WorldControl& control);
  // After it no call into the control runs; open requests are dropped.
  ~SimulationServices() = default;

  // An edit has replaced the world.
  void ChangeWorld(const std::shared_ptr<const Scene>& scene);
  // Reports a committed tick to the action.
  void Publish(const FrameMessage& frame) { step_action_.Publish(frame); }

 private:
  std::shared_ptr<SimulationContext> context_;  // shared with requests that wait for their answer
  ServiceSet services_;
  StepAction step_action_;
};

SimulationServices::SimulationServices(const ros::RosNode& node, const std::string& name,
                                       const std::shared_ptr<const Scene>& scene, WorldControl& control)
    : context_(std::make_shared<SimulationContext>(scene, control)),
      services_(node, name + "/", context_),
      step_action_(node, name + "/simulate_steps", context_) {
  AddRunServices(services_);
  AddWorldServices(services_);
  AddEntityQueries(services_);
  AddEntityEdits(services_);
}

void SimulationServices::ChangeWorld(const std::shared_ptr<const Scene>& scene) {
  context_->ChangeWorld(scene);
}

// WorldPictures: the large topics of the world, which are sent once: the map and the markers of the blocks. A thread of
// its own makes them as soon as they have a reader, so that no tick waits for them, and a paused run sends them too.
class WorldPictures {
 public:
  // `map`: the name of the occupancy grid.
  WorldPictures(const ros::RosNode& node, const ros::RosOptions& options, std::shared_ptr<const Scene> scene,
                const char* map);
  ~WorldPictures();

  // An edit has replaced the world: both topics are sent again.
  void ChangeWorld(std::shared_ptr<const Scene> scene);

 private:
  void Run();
  void WriteBlocks(const Scene& scene, bool replaces);

  const ros::RosOptions options_;
  ros::RosWriter<ros::OccupancyGridMessage> map_;
  ros::RosWriter<ros::MarkerArray> blocks_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  std::shared_ptr<const Scene> scene_;
  bool map_written_ = false;
  bool blocks_written_ = false;
  bool blocks_replaced_ = false;  // viewers may show markers of the world before
  std::thread thread_;            // last, because it uses all other members
};

constexpr auto kPeriod = std::chrono::milliseconds(100);

WorldPictures::WorldPictures(const ros::RosNode& node, const ros::RosOptions& options,
                             std::shared_ptr<const Scene> scene, const char* map)
    : options_(options),
      map_(node, map, ros::Latched()),
      blocks_(node, "/blocks", ros::Latched()),
      scene_(std::move(scene)),
      thread_([this] { Run(); }) {}

WorldPictures::~WorldPictures() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void WorldPictures::ChangeWorld(std::shared_ptr<const Scene> scene) {
  {
    const std::lock_guard lock(mutex_);
    scene_ = std::move(scene);
    blocks_replaced_ = blocks_replaced_ || blocks_written_;
    map_written_ = blocks_written_ = false;
  }
  wake_.notify_one();
}

void WorldPictures::Run() {
  std::unique_lock lock(mutex_);
  while (!stop_) {
    const std::shared_ptr<const Scene> scene = scene_;
    // Marked as written before it is, so that an edit meanwhile clears the mark and has it sent again.
    const bool map_due = !std::exchange(map_written_, map_written_ || map_.wanted()) && map_written_;
    const bool blocks_due = !std::exchange(blocks_written_, blocks_written_ || blocks_.wanted()) && blocks_written_;
    const bool replaces = blocks_replaced_;
    lock.unlock();
    bool all_written = true;
    try {
      if (map_due) ros::WriteMap(map_, *scene, options_.world);
      if (blocks_due) WriteBlocks(*scene, replaces);
    } catch (const std::exception&) {  // as without memory: after the next period
      all_written = false;
    }
    lock.lock();
    if (!all_written && scene == scene_) {
      map_written_ = map_written_ && !map_due;
      blocks_written_ = blocks_written_ && !blocks_due;
    }
    const auto changed = [&] { return stop_ || scene_ != scene; };
    if (map_written_ && blocks_written_) {
      wake_.wait(lock, changed);
    } else {
      wake_.wait_for(lock, kPeriod, changed);
    }
  }
}

void WorldPictures::WriteBlocks(const Scene& scene, bool replaces) {
  std::vector<std::vector<std::string>> frames;
  // Namespaced frames are in separate trees, and so are those in other domains.
  for (std::size_t i = 0; i < scene.world().robots.size() && !options_.names.namespaced_tf; ++i) {
    const ros::RobotInRos robot =
        ros::FindRobotInRos(scene.world(), RobotId(i), options_.network.domain, options_.names);
    frames.emplace_back();
    if (!robot.alone) frames.back() = ros::RobotFramesOf(scene, RobotId(i), robot.frames).links;
  }
  dds::WireArena arena;
  blocks_.Write(ros::MakeBlockMarkers(scene, frames, arena, replaces));
}

constexpr std::int32_t kEventDepth = 100;
constexpr std::int32_t kPeopleDepth = 10;
constexpr const char* kNodeName = "world";

class RosWorldGateway final : public RunObserver {
 public:
  RosWorldGateway(const ros::RosOptions& options, RunInRos run)
      : options_(options),
        has_released_(run.has_released),
        scene_(std::move(run.scene)),
        connection_(options.network.distribution, options.socket, options.network.domain,
                    ros::HostConnection::Sending::kAtOnce),
        node_(ros::MakeNode(connection_, "/", kNodeName)),
        clock_(node_, options.world.clock_rate),
        events_(node_, "/events", ros::Stream(kEventDepth)),
        objects_(node_, "/objects", ros::Latched()),
        pictures_(node_, options, scene_, run.site && options.world.building_map ? "/occupancy_grid" : "/map"),
        parameters_(node_, kNodeName, ros::Parameters{{"use_sim_time", true}, {"world", scene_->world().name}}),
        type_descriptions_(node_, kNodeName),
        log_(node_) {
    if (run.site) {
      building_.emplace(node_, options.world.building_map ? "/map" : "/building_map", std::move(run.site),
                        run.site_world, run.files, scene_->world(), [this](const std::string& text) { Warn(text); });
    }
    FollowPeople();
    connection_.Announce();
  }

  Status OnBegin(const RunStart& start) override {
    // Not before OnBegin: earlier there is no run that could answer.
    ExchangeServices(std::make_unique<SimulationServices>(node_, kNodeName, scene_, start.control));
    connection_.Announce();
    ReportNames();
    if (options_.pose_topics.goals || options_.pose_topics.poses) {
      poses_.emplace(connection_, options_, scene_, start.control, [this](const std::string& text) { Warn(text); });
    }
    const bool waits = !options_.lockstep.names.empty();
    rmf_.emplace(node_, scene_, start.control,
                 waits ? RmfWorkcells::Results::kWithTicks : RmfWorkcells::Results::kAtOnce,
                 [this](const std::string& text) { Warn(text); });
    const auto on_arrival = [this, &control = start.control] {
      if (rmf_->ConsumeArrival()) control.Wake();
    };
    if (!waits) {
      connection_.WatchTopics(on_arrival);
      return Status();
    }
    lockstep_.emplace(
        connection_, options_, scene_, start.run, has_released_, start.control,
        RosLockstepWait::Hooks{[this](Tick tick, std::int64_t interval_ns) { clock_.Show(tick, interval_ns, true); },
                               [this](const std::string& line) { Warn(line); }, on_arrival});
    // A service before has armed the texts of its last ticks, whose messages count.
    if (!has_released_) lockstep_->AwaitPrepared();
    return Status();
  }
  Status OnEnd() override {
    poses_.reset();
    if (lockstep_) slowest_awaited_ = lockstep_->SlowestAwaited();
    lockstep_.reset();
    connection_.WatchTopics({});
    rmf_.reset();
    ExchangeServices(nullptr);
    return Status();
  }

  void OnWorldChange(const std::shared_ptr<const Scene>& scene, Edition) override {
    scene_ = scene;
    shown_objects_.clear();
    objects_replaced_ = true;
    pictures_.ChangeWorld(scene);
    if (building_) building_->ChangeWorld(scene->world());
    if (FollowPeople()) connection_.Announce();
    if (poses_) poses_->ChangeWorld(scene);
    if (rmf_) rmf_->ChangeWorld(scene);
    if (lockstep_) lockstep_->OnWorldChange(scene);
    ReportNames();
    const std::lock_guard lock(mutex_);
    if (simulation_) simulation_->ChangeWorld(scene);
  }

  bool ShowsTick(Tick tick) override { return lockstep_ && lockstep_->ShowsTick(tick); }
  Status OnCommit(const CommittedTick& tick, const RunProgress&) override {
    const bool awaits_nodes = tick.frame.paused && ShowsTick(tick.frame.state.tick);
    if (rmf_) rmf_->OnCommit(tick.frame, awaits_nodes);
    if (lockstep_) lockstep_->OnCommit(tick.frame);
    return Status();
  }
  Status OnShown(const FrameMessage& frame) override {
    if (lockstep_) lockstep_->OnShown(frame);
    return Status();
  }
  Status OnWake() override {
    if (rmf_) rmf_->OnWake();
    return Status();
  }
  // The requests that came before the last answer are edits of the shown tick.
  Result<TickRelease> Release() override {
    if (!lockstep_) return TickRelease{};
    Result<TickRelease> release = lockstep_->Release();
    if (!release.ok() || !release.value().is_released || !rmf_ || rmf_->Settle()) return release;
    return TickRelease{false, {"requests of Open-RMF"}};
  }
  bool IsPrepared() override { return !lockstep_ || lockstep_->IsPrepared(); }
  std::vector<SlowRobot> SlowestAwaited() override {
    return lockstep_ ? lockstep_->SlowestAwaited() : std::move(slowest_awaited_);
  }

  Status OnTick(const CommittedTick& tick) override {
    const FrameMessage& frame = tick.frame;
    if (rmf_) rmf_->OnTick(frame);
    {
      const std::lock_guard lock(mutex_);
      if (simulation_) simulation_->Publish(frame);
    }
    // The time of a tick that waits for ROS follows all its messages.
    const bool waits = frame.paused && ShowsTick(frame.state.tick);
    if (!waits) clock_.Show(frame.state.tick, scene_->world().interval_ns, frame.paused || frame.last);
    if (!frame.events.empty() && events_.wanted()) {
      for (const Event& event : frame.events) {
        dds::WireArena arena;
        events_.Write({arena.Copy(EventLine(scene_->world(), event))});
      }
    }
    // In a pause even without a reader, as below.
    if (people_ && (people_->wanted() || frame.paused)) {
      dds::WireArena arena;
      people_->Write(ros::MakePeople(scene_->world(), frame.state, arena));
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
  // The topic of people, from the first world with some on. Whether it is new.
  bool FollowPeople() {
    if (people_ || scene_->world().people.empty()) return false;
    people_.emplace(node_, "/people", ros::Stream(kPeopleDepth));
    return true;
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
  const bool has_released_;
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
  std::optional<BuildingTopics> building_;                    // of a building
  std::optional<ros::RosWriter<ros::PeopleMessage>> people_;  // of a world with people
  ros::ParameterServices parameters_;
  ros::TypeDescriptionService type_descriptions_;
  std::mutex log_mutex_;
  ros::RosLog log_;
  std::optional<RosLockstepWait> lockstep_;         // between OnBegin and OnEnd, if ticks wait for ROS
  std::vector<SlowRobot> slowest_awaited_;          // of a lockstep that has ended
  std::optional<RmfTopics> rmf_;                    // between OnBegin and OnEnd
  std::optional<PoseCommands> poses_;               // between OnBegin and OnEnd, if the options ask for it
  std::mutex mutex_;                                // guards the pointer
  std::unique_ptr<SimulationServices> simulation_;  // between OnBegin and OnEnd
};

}  // namespace

std::unique_ptr<RunObserver> MakeRosWorldGateway(const ros::RosOptions& options, RunInRos run) {
  return std::make_unique<RosWorldGateway>(options, std::move(run));
}

}  // namespace troupe
