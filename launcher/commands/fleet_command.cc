// `troupe fleet check`: the rules of VDA 5050 over the messages of a log, a recording or a broker. docs/vda5050.md is
// its manual.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command_line/broker_options.h"
#include "command_line/parse_command_line.h"
#include "common/base/distinct_files.h"
#include "common/base/output_file.h"
#include "common/base/print.h"
#include "fleet/check_report.h"
#include "fleet/message_log.h"
#include "fleet/vehicle_settings.h"
#include "launcher/commands/commands.h"
#include "launcher/process/process.h"
#include "recording/recording.h"
#include "transport/mqtt/mqtt_connections.h"
#include "world-service/replay/replayed_world.h"

namespace troupe {
namespace {

using fleet::CheckerMemory;
using fleet::Rule;

constexpr int kExitViolations = 1;
constexpr std::size_t kMostPlaces = 100'000;    // of messages that a verdict may still be about
constexpr std::size_t kLongestPayload = 2'000;  // bytes that are printed
constexpr double kLookSeconds = 0.1;            // between looks at the time

struct FleetCheckArguments {
  std::string file;
  BrokerOptions broker;
  std::string interface_name;
  std::optional<double> seconds;
  std::string version;
  double answer_seconds = 5.0;
  std::vector<std::string> without;
  std::string junit;
  std::string log;
  bool payloads = false;
};

// The checker, with the places of messages for its verdicts.
class FleetChecker {
 public:
  explicit FleetChecker(const FleetCheckArguments& arguments) : payloads_(arguments.payloads) {
    options_.version = FindByName<fleet::Version>(arguments.version);
    options_.answer_milliseconds = static_cast<std::int64_t>(1e3 * arguments.answer_seconds);
    for (const std::string& name : arguments.without) without_.push_back(*FindByName<Rule>(name));
  }

  // Messages of other topics are ignored. `place` of a line of a log; live messages have their time as place.
  void Add(const fleet::LoggedMessage& message, const std::string& interface_name, std::optional<std::string> place) {
    std::optional<fleet::TopicName> topic = fleet::FindTopic(message.topic);
    if (!topic || (!interface_name.empty() && topic->interface_name != interface_name)) return;
    if (places_.size() >= kMostPlaces) places_.pop_front();
    places_.push_back(
        {place ? std::move(*place) : fleet::FormatTimestamp(message.milliseconds, fleet::Version::k3_0), topic->topic});
    const fleet::ObservedMessage observed = {std::move(topic->manufacturer),
                                             std::move(topic->serial_number),
                                             topic->topic,
                                             message.milliseconds,
                                             message.payload,
                                             topic->major_version};
    Print(fleet::CheckMessage(memory_, observed, options_), message.payload);
  }
  void Look(std::int64_t milliseconds) { Print(fleet::CheckTime(memory_, milliseconds, options_), {}); }
  void MissMessages() { fleet::MissMessages(memory_); }
  // The run has gone back to an earlier state, and its vehicles count from there.
  void GoBack() {
    fleet::MissMessages(memory_);
    for (auto& [name, record] : memory_.vehicles) record.senders = {};
  }

  std::uint64_t messages() const { return memory_.messages; }

  // Prints the summary and writes the file. Returns the exit status, `exit_status` if no rule is broken.
  int Finish(const std::string& junit, int exit_status) const {
    if (!junit.empty()) {
      if (const Status status = WriteWholeFile(junit, report_.JUnit(memory_, without_)); !status.ok()) {
        return Fail(status.error());
      }
    }
    for (const std::string& line : report_.Summary(memory_)) PrintPlain(stdout, "{}\n", line);
    if (memory_.left_out > 0) {
      PrintPlain(stderr, "warning: {} messages of more than {} vehicles were not judged\n", memory_.left_out,
                 fleet::kMostVehicles);
    }
    return report_.violations() > 0 ? kExitViolations : exit_status;
  }

