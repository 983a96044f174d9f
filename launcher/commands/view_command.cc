#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "command_line/parse_command_line.h"
#include "command_line/run_flags.h"
#include "command_line/terminal.h"
#include "common/base/distinct_files.h"
#include "common/base/file.h"
#include "common/base/json_reader.h"
#include "common/base/print.h"
#include "launcher/commands/commands.h"
#include "launcher/commands/shown_expectations.h"
#include "launcher/commands/static_page.h"
#include "launcher/commands/streamed_run.h"
#include "launcher/process/process.h"
#include "launcher/supervise/run_again.h"
#include "recording/journal.h"
#include "recording/recording.h"
#include "transport/dds/tools/control_client.h"
#include "transport/dds/tools/session_monitor.h"
#include "transport/security/session_keys.h"
#include "viewer/gateway/access.h"
#include "viewer/gateway/page_messages.h"
#include "viewer/gateway/viewer_gateway.h"
#include "world-service/replay/stepped_timeline.h"
#include "world-service/service/requested_file.h"

namespace troupe {
namespace {

constexpr double kReplySeconds = 10.0;
constexpr int kEndMilliseconds = 3000;
constexpr int kPollMilliseconds = 10;
constexpr std::size_t kMaxRecordingBytes = std::size_t{1} << 30;  // bytes that are sent to a page
constexpr int kNiceness = 10;                                     // where processors are short, the run goes first

struct ViewOptions {
  NetworkSettings network;  // session empty: the only one
  std::string file;         // a recording, with is_static also a world; empty: a live run
  std::string listen;       // text for ParseListen; empty: the default
  std::string token_file;   // empty: the run's token, or a random one
  std::string expect;       // file with the expectations to show; empty: the run's scenario
  std::string scenario;     // of the run; empty: it is not known
  std::optional<JournalFiles> journal;
  std::vector<std::string> run_command;  // for the page
  bool runs_again = false;               // the launcher starts the run again when it is told to
  bool view_only = false;
  bool states = false;     // of a simulation, from the standard input
  bool is_static = false;  // a file is written in place of a gateway that serves
  StaticPageOptions page;
};

// By the ending: a session with such a name cannot be shown by its name.
bool IsFile(const std::string& name) {
  return IsRecordingPath(name) || name.ends_with(".world") || name.ends_with(".json") || name.ends_with(".yaml") ||
         name.ends_with(".sdf") || name.ends_with(".urdf");
}

Result<ParticipantKeys> KeysOf(const NetworkSettings& network) {
  return FindKeys(network.security, network.domain, network.session, Role::Observer());
}

// A run over DDS, as an observer and an operator of its session.
class DdsRunLink : public RunLink {
 public:
  DdsRunLink(const NetworkSettings& network, std::optional<JournalFiles> journal, bool runs_again)
      : network_(network), journal_(std::move(journal)), runs_again_(runs_again), control_(network) {}

  // With a journal, states that were not observed can be read later.
  bool follows_always() const override { return !journal_; }
  // A run that has not begun has none.
  std::shared_ptr<RecordedTimeline> ReadJournal(WorldCache& worlds) override {
    if (!journal_) return nullptr;
    Result<Recording> run = troupe::ReadJournal(*journal_);
    if (!run.ok()) return nullptr;
    Result<std::unique_ptr<SteppedTimeline>> timeline = SteppedTimeline::Create(std::move(run).value(), worlds);
    return timeline.ok() ? std::move(timeline).value() : nullptr;
  }

  Result<std::unique_ptr<RunObservation>> Observe(ObserverHandler& handler) override {
    Result<ParticipantKeys> keys = KeysOf(network_);  // first: the observer's keys are no older
    if (!keys.ok()) return keys.error();
    Result<std::unique_ptr<SessionObserver>> observer = ObserveSession(network_, handler);
    if (!observer.ok()) return observer.error();
    return std::unique_ptr<RunObservation>(
        std::make_unique<SessionObservation>(network_, std::move(keys).value(), std::move(observer).value()));
  }

  bool can_run_again() const override { return runs_again_; }
  void RunAgain(std::optional<std::uint64_t> seed) override {
    fmt::print("{}\n", RunAgainLine(seed));
    std::fflush(stdout);
  }

  bool has_recording() const override { return journal_.has_value(); }
  std::optional<std::string> ReadRecording() override {
    if (!journal_) return std::nullopt;
    Result<std::string> bytes = ReadWholeFile(journal_->recording, kMaxRecordingBytes);
    return bytes.ok() ? std::optional(std::move(bytes).value()) : std::nullopt;
  }

