#include "viewer/gateway/viewer_gateway.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/identity.h"
#include "common/base/or_failure.h"
#include "viewer/gateway/foxglove_client.h"
#include "viewer/gateway/metrics.h"
#include "viewer/gateway/page_texts.h"
#include "viewer/gateway/page_viewer.h"
#include "viewer/gateway/past_answers.h"
#include "viewer/gateway/request_queue.h"
#include "viewer/gateway/run_feed.h"

namespace troupe {
namespace {

// A page that is told of the end asks for a summary. The others are given up after this time.
constexpr int kPeriodsAtEnd = 2 * kUpdatesPerSecond;
constexpr std::string_view kRecordingPath = "/recording.mcap";
constexpr std::string_view kMetricsPath = "/metrics";
// A page that is loaded connects within this time; a scraper asks again within the other one.
constexpr auto kPageTime = std::chrono::seconds(5);
constexpr auto kScrapeTime = std::chrono::minutes(5);
constexpr ViewerId kNoViewer = 0;
// The viewers of a run or of a recording, and their requests. The web server calls it, on its thread.
class Viewers final : public WebHandler {
 public:
  // One of the two is not null. `wake`: lets the server call OnWake, from any thread.
  Viewers(const ViewerGatewayOptions& options, RunLink* link, RecordedTimeline* recording,
          const std::function<void()>& wake)
      : options_(options),
        link_(link),
        is_recording_(recording != nullptr),
        feed_(options.scenes),
        past_(recording != nullptr ? static_cast<Timeline&>(*recording) : feed_),
        answers_(past_, link, feed_, options.expectations),
        questions_([this](const PastQuestion& question) { return answers_.Answer(question); }, wake) {
    if (recording != nullptr) {
      run_.content.events = recording->Events();
      run_.timeline = TimelineText(recording->Spans()->all());
    }
    if (link != nullptr) {
      follower_.emplace(*link, feed_);
      changes_.emplace([link](const Change& change) { return Executed(*link, change); }, wake);
    }
    NameSession();
  }

  // For any thread.
  bool have_seen_end() const { return have_seen_end_; }

  // The discovery of a run takes about as long as a page needs to load, so that it begins with the request for the
  // page.
  void OnPage() override {
    if (follower_) follower_->Expect(kPageTime);
  }
  std::optional<WebDownload> OnDownload(std::string_view path) override;
  void OnOpened(WebLoop& loop, ViewerId id, std::string_view protocol) override;
  void OnClosed(WebLoop& loop, ViewerId id) override;
  bool OnMessage(WebLoop& loop, ViewerId id, std::string_view message, bool is_text) override;
  std::optional<WebMessage> NextMessage(ViewerId id) override { return viewers_.at(id)->Next(); }
  void OnPeriod(WebLoop& loop) override;
  void OnWake(WebLoop& loop) override;

 private:
  struct AgentsRequest {};  // for the slowest robot
  using Change = std::variant<PageControl, PageEdit, AgentsRequest>;
  using Changed = std::variant<PageReply, std::optional<SlowestRobot>>;

  static Changed Executed(RunLink& link, const Change& change);
  std::string Metrics();
  void Ask(WebLoop& loop, ViewerId id, std::uint64_t number, PastQuestion question);
  std::size_t LongestRequest() const { return options_.editor ? kMaxEditRequest : kMaxPageRequest; }
  void NameSession();
  bool RunsAgain() const { return link_ != nullptr && link_->can_run_again() && run_.content.last; }
  bool SavesRecording() const { return link_ != nullptr && link_->has_recording() && run_.content.last; }
  void Execute(WebLoop& loop, ViewerId id, PageRequest request);
  void Seek(ViewerId id, std::uint64_t position);
  void Answer(WebLoop& loop, ViewerId id, PageReply reply);
  // Why the request is refused; empty: it is not.
  std::string Refusal(const PageControl& control) const;
  std::string Refusal(const PageEdit& edit) const;
  std::string RefusalToRunAgain() const;