 private:
  struct Place {
    std::string text;
    fleet::Topic topic;
  };

  void Print(const std::vector<fleet::Verdict>& verdicts, std::string_view payload) {
    for (const fleet::Verdict& verdict : verdicts) {
      if (std::find(without_.begin(), without_.end(), verdict.rule) != without_.end()) continue;
      const std::uint64_t first = memory_.messages - places_.size();
      const bool is_known = verdict.message >= first && verdict.message < memory_.messages;
      const Place place = is_known ? places_[verdict.message - first]
                                   : Place{"message " + std::to_string(verdict.message), fleet::Topic::kState};
      PrintPlain(stdout, "{}\n", report_.Add(verdict, place.text, NameOf(place.topic)));
      if (payloads_ && !payload.empty() && verdict.message + 1 == memory_.messages) {
        PrintPlain(stdout, "  {}\n", payload.substr(0, kLongestPayload));
      }
    }
  }

  const bool payloads_;
  fleet::CheckerOptions options_;
  std::vector<Rule> without_;
  CheckerMemory memory_;
  fleet::CheckReport report_;
  std::deque<Place> places_;  // of the newest messages
};

// Before the check: hours of messages must not end in a file that cannot be written.
Status CheckFleetOutputs(const FleetCheckArguments& arguments) {
  const std::vector<OutputName> outputs = {{"--junit", arguments.junit}, {"--log", arguments.log}};
  const auto inputs = [&] { return arguments.file.empty() ? std::vector<std::string>() : std::vector{arguments.file}; };
  if (Status problem = CheckDistinct(outputs, inputs); !problem.ok()) return problem;
  for (const OutputName& output : outputs) {
    if (output.path.empty()) continue;
    if (const Status status = CheckWritable(output.path); !status.ok()) {
      return Error{{output.path}, "cannot write: " + status.error().message};
    }
  }
  return {};
}

int CheckLog(const FleetCheckArguments& arguments) {
  FleetChecker checker(arguments);
  const Status read = fleet::VisitLog(arguments.file, [&](const fleet::LoggedMessage& message, int line) -> Status {
    checker.Add(message, arguments.interface_name, fmt::format("{}:{}", arguments.file, line));
    return {};
  });
  if (!read.ok()) return Fail(read.error());
  if (checker.messages() == 0) {
    return Fail({{arguments.file},
                 "found no message of VDA 5050, expected topics INTERFACE/vMAJOR/MANUFACTURER/SERIAL_NUMBER/TOPIC"});
  }
  return checker.Finish(arguments.junit, kExitDone);
}

// The topics of the robots that are vehicles; empty for others. Those of a spawned robot come behind the others.
class RecordedTopics {
 public:
  explicit RecordedTopics(const WorldDescription& world) { Add(world); }

  void Follow(const RecordedEdit& edit) {
    if (!edit.world) return;
    if (ReplacesWorld(edit.request)) topics_.clear();
    Add(*edit.world);
  }
  std::string TopicOf(RobotId robot, FleetTopic topic) const {
    if (robot.index() >= topics_.size() || topics_[robot.index()].empty()) return {};
    return topics_[robot.index()] + "/" + NameOf(topic);
  }

 private:
  void Add(const WorldDescription& world) {
    for (const RobotDescription& robot : world.robots) {
      const Result<fleet::VehicleSettings> settings =
          robot.controller.name == "vda5050" ? fleet::ReadVehicleSettings(robot.controller.parameters, robot.name)
                                             : Error{{}, "another controller"};
      const std::string topic = settings.ok() ? settings.value().TopicOf("") : "";
      topics_.push_back(topic.substr(0, topic.rfind('/')));
    }
  }