  // Exceptions of DDS end here: the page gets an answer in every case.
  Result<ControlReply> Ask(const control::Request& request) override {
    try {
      if (Status missing = control_.WaitForService(kDiscoverySeconds); !missing.ok()) return missing.error();
      return control_.Call(request, kReplySeconds);
    } catch (const std::exception& exception) {
      return FailureOf(exception);
    }
  }

 private:
  class SessionObservation : public RunObservation {
   public:
    SessionObservation(const NetworkSettings& network, ParticipantKeys keys, std::unique_ptr<SessionObserver> observer)
        : network_(network), keys_(std::move(keys)), observer_(std::move(observer)) {}
    // The keys of a run disappear with it, while its last frames may be on their way.
    bool IsOutdated() override {
      const Result<ParticipantKeys> now = KeysOf(network_);
      return now.ok() && now.value() != ParticipantKeys() && now.value() != keys_;
    }

   private:
    const NetworkSettings& network_;
    const ParticipantKeys keys_;
    const std::unique_ptr<SessionObserver> observer_;
  };

  const NetworkSettings network_;
  const std::optional<JournalFiles> journal_;
  const bool runs_again_;
  ControlClient control_;
};

// The token of the page's address. A run that only its user may control must not be open to other users of the host by
// its page. The same for all viewers of a run with a token, so that a page connects to the next viewer, too.
std::string TokenOf(const NetworkSettings& network) {
  if (network.security == kSecurityOff) return "";
  const Result<ParticipantKeys> keys = KeysOf(network);
  if (!keys.ok() || !keys.value().token) return MakeToken();
  return keys.value().token->Proof("the page of its viewer").substr(0, MakeToken().size());
}

// A token that its owner has made, so that a scraper can have it, too. It has to stay a token in a URL.
Result<std::string> ReadToken(const std::string& file) {
  constexpr std::size_t kMinLength = 16;
  constexpr std::size_t kMaxLength = 100;
  const std::string_view allowed = "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ-._~";
  Result<std::string> token = ReadWholeFile(file, kMaxLength + 2);
  if (!token.ok()) return Error{{file}, "cannot read: " + token.error().message};
  std::string& text = token.value();
  while (text.ends_with('\n') || text.ends_with('\r')) text.pop_back();
  if (text.size() < kMinLength || text.size() > kMaxLength || text.find_first_not_of(allowed) != std::string::npos) {
    return Error{{file},
                 fmt::format("found {} bytes, expected a token of {} to {} letters, digits and -._~", text.size(),
                             kMinLength, kMaxLength)};
  }
  return token;
}

// An address that the user has given is used or refused; only the default one may move to another port.
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

// A run may begin later than its viewer, so a session that is not there is no error.
void SayWhetherItWaits(const NetworkSettings& network) {
  ControlClient client(network);
  if (client.WaitForService(kSimilarSeconds).ok()) return;
  PrintPlain(stderr, "waits for session '{}'{}\n", network.session, SimilarSession(network));
}

int ServeUntilStopped(const Result<std::unique_ptr<ViewerGateway>>& gateway, SignalWatch& signals,
                      const NetworkSettings* named = nullptr) {
  if (!gateway.ok()) return Fail(gateway.error());
  fmt::print("{}\n", StyledLine(std::string(kPageLine) + gateway.value()->Address(), HasStyles(stdout)));
  std::fflush(stdout);
  if (named != nullptr) SayWhetherItWaits(*named);
  pollfd waited = {signals.descriptor(), POLLIN, 0};
  while (!signals.ReadStopRequest()) poll(&waited, 1, -1);
  // The launcher ends the viewer of a run with the run, whose last frame is on its way.
  for (int ms = 0; ms < kEndMilliseconds && !gateway.value()->HasShownEnd(); ms += kPollMilliseconds) {
    poll(nullptr, 0, kPollMilliseconds);
  }
  return kExitDone;
}

// After "run again" the page's port and token are those of the run before, so that open pages reconnect.
// `is_named`: the user has named the session.
int ServeRun(const ViewOptions& options, std::string token, ShownExpectations expectations, SignalWatch& signals,
             bool is_named) {
  DdsRunLink link(options.network, options.journal, options.runs_again);
  ViewerGatewayOptions gateway_options = OptionsOfGateway(options);
  if (options.expect.empty() && !options.scenario.empty()) expectations = ExpectationsOfRun(options.scenario);
  gateway_options.expectations = std::move(expectations);
  gateway_options.session = options.network.session;
  gateway_options.token = token.empty() ? TokenOf(options.network) : std::move(token);
  gateway_options.command = options.run_command;
  if (const std::optional<PageAddress> before = options.runs_again ? PageOfPreviousRun() : std::nullopt) {
    gateway_options.port = before->port;
    gateway_options.token = before->token;
  }
  return ServeUntilStopped(ViewerGateway::Start(gateway_options, link), signals, is_named ? &options.network : nullptr);
}

// The timeline steps the recording again on demand: a page can go to any tick of it.
int ServeRecording(const ViewOptions& options, std::string token, ShownExpectations expectations,
                   SignalWatch& signals) {
  Result<Recording> recording = Recording::Open(options.file);
  if (!recording.ok()) return Fail(recording.error());
  if (options.expect.empty()) expectations = ExpectationsOf(recording.value());
  WorldCache worlds(EncodeWorld);
  const Result<std::unique_ptr<SteppedTimeline>> timeline =
      SteppedTimeline::Create(std::move(recording).value(), worlds);
  if (!timeline.ok()) return Fail(timeline.error());
  const std::optional<std::string>& damage = timeline.value()->damage();
  if (damage) PrintPlain(stderr, "{}: warning: {}; it is shown up to there\n", options.file, *damage);
  ViewerGatewayOptions gateway_options = OptionsOfGateway(options);
  gateway_options.expectations = std::move(expectations);
  gateway_options.session = std::filesystem::path(options.file).filename().string();
  gateway_options.token = token.empty() ? MakeToken() : std::move(token);
  return ServeUntilStopped(ViewerGateway::Start(gateway_options, *timeline.value()), signals);
}

// No token: the sender chooses no address, and the page can change nothing.
int ServeStates(const ViewOptions& options, SignalWatch& signals) {
  const Result<std::unique_ptr<StreamedRun>> run = StreamedRun::Open(STDIN_FILENO);
  if (!run.ok()) return Fail(run.error());
  ViewerGatewayOptions gateway_options = OptionsOfGateway(options);
  gateway_options.session = "simulation";
  gateway_options.view_only = true;
  return ServeUntilStopped(ViewerGateway::Start(gateway_options, *run.value()), signals);
}

int WriteRecording(const ViewOptions& options, ShownExpectations expectations) {
  const Result<Recording> recording = Recording::Open(options.file);
  if (!recording.ok()) return Fail(recording.error());
  if (const std::optional<mcap::Damage>& damage = recording.value().damage()) {
    PrintPlain(stderr, "{}: warning: {}; it is shown up to there\n", options.file, damage->problem);
  }
  if (options.expect.empty()) expectations = ExpectationsOf(recording.value());
  const Status written = WriteStaticPage(recording.value(), expectations, options.page);
  return written.ok() ? kExitDone : Fail(written.error());
}

// Recordings and worlds have different contents in a page, but the same options.
int WriteFile(const ViewOptions& options) {
  if (options.file.empty()) {
    fmt::print(stderr, "error: --static: found no file, expected a recording, a world or a scenario\n");
    return kExitBadInput;
  }
  const auto inputs = [&] {
    std::vector<std::string> files = InputFilesOf(options.file, {});
    if (!options.expect.empty()) files.push_back(options.expect);
    return files;
  };
  if (const Status problem = CheckDistinct({{"-o", options.page.output}}, inputs); !problem.ok()) {
    return Fail(problem.error());
  }
  Result<ShownExpectations> expectations = ShownExpectations();
  if (!options.expect.empty()) expectations = ReadExpectations(options.expect);
  if (!expectations.ok()) return Fail(expectations.error());
  if (IsRecordingPath(options.file)) return WriteRecording(options, std::move(expectations).value());
  if (options.expect.empty()) expectations = ExpectationsOfRun(options.file);
  const Status written = WriteStaticPage(options.file, expectations.value(), options.page);
  return written.ok() ? kExitDone : Fail(written.error());
}

// What excludes each other is checked before the terminal or the network is used.
int ViewCommand(ViewOptions options) {
  if (options.is_static) return WriteFile(options);
  if (options.journal && !options.file.empty()) {
    return Fail(
        {{options.file}, "found a recording beside --journal, expected a session: a recording has its own past"});
  }
  if (!options.file.empty() && !IsRecordingPath(options.file)) {
    return Fail({{options.file},
                 "found a world, expected a session or a recording; troupe run FILE runs and shows it, and --static "
                 "writes a page that runs it"});
  }
  SignalWatch signals;
  // From that of the run, whose own may be any.
  setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + kNiceness);
  try {
    Result<std::string> token = std::string();
    if (!options.token_file.empty()) token = ReadToken(options.token_file);
    if (!token.ok()) return Fail(token.error());
    if (options.states) return ServeStates(options, signals);
    Result<ShownExpectations> expectations = ShownExpectations();
    if (!options.expect.empty()) expectations = ReadExpectations(options.expect);
    if (!expectations.ok()) return Fail(expectations.error());
    if (!options.file.empty()) {
      return ServeRecording(options, std::move(token).value(), std::move(expectations).value(), signals);
    }
    const bool is_named = !options.network.session.empty() && options.run_command.empty();
    if (const Status problem = SelectSession(options.network); !problem.ok()) return Fail(problem.error());
    return ServeRun(options, std::move(token).value(), std::move(expectations).value(), signals, is_named);
  } catch (const std::exception& exception) {
    return Fail(FailureOf(exception));
  }
}

// For programs that start this one: no help lists them.
void AddOptionsOfPrograms(CLI::App& command, const std::shared_ptr<ViewOptions>& options, CLI::Option* journal) {
  // The options of a launcher: its journals have no names, and its scenario need not have expectations.
  command.add_option("--scenario", options->scenario, "")->group("");
  command
      .add_option_function<std::vector<std::string>>(
          "--journal-tail",
          [options](const std::vector<std::string>& files) {
            options->journal->tail = {files[0], files[1]};
          },
          "")
      ->expected(2)
      ->needs(journal)
      ->group("");
  // The words of its command, as JSON.
  command
      .add_option_function<std::string>(
          "--run-command", [options](const std::string& text) { JsonReader::OfText(text).To(options->run_command); },
          "")
      ->group("");
  command.add_flag("--runs-again", options->runs_again, "")->group("");
  // Of a library, which starts the program (include/troupe/simulation_page.h).
  command.add_flag("--states", options->states, "")->group("");
}

}  // namespace