  const ViewerGatewayOptions& options_;
  RunLink* const link_;  // null: a recording is shown
  const bool is_recording_;
  RunFeed feed_;  // of a live run
  Timeline& past_;
  ShownRun run_;
  PageReadings readings_;
  std::map<ViewerId, std::unique_ptr<Viewer>> viewers_;
  std::atomic<bool> have_seen_end_ = true;
  std::set<ViewerId> summed_up_;  // that have the totals of the whole past
  int periods_at_end_ = 0;        // since all viewers know the end
  PastAnswers answers_;
  RequestQueue<PastQuestion, PastAnswer> questions_;  // with one thread for all
  std::optional<Follower> follower_;                  // of a live run, as the next
  std::optional<SlowestRobot> slowest_;
  bool asks_agents_ = false;
  std::optional<RequestQueue<Change, Changed>> changes_;
};

std::optional<WebDownload> Viewers::OnDownload(std::string_view path) {
  if (path == kMetricsPath && follower_) {
    return WebDownload{kMetricsType, std::make_shared<const std::string>(Metrics())};
  }
  if (path != kRecordingPath || !SavesRecording()) return std::nullopt;
  std::optional<std::string> content = link_->ReadRecording();
  if (!content) return std::nullopt;
  return WebDownload{"application/octet-stream", std::make_shared<const std::string>(std::move(*content))};
}

// Does not wait for the run: the slowest robot is that of the answer to the request before.
std::string Viewers::Metrics() {
  follower_->Expect(kScrapeTime);
  const auto [head, losses] = feed_.Head();
  if (head.state == nullptr) slowest_.reset();
  if (head.state != nullptr && !head.last && !asks_agents_) asks_agents_ = changes_->Add(kNoViewer, AgentsRequest());
  return MetricsText(options_.session, head, losses, slowest_);
}

// The period runs only while there are viewers.
void Viewers::OnOpened(WebLoop& loop, ViewerId id, std::string_view protocol) {
  if (viewers_.empty()) loop.SetPeriod(1.0 / kUpdatesPerSecond);
  std::unique_ptr<Viewer>& viewer = viewers_[id];
  if (protocol == WebServer::kProtocols[0]) {
    viewer = std::make_unique<PageViewer>(run_, past_, readings_, LongestRequest());
  } else {
    viewer =
        std::make_unique<FoxgloveClient>(run_, "Troupe " + options_.session, is_recording_ ? past_.Spans() : nullptr);
  }
  have_seen_end_ = false;
  if (follower_) follower_->SetWanted(true);
  if (is_recording_) Seek(id, past_.Spans()->first());
}

void Viewers::OnClosed(WebLoop& loop, ViewerId id) {
  viewers_.erase(id);
  summed_up_.erase(id);
  questions_.Remove(id);
  if (!viewers_.empty()) return;
  have_seen_end_ = true;
  if (follower_) follower_->SetWanted(false);
  loop.SetPeriod(0.0);
}

bool Viewers::OnMessage(WebLoop& loop, ViewerId id, std::string_view message, bool is_text) {
  Viewer& viewer = *viewers_.at(id);
  Result<std::optional<PageRequest>> request = viewer.Receive(message, is_text);
  if (!request.ok()) return false;
  if (request.value()) Execute(loop, id, std::move(*request.value()));
  if (viewer.has_waiting()) loop.RequestMessage(id);
  return true;
}

// Refusals are answered at once; what may take long goes to one of the queues.
void Viewers::Execute(WebLoop& loop, ViewerId id, PageRequest request) {
  if (auto* const seek = std::get_if<SeekRequest>(&request)) {
    const std::optional<std::uint64_t> position = seek->position ? seek->position : past_.Spans()->Last(*seek->tick);
    if (position) Seek(id, *position);
  } else if (std::holds_alternative<LiveRequest>(request)) {
    if (!is_recording_) viewers_.at(id)->ReturnToLive();
  } else if (auto* const series = std::get_if<SeriesRequest>(&request)) {
    Ask(loop, id, series->id, std::move(*series));
  } else if (auto* const totals = std::get_if<TotalsRequest>(&request)) {
    Ask(loop, id, totals->id, *totals);
  } else if (auto* const expectations = std::get_if<ExpectationsRequest>(&request)) {
    Ask(loop, id, expectations->id, *expectations);
  } else if (auto* const vehicle = std::get_if<VehicleRequest>(&request)) {
    Ask(loop, id, vehicle->id, std::move(*vehicle));
  } else if (auto* const again = std::get_if<RunAgainRequest>(&request)) {
    const std::string refusal = RefusalToRunAgain();
    if (refusal.empty()) link_->RunAgain(again->seed);
    Answer(
        loop, id,
        ReplyToEdit(again->id, refusal.empty() ? Result<nlohmann::json>(nlohmann::json::object()) : Failure(refusal)));
  } else if (auto* const edit = std::get_if<PageEdit>(&request)) {
    const std::uint64_t number = edit->id;
    std::string refusal = Refusal(*edit);
    if (refusal.empty() && !changes_->Add(id, std::move(*edit))) refusal = "too many requests wait";
    if (!refusal.empty()) Answer(loop, id, ReplyToEdit(number, Failure(refusal)));
  } else if (auto* const control = std::get_if<PageControl>(&request)) {
    const std::uint64_t number = control->id;
    std::string refusal = Refusal(*control);
    if (refusal.empty() && !changes_->Add(id, std::move(*control))) refusal = "too many requests wait for the run";
    if (!refusal.empty()) Answer(loop, id, ReplyToControl(number, Failure(refusal)));
  }
}

// A viewer that only shows may still ask, since a question changes nothing.
std::string Viewers::Refusal(const PageControl& control) const {
  if (!changes_) return "a recording cannot be changed";
  const bool may = !options_.view_only || control::KindOf(control.request) == RequestKind::kQuestion;
  return may ? "" : "this viewer only shows the run (--view-only)";
}

std::string Viewers::Refusal(const PageEdit& edit) const {
  if (!changes_ || !options_.editor) return "this page shows a run; troupe edit FILE edits a file";
  const Result<EditOperation>& operation = edit.operation;
  const bool may = !options_.view_only || (operation.ok() && IsQuestion(operation.value()));
  if (!may) return "this page only shows the file (--view-only)";
  return operation.ok() ? "" : operation.error().message;
}

std::string Viewers::RefusalToRunAgain() const {
  if (options_.view_only) return "this viewer only shows the run (--view-only)";
  return RunsAgain() ? "" : "the run can only be started again by its command";
}

Viewers::Changed Viewers::Executed(RunLink& link, const Change& change) {
  if (std::holds_alternative<AgentsRequest>(change)) {
    const Result<ControlReply> reply = link.Ask(control::Entities());
    return reply.ok() ? SlowestOf(reply.value().entities) : std::nullopt;
  }
  if (const auto* edit = std::get_if<PageEdit>(&change)) {
    return ReplyToEdit(edit->id, OrFailure([&] { return link.Edit(edit->operation.value()); }));
  }
  const auto& control = std::get<PageControl>(change);
  return ReplyToControl(control.id, OrFailure([&] { return link.Ask(control.request); }));
}

// A seek replaces the one before, and precedes the questions that wait.
void Viewers::Seek(ViewerId id, std::uint64_t position) {
  viewers_.at(id)->AwaitPast();
  questions_.Replace(id, position);
}

void Viewers::Ask(WebLoop& loop, ViewerId id, std::uint64_t number, PastQuestion question) {
  if (questions_.Add(id, std::move(question))) return;
  Answer(loop, id, ReplyToControl(number, Failure("too many questions about the past wait")));
}

void Viewers::Answer(WebLoop& loop, ViewerId id, PageReply reply) {
  const auto known = viewers_.find(id);
  if (known == viewers_.end()) return;
  if (reply.has_totals) summed_up_.insert(id);
  known->second->Answer(std::move(reply));
  loop.RequestMessage(id);
}

void Viewers::OnWake(WebLoop& loop) {
  if (changes_) {
    for (auto& [id, changed] : changes_->DrainAnswers()) {
      if (auto* const reply = std::get_if<PageReply>(&changed)) {
        Answer(loop, id, std::move(*reply));
      } else {
        slowest_ = std::get<std::optional<SlowestRobot>>(std::move(changed));
        asks_agents_ = false;
      }
    }
  }
  for (auto& [id, answer] : questions_.DrainAnswers()) {
    if (auto* const reply = std::get_if<PageReply>(&answer)) Answer(loop, id, std::move(*reply));
    auto* const found = std::get_if<FoundState>(&answer);
    const auto known = viewers_.find(id);
    if (found == nullptr || known == viewers_.end() || !known->second->in_past()) continue;
    if (!found->ok()) {
      Answer(loop, id, ReplyToControl(0, found->error()));
      continue;
    }
    known->second->ShowPast(std::move(*found).value());
    loop.RequestMessage(id);
  }
}

// One look at the feed for all viewers, then a message for each that needs one.
void Viewers::OnPeriod(WebLoop& loop) {
  run_.Follow(feed_);
  NameSession();
  if (!is_recording_) {
    run_.Describe(past_.Spans()->all());
    if (feed_.lacks_states() && answers_.WantsJournal()) questions_.Add(kNoViewer, JournalRequest());
  }
  readings_.BeginPeriod();
  bool all_know = true;
  for (const auto& [id, viewer] : viewers_) {
    if (const auto position = viewer->PositionToShow()) Seek(id, *position);
    if (!viewer->NeedsMessage()) continue;
    loop.RequestMessage(id);
    all_know = false;
  }
  const SharedState& state = run_.content.state;
  const bool is_over = state == nullptr || run_.content.last;  // a recording has no live state
  periods_at_end_ = all_know && is_over ? periods_at_end_ + 1 : 0;
  const bool know_all = std::all_of(viewers_.begin(), viewers_.end(),
                                    [this](const auto& viewer) { return summed_up_.contains(viewer.first); });
  have_seen_end_ = periods_at_end_ >= (state == nullptr || know_all ? 1 : kPeriodsAtEnd);
}

// A new pointer only for a new text: viewers compare pointers.
void Viewers::NameSession() {
  std::string text = SessionText(options_, {.connected = run_.content.state != nullptr || is_recording_,
                                            .recording = is_recording_,
                                            .runs_again = RunsAgain() && !options_.view_only,
                                            .saves_recording = SavesRecording(),
                                            .problem = follower_ ? follower_->problem() : std::string()});
  if (run_.session && text == *run_.session) return;
  run_.session = std::make_shared<const std::string>(std::move(text));
}

class RunGateway final : public ViewerGateway {
 public:
  // One of the two is not null.
  static Result<std::unique_ptr<ViewerGateway>> Start(const ViewerGatewayOptions& options, RunLink* link,
                                                      RecordedTimeline* recording) {
    const bool is_loopback = IsLoopback(options.address);
    WebServer::Options web;
    web.address = options.address;
    web.port = options.port;
    web.any_port = options.any_port;
    web.access.loopback_only = is_loopback;
    web.access.token = options.token.empty() && !is_loopback ? MakeToken() : options.token;
    if (!is_loopback) web.access.names = {HostName()};
    web.longest_text = options.editor ? kMaxEditRequest : kMaxPageRequest;
    web.files = options.files;
    Result<std::unique_ptr<WebServer>> server = WebServer::Create(web);
    if (!server.ok()) return server.error();
    return std::unique_ptr<ViewerGateway>(
        new RunGateway(options, web.access.token, std::move(server).value(), link, recording));
  }
  ~RunGateway() override { server_->Stop(); }  // before the viewers end, whose queues may wake it still