  std::vector<std::string> topics_;  // without the last level
};

// Without a replay: the messages are inputs of ticks and parts of proposals. The messages to vehicles of a tick come
// before those of vehicles, which are their answers.
int CheckRecording(const FleetCheckArguments& arguments) {
  const Result<Recording> recording = OpenToReplay(arguments.file);
  if (!recording.ok()) return Fail(recording.error());
  FleetChecker checker(arguments);
  RecordedTopics topics(recording.value().run().world);
  TickReader reader(recording.value());
  RecordedTick tick;
  std::optional<Error> damage;
  for (;;) {
    const Result<bool> next = reader.Next(tick);
    if (!next.ok()) damage = next.error();
    if (!next.ok() || !next.value()) break;
    if (tick.edit) {
      topics.Follow(*tick.edit);
      if (ReplacesWorld(tick.edit->request)) checker.GoBack();
    }
    const auto milliseconds = static_cast<std::int64_t>(tick.log_time / 1'000'000);
    const auto add = [&](RobotId robot, const std::vector<FleetMessage>& messages) {
      for (const FleetMessage& message : messages) {
        checker.Add({milliseconds, topics.TopicOf(robot, message.topic), message.text}, arguments.interface_name,
                    fmt::format("{}: tick {}", arguments.file, tick.tick));
      }
    };
    for (const RobotCommand& command : tick.commands) add(command.robot, command.messages);
    for (const Proposal& proposal : tick.proposals) add(proposal.robot, proposal.fleet);
    checker.Look(milliseconds);
  }
  if (checker.messages() == 0 && !damage) {
    return Fail({{arguments.file}, "found no message of VDA 5050, expected a run with the controller vda5050"});
  }
  const int status = checker.Finish(arguments.junit, kExitDone);
  return damage ? Fail(*damage) : status;
}

// The time of day at the begin, and from then on a clock that nobody sets.
class SteadyTime {
 public:
  std::int64_t Milliseconds() const { return began_ + static_cast<std::int64_t>(1e3 * Seconds()); }
  double Seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  const std::int64_t began_ =
      std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch())
          .count();
};

int CheckBroker(const FleetCheckArguments& arguments) {
  Result<mqtt::Broker> broker = BrokerOf(arguments.broker);
  if (!broker.ok()) return Fail(broker.error());
  std::optional<OutputFile> log;
  if (!arguments.log.empty()) {
    Result<OutputFile> created = OutputFile::Create(arguments.log);
    if (!created.ok()) return Fail(created.error());
    log = std::move(created).value();
  }
  SignalWatch signals;
  mqtt::Connections connections(broker.value(), signals.descriptor());
  const std::string filter = (arguments.interface_name.empty() ? "+" : arguments.interface_name) + "/+/+/+/+";
  const Result<std::size_t> client = connections.Add({"", {filter}, 1, std::nullopt});
  if (!client.ok()) return Fail(client.error());
  FleetChecker checker(arguments);
  const SteadyTime time;
  std::optional<double> end;
  bool is_stopped = false;
  while (!is_stopped && (!end || time.Seconds() < *end)) {
    for (const mqtt::Event& event : connections.Wait(kLookSeconds)) {
      if (std::holds_alternative<mqtt::Connected>(event)) {
        PrintPlain(stderr, "listening at {}, topics {}\n", broker.value().Url(), filter);
        if (!end && arguments.seconds) end = time.Seconds() + *arguments.seconds;
      } else if (const auto* const lost = std::get_if<mqtt::Disconnected>(&event)) {
        if (!lost->was_connected && !end && checker.messages() == 0) {
          return Fail(Failure(fmt::format("cannot connect to {}: {}", broker.value().Url(), lost->reason)));
        }
        PrintPlain(stderr, "warning: no connection to {}: {}\n", broker.value().Url(), lost->reason);
        checker.MissMessages();
      } else if (const auto* const received = std::get_if<mqtt::Received>(&event)) {
        const fleet::LoggedMessage message = {time.Milliseconds(), received->message.topic, received->message.payload};
        if (log) log->Append(fleet::LogLine(message));
        checker.Add(message, "", std::nullopt);
      }
    }
    checker.Look(time.Milliseconds());
    std::fflush(stdout);
    is_stopped = signals.ReadStopRequest();
  }
  connections.Close(1.0);
  if (log) {
    if (const Status status = log->Close(); !status.ok()) return Fail(status.error());
  }
  if (checker.messages() == 0) {
    return Fail(Failure(fmt::format("found no message of VDA 5050 at {} in {:.1f} s, expected topics {}",
                                    broker.value().Url(), time.Seconds(), filter)));
  }
  return checker.Finish(arguments.junit, is_stopped ? kExitInterrupted : kExitDone);
}

int FleetCheckCommand(const FleetCheckArguments& arguments) {
  if (arguments.file.empty() && arguments.broker.url.empty()) {
    return Fail({{}, "found neither FILE nor --vda5050, expected a log of messages, or the URL of a broker"});
  }
  if (const Status problem = CheckFleetOutputs(arguments); !problem.ok()) return Fail(problem.error());
  try {
    if (arguments.file.empty()) return CheckBroker(arguments);
    return IsRecordingPath(arguments.file) ? CheckRecording(arguments) : CheckLog(arguments);
  } catch (const std::exception& exception) {
    return Fail(FailureOf(exception));
  }
}

}  // namespace

