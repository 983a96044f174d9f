#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "command_line/parse_command_line.h"
#include "command_line/run_flags.h"
#include "command_line/terminal.h"
#include "common/base/print.h"
#include "launcher/commands/commands.h"
#include "launcher/process/process.h"
#include "recording/recording.h"
#include "transport/dds/tools/control_client.h"
#include "transport/dds/tools/session_monitor.h"
#include "transport/security/session_keys.h"
#include "viewer/gateway/access.h"
#include "viewer/gateway/past_states.h"
#include "viewer/gateway/viewer_gateway.h"
#include "world-service/replay/replayed_world.h"
#include "world-service/replay/run_replay.h"

namespace troupe {
namespace {

// RecordedStates: the states of a recording for the viewer. A state is stepped again from the keyframe before it; the
// states in between are kept for some time, so that a recording plays backwards as well.
//
// Threads: At on one, the others on any.
class RecordedStates final : public Recorded {
 public:
  // Reads all ticks, but steps none. The recording outlives the states. The error is a recording of another version of
  // the step, or one without a readable tick. `damage`: why the ticks end early; nothing: they do not.
  static Result<std::unique_ptr<RecordedStates>> Create(const Recording& recording, std::optional<std::string>& damage);

  std::optional<Range> range() const override { return Range{0, places_.size() - 1}; }
  std::optional<std::uint64_t> PositionOf(Tick tick) const override;
  Result<std::shared_ptr<const ViewedState>> At(std::uint64_t position) override;
  std::vector<NumberedEvent> Events() const override { return events_; }

 private:
  struct Place {
    Tick tick = 0;
    std::uint64_t log_time = 0;
    Edition edition = 0;
  };

  explicit RecordedStates(const Recording& recording) : recording_(recording) {}
  std::optional<std::string> ReadPlaces();
  // Brings the world to the last keyframe before a position, or to the start.
  Status Restart(std::uint64_t position);
  // Applies the next tick, and keeps its state.
  Status Advance();
  void Keep();
  std::shared_ptr<const ViewedWorld> WorldOf(const std::shared_ptr<const Scene>& scene);

  const Recording& recording_;
  std::vector<Place> places_;  // by position; constant after Create, like the next
  std::vector<NumberedEvent> events_;
  bool has_edits_ = false;  // then the world is not the same in all states