  // The name of this host in place of 0.0.0.0, which no browser can open elsewhere.
  std::string Address() const override {
    const std::string host = options_.address == "0.0.0.0" ? HostName() : options_.address;
    const std::string page = "http://" + host + ":" + std::to_string(server_->port()) + "/";
    return token_.empty() ? page : page + "?token=" + token_;
  }
  bool HasShownEnd() const override { return viewers_.have_seen_end(); }

 private:
  RunGateway(const ViewerGatewayOptions& options, std::string token, std::unique_ptr<WebServer> server, RunLink* link,
             RecordedTimeline* recording)
      : options_(options),
        token_(std::move(token)),
        server_(std::move(server)),
        viewers_(options_, link, recording, [this] { server_->Wake(); }) {
    server_->Serve(viewers_);
  }

  const ViewerGatewayOptions options_;
  const std::string token_;
  const std::unique_ptr<WebServer> server_;
  Viewers viewers_;
};

}  // namespace

Result<std::unique_ptr<ViewerGateway>> ViewerGateway::Start(const ViewerGatewayOptions& options, RunLink& link) {
  return RunGateway::Start(options, &link, nullptr);
}

Result<std::unique_ptr<ViewerGateway>> ViewerGateway::Start(const ViewerGatewayOptions& options,
                                                            RecordedTimeline& recording) {
  return RunGateway::Start(options, nullptr, &recording);
}

}  // namespace troupe