void AddViewCommand(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("view", "Show a run, or a recording of one, in a browser");
  const auto options = std::make_shared<ViewOptions>();
  command
      ->add_option_function<std::string>(
          "SESSION|FILE",
          [options](const std::string& name) { (IsFile(name) ? options->file : options->network.session) = name; },
          "Session of the run (default: the only one in the domain), or a recording (.mcap); with --static a "
          "recording, a world or a scenario")
      ->check(CLI::Validator([](std::string& text) { return IsFile(text) ? std::string() : SessionName()(text); }, ""));
  AddListenOption(*command, options->listen);
  command
      ->add_option(
          "--token-file", options->token_file,
          "File with the token of the page's address, which programs can share (default: another one for each run)")
      ->check(NotEmpty())
      ->type_name("FILE");
  CLI::Option* const journal =
      command
          ->add_option_function<std::string>(
              "--journal", [options](const std::string& file) { options->journal = JournalFiles::Of(file); },
              "Journal of the run, as of troupe run --journal: for its past from its start")
          ->check(NotEmpty())
          ->type_name("FILE");
  command
      ->add_option("--expect", options->expect,
                   "Test or scenario whose expectations the page judges (default: those of the run's scenario)")
      ->check(NotEmpty())
      ->type_name("FILE");
  AddOptionsOfPrograms(*command, options, journal);
  command->add_flag("--view-only", options->view_only, "Refuse requests that change the run");
  CLI::Option* const is_static = command->add_flag("--static", options->is_static,
                                                   "Write a page that needs no server: one file with the simulation, "
                                                   "which computes and proves a recording, or runs a scenario");
  CLI::Option* const output =
      command->add_option("-o,--output", options->page.output, "File of --static")->needs(is_static)->type_name("FILE");
  is_static->needs(output);
  command
      ->add_option("--module", options->page.module, "Folder with the WebAssembly module (default: the installed one)")
      ->needs(is_static)
      ->type_name("FOLDER");
  AddToolNetworkFlags(*command, options->network);
  command->final_callback([options, &exit_status] { exit_status = ViewCommand(*options); });
}

}  // namespace troupe