  std::optional<ReplayedWorld> world_;
  std::optional<TickReader> reader_;
  std::optional<std::uint64_t> position_;  // of world_; nothing: it has no state yet
  RecordedTick tick_;
  std::vector<std::shared_ptr<const ViewedWorld>> worlds_;  // all that were shown
  std::weak_ptr<const Scene> newest_scene_;                 // of worlds_.back() or another one like it
  std::shared_ptr<const ViewedWorld> newest_world_;
  std::map<std::uint64_t, std::shared_ptr<const ViewedState>> kept_;  // by position
  std::size_t kept_bytes_ = 0;
};

constexpr std::size_t kMostKeptBytes = std::size_t{128} << 20;
// Stepping on is quicker than starting at a keyframe for at most this many states.
constexpr std::uint64_t kStepOn = 100;

Result<std::unique_ptr<RecordedStates>> RecordedStates::Create(const Recording& recording,
                                                               std::optional<std::string>& damage) {
  if (Status other = CheckStepVersion(recording); !other.ok()) return other.error();
  std::unique_ptr<RecordedStates> states(new RecordedStates(recording));
  damage = states->ReadPlaces();
  if (!damage && recording.damage()) damage = recording.damage()->problem;
  if (states->places_.empty()) {
    return Error{{recording.name()}, fmt::format("found no tick: {}", damage.value_or("the recording is empty"))};
  }
  return states;
}

std::optional<std::string> RecordedStates::ReadPlaces() {
  TickReader reader(recording_);
  RecordedTick tick;
  std::optional<ReplayedWorld> edited;
  for (;;) {
    const Result<bool> more = reader.Next(tick);
    if (!more.ok()) return more.error().message;
    if (!more.value()) return std::nullopt;
    if (tick.edit && events_.size() < kEventsKept) {
      if (!edited) edited.emplace(recording_);
      if (Status problem = edited->ApplyAlone(tick.number, *tick.edit); !problem.ok()) return problem.error().message;
    }
    const WorldDescription& world = edited ? edited->world() : recording_.run().world;
    for (const Event& event : tick.events) {
      if (events_.size() < kEventsKept) {
        events_.push_back({events_.size() + 1, places_.size(), event, NamesIn(world, event)});
      }
    }
    has_edits_ = has_edits_ || tick.edit.has_value();
    places_.push_back({tick.tick, tick.log_time, tick.edition});
  }
}

std::optional<std::uint64_t> RecordedStates::PositionOf(Tick tick) const {
  const auto found =
      std::find_if(places_.rbegin(), places_.rend(), [&](const Place& place) { return place.tick == tick; });
  if (found == places_.rend()) return std::nullopt;
  return static_cast<std::uint64_t>(places_.rend() - found) - 1;
}

Result<std::shared_ptr<const ViewedState>> RecordedStates::At(std::uint64_t position) {
  position = std::min<std::uint64_t>(position, places_.size() - 1);
  if (const auto kept = kept_.find(position); kept != kept_.end()) return kept->second;
  if (!position_ || *position_ > position || position - *position_ > kStepOn) {
    if (Status failure = Restart(position); !failure.ok()) return failure.error();
  }
  while (!position_ || *position_ < position) {
    if (Status failure = Advance(); !failure.ok()) {
      position_.reset();
      return Error{{recording_.name()}, failure.error().message};
    }
  }
  return kept_.at(position);
}

Status RecordedStates::Restart(std::uint64_t position) {
  position_.reset();
  std::uint64_t log_time = places_[position].log_time;
  for (;;) {
    const std::optional<std::size_t> chunk = recording_.KeyframeBefore(log_time);
    if (!chunk || *chunk == 0) break;
    if (!world_ || has_edits_) {
      Result<ReplayedWorld> world = ReplayedWorld::At(recording_, *chunk);
      if (!world.ok()) return world.error();
      world_.emplace(std::move(world).value());
    }
    reader_.emplace(recording_, *chunk);
    const Result<bool> more = reader_->Next(tick_);
    if (!more.ok()) return more.error();
    if (more.value() && tick_.keyframe && tick_.number <= position) {
      if (Status failure = world_->Restore(tick_); !failure.ok()) return failure;
      position_ = tick_.number;
      Keep();
      return {};
    }
    // Edits take no time: the keyframe may follow the position.
    if (log_time == 0) break;
    --log_time;
  }
  world_.emplace(recording_);
  reader_.emplace(recording_);
  return {};
}

Status RecordedStates::Advance() {
  const Result<bool> more = reader_->Next(tick_);
  if (!more.ok()) return more.error();
  if (!more.value()) return Error{{}, "found the end of the recording, expected another tick"};
  if (Status problem = world_->Follow(tick_); !problem.ok()) {
    return Error{{}, fmt::format("tick {}: {} (troupe replay tells more)", tick_.tick, problem.error().message)};
  }
  position_ = tick_.number;
  Keep();
  return {};
}

void RecordedStates::Keep() {
  if (kept_.contains(*position_)) return;
  auto state = std::make_shared<const ViewedState>(ViewedState{*position_, WorldOf(world_->scene()),
                                                               std::make_shared<const WorldState>(world_->state()),
                                                               world_->state_hash(), places_[*position_].edition});
  kept_bytes_ += SizeOf(*state);
  kept_.emplace(*position_, std::move(state));
  // The farthest ones are dropped.
  while (kept_bytes_ > kMostKeptBytes && kept_.size() > 1) {
    const bool first = *position_ - kept_.begin()->first > kept_.rbegin()->first - *position_;
    const auto dropped = first ? kept_.begin() : std::prev(kept_.end());
    kept_bytes_ -= SizeOf(*dropped->second);
    kept_.erase(dropped);
  }
}

std::shared_ptr<const ViewedWorld> RecordedStates::WorldOf(const std::shared_ptr<const Scene>& scene) {
  if (newest_world_ != nullptr && newest_scene_.lock() == scene) return newest_world_;
  newest_scene_ = scene;
  const auto same = std::find_if(worlds_.begin(), worlds_.end(),
                                 [&](const auto& world) { return world->scene->world() == scene->world(); });
  if (same == worlds_.end()) {
    SessionMessage session;
    session.run = recording_.run().run;
    session.world = scene->world();
    worlds_.push_back(MakeViewedWorld(session, static_cast<std::uint32_t>(worlds_.size() + 1)));
    newest_world_ = worlds_.back();
  } else {
    newest_world_ = *same;
  }
  return newest_world_;
}

constexpr double kReplySeconds = 10.0;
constexpr int kEndMilliseconds = 300;
constexpr int kPollMilliseconds = 10;
constexpr int kNiceness = 10;  // where processors are short, the run goes first

struct ViewOptions {
  NetworkSettings network;  // session empty: the only one
  std::string file;         // of a recording; empty: a live run
  std::string listen;       // text for ParseListen; empty: the default
  bool view_only = false;
};

// A run over DDS, as an observer and an operator of its session.
class DdsRunLink : public RunLink {
 public:
  explicit DdsRunLink(const NetworkSettings& network) : network_(network), control_(network) {}

  Result<std::unique_ptr<RunObservation>> Observe(ObserverHandler& handler) override {
    Result<std::unique_ptr<SessionObserver>> observer = ObserveSession(network_, handler);
    if (!observer.ok()) return observer.error();
    return std::unique_ptr<RunObservation>(std::make_unique<SessionObservation>(std::move(observer).value()));
  }