void AddFleetCommand(CLI::App& app, int& exit_status) {
  CLI::App* const fleet_command = app.add_subcommand("fleet", "Judge fleet controls and vehicles of VDA 5050");
  fleet_command->require_subcommand(1);
  CLI::App* const command =
      fleet_command->add_subcommand("check", "Judge both sides by the rules of the standard, over their messages");
  const auto arguments = std::make_shared<FleetCheckArguments>();  // lives as long as the command
  CLI::Option* const file =
      command
          ->add_option("FILE", arguments->file,
                       "A recording (.mcap), or a log of messages: JSON lines of time, topic and payload, "
                       "as those of 'mosquitto_sub -F %j'")
          ->check(NotEmpty())
          ->type_name("");
  command
      ->add_option("--vda5050-version", arguments->version,
                   "Of all messages: 2.0, 2.1 or 3.0 (default: of each vehicle the one that it states)")
      ->check(OneOf(AllNames<fleet::Version>()))
      ->type_name("VERSION");
  command
      ->add_option("--interface", arguments->interface_name,
                   "Only messages of this interface, the first level of topics, for instance uagv")
      ->check(NotEmpty())
      ->type_name("NAME");
  command
      ->add_option("--answer", arguments->answer_seconds,
                   "In which a vehicle has to answer orders and instant actions (default: 5)")
      ->check(PositiveNumber())
      ->type_name("SECONDS");
  command->add_option("--without", arguments->without, "Do not judge by this rule; repeatable")
      ->check(OneOf(AllNames<Rule>()))
      ->type_name("RULE")
      ->allow_extra_args(false);
  command->add_flag("--payloads", arguments->payloads, "Print the messages with their violations");
  command->add_option("--junit", arguments->junit, "Write the verdicts as JUnit XML")
      ->check(NotEmpty())
      ->type_name("FILE");
  AddBrokerOptions(*command, arguments->broker,
                   "Listen at this broker, mqtt://HOST[:PORT] or mqtts://HOST[:PORT], until Ctrl-C")
      ->excludes(file);
  CLI::Option* const url = &FindOption(*command, "--vda5050");
  command->add_option("--for", arguments->seconds, "Listen for so long")
      ->check(PositiveNumber())
      ->type_name("SECONDS")
      ->group("Broker")
      ->needs(url);
  command->add_option("--log", arguments->log, "Write the messages as a log that this command reads")
      ->check(NotEmpty())
      ->type_name("FILE")
      ->group("Broker")
      ->needs(url);
  command->final_callback([arguments, &exit_status] { exit_status = FleetCheckCommand(*arguments); });
}

}  // namespace troupe
