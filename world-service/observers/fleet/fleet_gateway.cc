#include "world-service/observers/fleet/fleet_gateway.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/identity.h"
#include "common/base/json_tree.h"
#include "common/base/text.h"
#include "common/base/wake_event.h"
#include "fleet/codec.h"
#include "fleet/state_message.h"
#include "fleet/vehicle_settings.h"
#include "transport/mqtt/mqtt_connections.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

constexpr char kController[] = "vda5050";
constexpr double kFirstSeconds = 10.0;          // of wall time, as all here: for the broker to accept the vehicles,
constexpr double kFirstSecondsOfVehicle = 0.1;  // and for each of them
constexpr double kClosing = 2.0;                // s
constexpr double kIdle = 0.5;                   // s
constexpr std::size_t kMostQueued = 256;        // messages to a vehicle that wait for ticks
constexpr std::size_t kMostOutgoing = 100'000;  // messages that wait for the thread

// Of the lockstep with a fleet control (docs/vda5050.md).
constexpr char kAskTopic[] = "troupe/lockstep/tick";
constexpr char kAnswerTopic[] = "troupe/lockstep/done";
constexpr char kEcho[] = "echo";  // the last level of the topic of what a vehicle sends itself

double Now() {
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

Clock::time_point In(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

// The vehicles of a world by their robots' names.
Result<std::map<std::string, fleet::VehicleSettings>> VehiclesOf(const WorldDescription& world) {
  std::map<std::string, fleet::VehicleSettings> vehicles;
  std::map<std::string, std::string> robots;  // by topic
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    const RobotDescription& robot = world.robots[i];
    if (robot.controller.name != kController || !RobotExists(world, RobotId(i))) continue;
    Result<fleet::VehicleSettings> settings = fleet::ReadVehicleSettings(robot.controller.parameters, robot.name);
    if (!settings.ok()) return settings.error();
    const auto [other, is_new] = robots.emplace(settings.value().TopicOf(""), robot.name);
    if (!is_new) {
      return Error{{},
                   fmt::format("the vehicles '{}' and '{}' have the same topics {}, expected other serial numbers",
                               other->second, robot.name, other->first)};
    }
    vehicles.emplace(robot.name, std::move(settings).value());
  }
  return vehicles;
}

class FleetGateway final : public RunObserver {
 public:
  FleetGateway(const mqtt::Broker& broker, const AnswerWait& wait, std::function<void(const std::string&)> lines)
      : wait_(wait), connections_(broker, wake_.descriptor()), lines_(std::move(lines)), round_(wait) {}

  ~FleetGateway() override { End(); }

  Status OnBegin(const RunStart& start) override {
    control_ = &start.control;
    robots_ = start.scene;
    interval_ns_ = start.scene->world().interval_ns;
    tick_ = start.tick;
    run_ = start.run;
    incarnation_ = start.incarnation;
    if (wait_.is_lockstep) ListenToAnswers();
    Follow(start.scene->world());
    if (!problem_.empty()) return Failure(problem_);
    thread_ = std::thread([this] { Run(); });
    std::unique_lock lock(mutex_);
    const double seconds = kFirstSeconds + kFirstSecondsOfVehicle * static_cast<double>(vehicles_.size());
    const bool are_connected =
        changed_.wait_until(lock, In(seconds), [this] { return !problem_.empty() || connected_ >= vehicles_.size(); });
    Status status;
    if (!problem_.empty()) {
      status = Failure(problem_);
    } else if (!are_connected) {
      status = Failure(fmt::format("VDA 5050: the broker {} has accepted {} of {} vehicles in {:g} s{}",
                                   connections_.broker().Url(), connected_, vehicles_.size(), seconds,
                                   last_reason_.empty() ? "" : ": " + last_reason_));
    }
    lock.unlock();
    if (!status.ok()) End();  // OnEnd does not follow
    return status;
  }

  Status OnEnd() override {
    End();
    return {};
  }

  Status OnTick(const CommittedTick& tick) override {
    const std::lock_guard lock(mutex_);
    tick_ = tick.frame.state.tick;
    const bool is_first = !std::exchange(has_begun_, true);
    for (auto& [name, queued] : queued_) queued -= std::min(queued, kMaxFleetMessages);
    bool has_message = is_first;  // that vehicles are online
    bool has_state = is_first;
    for (const Proposal& proposal : tick.proposals) {
      for (const FleetMessage& message : proposal.fleet) {
        has_message = true;
        has_state = has_state || message.topic == FleetTopic::kState;
        if (outgoing_.size() < kMostOutgoing) outgoing_.push_back({NameOf(proposal.robot), message});
      }
    }
    if (wait_.is_lockstep ? has_message : has_state) {
      // The agents have no frame of a pause yet: an answer now would reach them a tick earlier than without the pause.
      is_round_due_ = tick.frame.paused;
      if (!is_round_due_) round_.Begin();
    }
    if (is_first || !outgoing_.empty()) wake_.Signal();
    if (problem_.empty()) return {};
    return Failure(problem_);
  }

  // The answers to the states of a tick enter the tick that is committed next.
  bool IsPrepared() override {
    const std::lock_guard lock(mutex_);
    // A service that continues a run has no first tick: the fleet control is asked about the newest one again.
    const bool continues = !std::exchange(has_begun_, true);
    if (std::exchange(is_round_due_, false) || continues) {
      round_.Begin();
      wake_.Signal();
    }
    return round_.is_over();
  }

  void OnWorldChange(const std::shared_ptr<const Scene>& scene, Edition /*edition*/) override {
    const std::lock_guard lock(mutex_);
    robots_ = scene;
    new_world_ = scene;
    wake_.Signal();
  }

 private:
  struct Vehicle {
    fleet::VehicleSettings settings;
    std::size_t client = 0;
    std::uint32_t header_id = 0;  // of the topic connection
    bool is_gone = false;         // its robot was deleted
    std::string factsheet = {};   // the newest one, for a broker that has lost it
  };
  struct Outgoing {
    std::string robot;
    FleetMessage message;
  };

  std::string NameOf(RobotId robot) const { return robots_->world().robot(robot).name; }

  void End() {
    if (!thread_.joinable()) return;
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    wake_.Signal();
    thread_.join();
  }

  // Of the newest tick.
  std::string TimestampOf(const fleet::VehicleSettings& settings) const {
    const double milliseconds = static_cast<double>(tick_) * static_cast<double>(interval_ns_) / 1e6;
    return fleet::FormatTimestamp(settings.epoch_ms + std::llround(milliseconds), settings.version);
  }

  std::string ConnectionText(Vehicle& vehicle, fleet::ConnectionState state) {
    const fleet::VehicleSettings& settings = vehicle.settings;
    fleet::Connection message;
    message.header = {vehicle.header_id++, TimestampOf(settings), fleet::VersionText(settings.version),
                      settings.manufacturer, settings.serial_number};
    message.state = state;
    return fleet::Encode(message, settings.version);
  }

  // Adds the connections of vehicles that are new, and ends those of vehicles that are gone. REQUIRES: on the thread,
  // or before it begins.
  void Follow(const WorldDescription& world) {
    const Result<std::map<std::string, fleet::VehicleSettings>> found = VehiclesOf(world);
    if (!found.ok()) return SetProblem("VDA 5050: " + found.error().message);
    for (auto& [name, vehicle] : vehicles_) {
      const auto now = found.value().find(name);
      if (now == found.value().end() && !std::exchange(vehicle.is_gone, true)) {
        Announce(vehicle, fleet::ConnectionState::kOffline);
      } else if (now != found.value().end() && std::exchange(vehicle.is_gone, false)) {
        Announce(vehicle, fleet::ConnectionState::kOnline);
      }
    }
    for (const auto& [name, settings] : found.value()) {
      if (!vehicles_.contains(name)) Add(name, settings);
    }
  }

  void Add(const std::string& name, const fleet::VehicleSettings& settings) {
    Vehicle vehicle;
    vehicle.settings = settings;
    mqtt::ClientOptions options;
    options.id = fmt::format("troupe-{}-{}-{:08x}", settings.manufacturer, settings.serial_number,
                             static_cast<std::uint32_t>(MakeRandomId()));
    options.subscriptions = {settings.TopicOf("order"), settings.TopicOf("instantActions")};
    if (!fleet::IsBefore3(settings.version)) {
      options.subscriptions.push_back(settings.TopicOf("zoneSet"));
      options.subscriptions.push_back(settings.TopicOf("responses"));
    }
    if (wait_.waits()) options.subscriptions.push_back(settings.TopicOf(kEcho));
    options.will = mqtt::Message{settings.TopicOf("connection"),
                                 ConnectionText(vehicle, fleet::ConnectionState::kConnectionBroken), 1, true};
    const Result<std::size_t> client = connections_.Add(options);
    if (!client.ok()) {
      const std::string& file = client.error().where.file;
      return SetProblem("VDA 5050: " + (file.empty() ? "" : file + ": ") + client.error().message);
    }
    vehicle.client = client.value();
    robot_of_[vehicle.client] = name;
    for (const std::string& topic : options.subscriptions) topics_.insert(topic);
    vehicles_.emplace(name, std::move(vehicle));
    Watch(settings.manufacturer);
  }

  void ListenToAnswers() {
    mqtt::ClientOptions options;
    options.id = fmt::format("troupe-lockstep-{:016x}", MakeRandomId());
    options.subscriptions = {kAnswerTopic};
    const Result<std::size_t> client = connections_.Add(options);
    if (!client.ok()) return SetProblem("VDA 5050: " + client.error().message);
    asking_ = client.value();
  }

  // A client without a vehicle tells of messages of a fleet control that reach none: a serial number, an interface or a
  // version that no vehicle of this manufacturer has.
  void Watch(const std::string& manufacturer) {
    if (!watched_.insert(manufacturer).second) return;
    mqtt::ClientOptions options;
    options.id = fmt::format("troupe-watch-{:016x}", MakeRandomId());
    for (const char* const topic : {"order", "instantActions"}) {
      options.subscriptions.push_back(fmt::format("+/+/{}/+/{}", manufacturer, topic));
    }
    static_cast<void>(connections_.Add(options));  // without it all else works
  }

  void SetProblem(const std::string& problem) {
    const std::lock_guard lock(mutex_);
    if (problem_.empty()) problem_ = problem;
    changed_.notify_all();
  }

  void Run() {
    try {
      while (Work()) {
      }
      Leave();
    } catch (const std::exception& exception) {
      SetProblem(std::string("VDA 5050: ") + exception.what());
      control_->Wake();
    }
  }

  // False: the run has ended.
  bool Work() {
    std::vector<Outgoing> outgoing;
    std::shared_ptr<const Scene> world;
    bool begins = false;
    bool ends = false;
    {
      const std::lock_guard lock(mutex_);
      wake_.Clear();
      outgoing.swap(outgoing_);
      world = std::exchange(new_world_, nullptr);
      begins = has_begun_ && !is_online_;
      ends = ends_;
      if (ends && outgoing.empty()) return false;
    }
    if (begins) ComeOnline();
    if (world) Follow(world->world());
    for (const Outgoing& message : outgoing) Send(message);
    const double wait = ends ? 0.0 : std::clamp(Proceed(), 0.0, kIdle);
    for (const mqtt::Event& event : connections_.Wait(wait)) std::visit([this](const auto& e) { On(e); }, event);
    return true;
  }

  // Does what the wait for answers needs. Returns s until it needs more.
  double Proceed() {
    std::unique_lock lock(mutex_);
    if (!outgoing_.empty()) return 0.0;  // first the messages, then what follows them
    const double now = Now();
    const AnswerRound::Act act = round_.Next(now);
    const std::uint64_t token = round_.token();
    const std::size_t missing = round_.TakeMissing();
    const bool is_late = round_.TakeIsLate(now);
    const double rest = round_.Rest(now);
    lock.unlock();
    if (missing > 0) {
      lines_(
          fmt::format("VDA 5050: the broker has not returned what {} sent to their topics {} for {:g} s; tick {} "
                      "does not wait for them",
                      CountText(missing, "vehicle"), kEcho, AnswerRound::kLongestEcho, tick_.load()));
    }
    if (is_late) {
      lines_(fmt::format("VDA 5050: tick {} waits for a fleet control that answers {} with {}", tick_.load(), kAskTopic,
                         kAnswerTopic));
    }
    switch (act) {
      case AnswerRound::Act::kNone:
        return rest;
      case AnswerRound::Act::kEcho:
        SendToThemselves(token);
        return 0.0;
      case AnswerRound::Act::kAsk:
        Ask();
        return rest;
      case AnswerRound::Act::kContinue:
        control_->Wake();
        return kIdle;
    }
    return rest;
  }

  void SendToThemselves(std::uint64_t token) {
    std::set<std::size_t> clients;
    for (const auto& [name, vehicle] : vehicles_) {
      const mqtt::Message message{vehicle.settings.TopicOf(kEcho), std::to_string(token)};
      if (connections_.Publish(vehicle.client, message)) clients.insert(vehicle.client);
    }
    const std::lock_guard lock(mutex_);
    round_.Echoed(std::move(clients), Now());
  }

  void Ask() {
    const fleet::VehicleSettings& settings = vehicles_.begin()->second.settings;
    const std::string text = fmt::format(R"({{"run": "{:016x}", "service": {}, "tick": {}, "timestamp": "{}"}})", run_,
                                         incarnation_, tick_.load(), TimestampOf(settings));
    connections_.Publish(*asking_, {kAskTopic, text});
  }

  // Answers to earlier questions come, too, and those that are meant for another run.
  void OnAnswer(const std::string& text) {
    const Result<JsonTree> tree = JsonTree::Parse(text, "");
    if (!tree.ok() || !tree.value().root().is_object()) {
      lines_(fmt::format("VDA 5050: found no JSON object on the topic {}", kAnswerTopic));
      return;
    }
    const JsonNode* const run = tree.value().root().Find("run");
    const JsonNode* const tick = tree.value().root().Find("tick");
    const JsonNode* const leaves = tree.value().root().Find("leaves");
    if (run == nullptr || run->text != fmt::format("{:016x}", run_)) return;
    if (tick == nullptr || !tick->is_number() || tick->ToInteger<Tick>() != tick_) return;
    const std::lock_guard lock(mutex_);
    if (leaves != nullptr && leaves->is_true()) {
      round_.End();
    } else {
      round_.Answered();
    }
  }

  // The run takes orders from now on.
  void ComeOnline() {
    is_online_ = true;
    for (auto& [name, vehicle] : vehicles_) {
      if (!vehicle.is_gone) Announce(vehicle, fleet::ConnectionState::kOnline);
    }
    for (const mqtt::Received& received : std::exchange(early_, {})) On(received);
  }

  void Leave() {
    for (auto& [name, vehicle] : vehicles_) {
      if (!vehicle.is_gone) Announce(vehicle, fleet::ConnectionState::kOffline);
    }
    connections_.Close(kClosing);
  }

  void Announce(Vehicle& vehicle, fleet::ConnectionState state) {
    connections_.Publish(vehicle.client,
                         {vehicle.settings.TopicOf("connection"), ConnectionText(vehicle, state), 1, true});
  }

  void Send(const Outgoing& outgoing) {
    const auto found = vehicles_.find(outgoing.robot);
    if (found == vehicles_.end()) return;
    Vehicle& vehicle = found->second;
    const FleetMessage& message = outgoing.message;
    const bool is_factsheet = message.topic == FleetTopic::kFactsheet;
    if (is_factsheet) vehicle.factsheet = message.text;
    const std::string topic = vehicle.settings.TopicOf(troupe::NameOf(message.topic));
    connections_.Publish(vehicle.client, {topic, message.text, 0, is_factsheet});
  }

  void On(const mqtt::Connected& connected) {
    const auto robot = robot_of_.find(connected.client);
    if (robot == robot_of_.end()) return;
    Vehicle& vehicle = vehicles_.at(robot->second);
    if (!vehicle.is_gone && is_online_) Announce(vehicle, fleet::ConnectionState::kOnline);
    if (!vehicle.factsheet.empty()) {
      connections_.Publish(vehicle.client, {vehicle.settings.TopicOf("factsheet"), vehicle.factsheet, 0, true});
    }
    if (lost_.erase(robot->second) > 0) lines_(fmt::format("VDA 5050: {} is connected again", robot->second));
    const std::lock_guard lock(mutex_);
    ++connected_;
    changed_.notify_all();
  }

  void On(const mqtt::Disconnected& disconnected) {
    const auto robot = robot_of_.find(disconnected.client);
    if (robot == robot_of_.end()) return;
    {
      const std::lock_guard lock(mutex_);
      last_reason_ = disconnected.reason;
      round_.Lost(disconnected.client);
      changed_.notify_all();
    }
    if (!disconnected.was_connected) return;  // it was told, and the next attempt follows
    lost_.insert(robot->second);
    lines_(fmt::format("VDA 5050: {} has lost the broker {} ({}), and tries to reach it again", robot->second,
                       connections_.broker().Url(), disconnected.reason));
  }

  void On(const mqtt::Received& received) {
    const mqtt::Message& message = received.message;
    if (asking_ == received.client) return OnAnswer(message.payload);
    const auto robot = robot_of_.find(received.client);
    if (robot == robot_of_.end()) {
      if (topics_.contains(message.topic)) return;
      lines_(
          fmt::format("VDA 5050: found a message on the topic {}, which is of no vehicle of this run", message.topic));
      return;
    }
    if (!is_online_) {
      if (early_.size() < kMostQueued) early_.push_back(received);
      return;
    }
    const std::string name = message.topic.substr(message.topic.rfind('/') + 1);
    if (name == kEcho) {
      const std::uint64_t token = std::strtoull(message.payload.c_str(), nullptr, 10);
      const std::lock_guard lock(mutex_);
      return round_.Returned(received.client, token);
    }
    const std::optional<FleetTopic> topic = FindByName<FleetTopic>(name);
    if (!topic || !IsToVehicle(*topic)) return;
    std::string text = message.payload;
    // The vehicle rejects an empty text, so that the fleet control hears of it, too.
    if (text.size() > kMaxFleetBytes || text.find('\0') != std::string::npos) {
      lines_(fmt::format("VDA 5050: found {} for {} of {} bytes, expected JSON of at most {}", name, robot->second,
                         text.size(), kMaxFleetBytes));
      text.clear();
    }
    {
      const std::lock_guard lock(mutex_);
      std::size_t& queued = queued_[robot->second];
      if (queued >= kMostQueued) {
        lines_(fmt::format("VDA 5050: {} for {} is dropped: {} messages wait for ticks", name, robot->second, queued));
        return;
      }
      ++queued;
      round_.Heard(Now());
    }
    control::CommandRobot command;
    command.name = robot->second;
    command.messages.push_back({*topic, std::move(text)});
    control_->Request(command, [lines = lines_, name, vehicle = robot->second](const ControlReply& reply) {
      if (!reply.done) lines(fmt::format("VDA 5050: {} for {}: {}", name, vehicle, reply.problem));
    });
  }

  const AnswerWait wait_;
  const WakeEvent wake_;
  std::atomic<Tick> tick_ = 0;  // the newest
  WorldControl* control_ = nullptr;
  std::int64_t interval_ns_ = 0;
  RunId run_ = 0;
  Incarnation incarnation_ = 0;
  std::optional<std::size_t> asking_;  // the client that asks for answers

  // Of the thread.
  mqtt::Connections connections_;
  std::map<std::string, Vehicle> vehicles_;      // by robot
  std::map<std::size_t, std::string> robot_of_;  // by client
  std::set<std::string> topics_;                 // of the vehicles
  std::set<std::string> watched_;                // manufacturers
  std::set<std::string> lost_;                   // robots without a connection
  bool is_online_ = false;                       // the fleet controls have been told
  std::vector<mqtt::Received> early_;            // before that

  const std::function<void(const std::string&)> lines_;

  std::mutex mutex_;  // guards the members below
  std::condition_variable changed_;
  std::shared_ptr<const Scene> robots_;  // whose proposals ticks have
  std::shared_ptr<const Scene> new_world_;
  std::vector<Outgoing> outgoing_;
  std::map<std::string, std::size_t> queued_;  // by robot: messages to it that wait for ticks
  std::size_t connected_ = 0;
  std::string last_reason_;  // why a connection failed
  std::string problem_;
  AnswerRound round_;
  bool is_round_due_ = false;  // it begins when the agents have decided on the newest tick
  bool has_begun_ = false;     // a tick was made, or one of the service before is continued
  bool ends_ = false;

  std::thread thread_;  // last, because it uses all other members
};

}  // namespace

Result<std::unique_ptr<RunObserver>> MakeFleetGateway(const mqtt::Broker& broker, const AnswerWait& wait,
                                                      const WorldDescription& world,
                                                      std::function<void(const std::string&)> lines) {
  const Result<std::map<std::string, fleet::VehicleSettings>> vehicles = VehiclesOf(world);
  if (!vehicles.ok()) return vehicles.error();
  if (vehicles.value().empty()) {
    return Error{{}, "--vda5050: the world has no vehicle, expected a robot with the controller vda5050"};
  }
  const auto limited = std::make_shared<FloodLimiter>(std::move(lines));
  return std::unique_ptr<RunObserver>(
      std::make_unique<FleetGateway>(broker, wait, [limited](const std::string& line) { limited->Add(line); }));
}

}  // namespace troupe