  Result<ControlReply> Ask(const ControlRequest& request) override {
    try {
      if (Status missing = control_.WaitForService(kDiscoverySeconds); !missing.ok()) return missing.error();
      return control_.Call(request, kReplySeconds);
    } catch (const std::exception& exception) {
      return FailureOf(exception);
    }
  }

 private:
  struct SessionObservation : RunObservation {
    explicit SessionObservation(std::unique_ptr<SessionObserver> observer) : observer_(std::move(observer)) {}
    std::unique_ptr<SessionObserver> observer_;
  };

  const NetworkSettings network_;
  ControlClient control_;
};

// The token of the page's address. A run that only its user may control must not be open to other users of the host by
// its page. The same for all viewers of a run with a token, so that a page connects to the next viewer, too.
std::string TokenOf(const NetworkSettings& network) {
  if (network.security == kSecurityOff) return "";
  const Result<ParticipantKeys> keys = FindKeys(network.security, network.domain, network.session, Role::Observer());
  if (!keys.ok() || !keys.value().token) return MakeToken();
  return keys.value().token->Proof("the page of its viewer").substr(0, MakeToken().size());
}

ViewerGatewayOptions OptionsOfGateway(const ViewOptions& options) {
  ViewerGatewayOptions gateway_options;
  gateway_options.view_only = options.view_only;
  if (const std::optional<ListenAddress> listen = ParseListen(options.listen)) {
    gateway_options.address = listen->address;
    gateway_options.port = listen->port;
    gateway_options.any_port = false;
  }
  return gateway_options;
}

int ServeUntilStopped(const Result<std::unique_ptr<ViewerGateway>>& gateway, SignalWatch& signals) {
  if (!gateway.ok()) return Fail(gateway.error());
  fmt::print("{}\n", StyledLine("viewer: " + gateway.value()->Address(), HasStyles(stdout)));
  std::fflush(stdout);
  pollfd waited = {signals.descriptor(), POLLIN, 0};
  while (!signals.ReadStopRequest()) poll(&waited, 1, -1);
  // The launcher ends the viewer of a run with the run, whose last frame is on its way.
  for (int ms = 0; ms < kEndMilliseconds && !gateway.value()->HasShownEnd(); ms += kPollMilliseconds) {
    poll(nullptr, 0, kPollMilliseconds);
  }
  return kExitDone;
}

int ServeRun(const ViewOptions& options, SignalWatch& signals) {
  DdsRunLink link(options.network);
  ViewerGatewayOptions gateway_options = OptionsOfGateway(options);
  gateway_options.session = options.network.session;
  gateway_options.token = TokenOf(options.network);
  return ServeUntilStopped(ViewerGateway::Start(gateway_options, link), signals);
}

int ServeRecording(const ViewOptions& options, SignalWatch& signals) {
  const Result<Recording> recording = Recording::Open(options.file);
  if (!recording.ok()) return Fail(recording.error());
  std::optional<std::string> damage;
  const Result<std::unique_ptr<RecordedStates>> states = RecordedStates::Create(recording.value(), damage);
  if (!states.ok()) return Fail(states.error());
  if (damage) PrintPlain(stderr, "{}: warning: {}; it is shown up to there\n", options.file, *damage);
  ViewerGatewayOptions gateway_options = OptionsOfGateway(options);
  gateway_options.session = std::filesystem::path(options.file).filename().string();
  gateway_options.token = MakeToken();
  return ServeUntilStopped(ViewerGateway::Start(gateway_options, *states.value()), signals);
}

int ViewCommand(ViewOptions options) {
  SignalWatch signals;
  setpriority(PRIO_PROCESS, 0, kNiceness);
  try {
    if (!options.file.empty()) return ServeRecording(options, signals);
    if (const Status problem = SelectSession(options.network); !problem.ok()) return Fail(problem.error());
    return ServeRun(options, signals);
  } catch (const std::exception& exception) {
    return Fail(FailureOf(exception));
  }
}

}  // namespace

void AddViewCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("view", "Show a run, or a recording of one, in a browser");
  const auto options = std::make_shared<ViewOptions>();
  command
      ->add_option_function<std::string>(
          "SESSION|FILE.mcap",
          [options](const std::string& name) {
            (IsRecordingPath(name) ? options->file : options->network.session) = name;
          },
          "Session of the run (default: the only one in the domain), or a recording")
      ->check(CLI::Validator(
          [](std::string& text) { return IsRecordingPath(text) ? std::string() : SessionName()(text); }, ""));
  AddListenOption(*command, options->listen);
  command->add_flag("--view-only", options->view_only, "Refuse requests that change the run");
  AddToolNetworkFlags(*command, options->network);
  command->final_callback([options, &exit_status] { exit_status = ViewCommand(*options); });
}

}  // namespace troupe
