#include "viewer/gateway/viewer_gateway.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/identity.h"
#include "common/base/json.h"
#include "viewer/gateway/foxglove_client.h"
#include "viewer/gateway/page_viewer.h"
#include "viewer/gateway/run_feed.h"

namespace troupe {
namespace {

// RequestQueue: performs the requests of viewers one after another, on a thread of its own: each may take long.
// Threads: any.
template <typename Request, typename Answer>
class RequestQueue {
 public:
  static constexpr std::size_t kMostWaiting = 32;  // requests; more are refused

  // Both functions are called on the thread of the queue; `on_answer` when DrainAnswers has some.
  RequestQueue(std::function<Answer(const Request&)> perform, std::function<void()> on_answer)
      : perform_(std::move(perform)), on_answer_(std::move(on_answer)), thread_([this] { Run(); }) {}
  ~RequestQueue() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  RequestQueue(const RequestQueue&) = delete;
  RequestQueue& operator=(const RequestQueue&) = delete;

  // False if too many requests wait.
  bool Add(ViewerId viewer, Request request) {
    {
      const std::lock_guard lock(mutex_);
      if (waiting_.size() >= kMostWaiting) return false;
      waiting_.emplace_back(viewer, std::move(request));
    }
    changed_.notify_all();
    return true;
  }
  // In place of the request of this viewer that waits, if there is one.
  void Replace(ViewerId viewer, Request request) {
    {
      const std::lock_guard lock(mutex_);
      const auto same =
          std::find_if(waiting_.begin(), waiting_.end(), [&](const auto& w) { return w.first == viewer; });
      if (same != waiting_.end()) {
        same->second = std::move(request);
      } else {
        waiting_.emplace_back(viewer, std::move(request));
      }
    }
    changed_.notify_all();
  }
  // Forgets the requests of a viewer that wait.
  void Remove(ViewerId viewer) {
    const std::lock_guard lock(mutex_);
    std::erase_if(waiting_, [&](const auto& waiting) { return waiting.first == viewer; });
  }

  std::vector<std::pair<ViewerId, Answer>> DrainAnswers() {
    const std::lock_guard lock(mutex_);
    return std::exchange(answers_, {});
  }

 private:
  void Run() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
      if (ending_) return;
      const auto [viewer, request] = std::move(waiting_.front());
      waiting_.pop_front();
      lock.unlock();
      Answer answer = perform_(request);
      lock.lock();
      answers_.emplace_back(viewer, std::move(answer));
      on_answer_();
    }
  }

  const std::function<Answer(const Request&)> perform_;
  const std::function<void()> on_answer_;
  std::mutex mutex_;  // guards the next three
  std::deque<std::pair<ViewerId, Request>> waiting_;
  std::vector<std::pair<ViewerId, Answer>> answers_;
  bool ending_ = false;
  std::condition_variable changed_;
  std::thread thread_;  // last
};

constexpr std::size_t kMostAwaited = 50;  // names in a status

// The status message of the page: the fields of the status, and `waiting_count`, because it names only some robots.
std::shared_ptr<const std::string> StatusText(std::optional<StatusMessage> status) {
  if (!status) return nullptr;
  const std::size_t count = status->waiting_for.size();
  status->waiting_for.resize(std::min(count, kMostAwaited));
  auto text = FieldsToJson<nlohmann::ordered_json>(*status);
  text["type"] = "status";
  text["waiting_count"] = count;
  return std::make_shared<const std::string>(JsonText(text));
}

// The viewers of a run or of a recording, and their requests. The web server calls it, on its thread.
class Viewers final : public WebHandler {
 public:
  // One of the two is not null. `wake`: lets the server call OnWake, from any thread.
  Viewers(const ViewerGatewayOptions& options, RunLink* link, Recorded* recording, const std::function<void()>& wake)
      : options_(options),
        is_recording_(recording != nullptr),
        past_(recording != nullptr ? static_cast<PastStates&>(*recording) : feed_.history()),
        seeks_([this](std::uint64_t position) { return past_.At(position); }, wake) {
    if (recording != nullptr) {
      for (const NumberedEvent& event : recording->Events()) run_.content.events.push_back(event);
    }
    if (link != nullptr) {
      follower_.emplace(*link, feed_);
      changes_.emplace([link](const Change& change) { return Executed(*link, change); }, wake);
    }
    NameSession();
  }

  // For any thread.
  bool have_seen_end() const { return have_seen_end_; }

  void OnPage() override {
    if (follower_) follower_->Expect();
  }
  void OnOpened(WebLoop& loop, ViewerId id, std::string_view protocol) override;
  void OnClosed(WebLoop& loop, ViewerId id) override;
  bool OnMessage(WebLoop& loop, ViewerId id, std::string_view message, bool is_text) override;
  std::optional<WebMessage> NextMessage(ViewerId id) override { return viewers_.at(id)->Next(); }
  void OnPeriod(WebLoop& loop) override;
  void OnWake(WebLoop& loop) override;

 private:
  using Change = std::variant<PageControl, PageEdit>;
  using Found = Result<std::shared_ptr<const ViewedState>>;

  static PageReply Executed(RunLink& link, const Change& change);
  std::size_t LongestRequest() const { return options_.editor ? kLongestEditRequest : kLongestPageRequest; }
  void NameSession();
  void Execute(WebLoop& loop, ViewerId id, PageRequest request);
  void Seek(ViewerId id, std::uint64_t position);
  void Answer(WebLoop& loop, ViewerId id, PageReply reply);
  // Why the request is refused; empty: it is not.
  std::string Refusal(const PageControl& control) const;
  std::string Refusal(const PageEdit& edit) const;

  const ViewerGatewayOptions& options_;
  const bool is_recording_;
  RunFeed feed_;  // of a live run
  PastStates& past_;
  ShownRun run_;
  PageReadings readings_;
  std::map<ViewerId, std::unique_ptr<Viewer>> viewers_;
  std::atomic<bool> have_seen_end_ = true;
  RequestQueue<std::uint64_t, Found> seeks_;
  std::optional<Follower> follower_;  // of a live run, as the next
  std::optional<RequestQueue<Change, PageReply>> changes_;
};

void Viewers::OnOpened(WebLoop& loop, ViewerId id, std::string_view protocol) {
  if (viewers_.empty()) loop.SetPeriod(1.0 / kUpdatesPerSecond);
  std::unique_ptr<Viewer>& viewer = viewers_[id];
  if (protocol == WebServer::kProtocols[0]) {
    viewer = std::make_unique<PageViewer>(run_, past_, readings_, LongestRequest());
  } else {
    const std::optional<PastStates::Range> range = is_recording_ ? past_.range() : std::nullopt;
    viewer = std::make_unique<FoxgloveClient>(run_, "Troupe " + options_.session, range);
  }
  have_seen_end_ = false;
  if (follower_) follower_->SetWanted(true);
  if (is_recording_) Seek(id, past_.range().value_or(PastStates::Range()).first);
}

void Viewers::OnClosed(WebLoop& loop, ViewerId id) {
  viewers_.erase(id);
  seeks_.Remove(id);
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

void Viewers::Execute(WebLoop& loop, ViewerId id, PageRequest request) {
  if (auto* const seek = std::get_if<SeekRequest>(&request)) {
    const std::optional<std::uint64_t> position = seek->position ? seek->position : past_.PositionOf(*seek->tick);
    if (position) Seek(id, *position);
  } else if (std::holds_alternative<LiveRequest>(request)) {
    if (!is_recording_) viewers_.at(id)->ReturnToLive();
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

std::string Viewers::Refusal(const PageControl& control) const {
  if (!changes_) return "a recording cannot be changed";
  const bool may = !options_.view_only || IsQuestion(control.request.command);
  return may ? "" : "this viewer only shows the run (--view-only)";
}

std::string Viewers::Refusal(const PageEdit& edit) const {
  if (!changes_ || !options_.editor) return "this page shows a run; troupe edit FILE edits a file";
  const Result<EditOperation>& operation = edit.operation;
  const bool may = !options_.view_only || (operation.ok() && IsQuestion(operation.value()));
  if (!may) return "this page only shows the file (--view-only)";
  return operation.ok() ? "" : operation.error().message;
}

PageReply Viewers::Executed(RunLink& link, const Change& change) {
  if (const auto* edit = std::get_if<PageEdit>(&change)) {
    return ReplyToEdit(edit->id, link.Edit(edit->operation.value()));
  }
  const auto& control = std::get<PageControl>(change);
  return ReplyToControl(control.id, link.Ask(control.request));
}

void Viewers::Seek(ViewerId id, std::uint64_t position) {
  viewers_.at(id)->AwaitPast();
  seeks_.Replace(id, position);
}

void Viewers::Answer(WebLoop& loop, ViewerId id, PageReply reply) {
  const auto known = viewers_.find(id);
  if (known == viewers_.end()) return;
  known->second->Answer(std::move(reply));
  loop.RequestMessage(id);
}

void Viewers::OnWake(WebLoop& loop) {
  if (changes_) {
    for (auto& [id, reply] : changes_->DrainAnswers()) Answer(loop, id, std::move(reply));
  }
  for (auto& [id, found] : seeks_.DrainAnswers()) {
    const auto known = viewers_.find(id);
    if (known == viewers_.end() || !known->second->in_past()) continue;
    if (!found.ok()) {
      Answer(loop, id, ReplyToControl(0, found.error()));
      continue;
    }
    known->second->ShowPast(std::move(found).value());
    loop.RequestMessage(id);
  }
}

void Viewers::OnPeriod(WebLoop& loop) {
  const std::shared_ptr<const ViewedState> before = run_.content.state;
  const std::optional<StatusMessage> status = run_.content.status;
  const std::uint64_t version = run_.content.version;
  feed_.Read(run_.content);
  if (run_.content.version != version) ++run_.update;
  const std::shared_ptr<const ViewedState>& state = run_.content.state;
  if (state != before && state != nullptr) {
    run_.rows.Assign(state->state, run_.update, before == nullptr || before->world != state->world);
  }
  if (run_.content.status != status) run_.status = StatusText(run_.content.status);
  NameSession();
  readings_.BeginPeriod();
  bool all_know = true;
  for (const auto& [id, viewer] : viewers_) {
    if (const auto position = viewer->PositionToShow()) Seek(id, *position);
    if (!viewer->NeedsMessage()) continue;
    loop.RequestMessage(id);
    all_know = false;
  }
  have_seen_end_ = all_know && (state == nullptr || run_.content.last);  // of a recording: there is none
}

void Viewers::NameSession() {
  const nlohmann::json session = {{"type", "session"},
                                  {"session", options_.session},
                                  {"view_only", options_.view_only},
                                  {"connected", run_.content.state != nullptr || is_recording_},
                                  {"recording", is_recording_},
                                  {"editor", options_.editor},
                                  {"problem", follower_ ? follower_->problem() : std::string()}};
  std::string text = JsonText(session);
  if (run_.session && text == *run_.session) return;
  run_.session = std::make_shared<const std::string>(std::move(text));
}

class RunGateway final : public ViewerGateway {
 public:
  // One of the two is not null.
  static Result<std::unique_ptr<ViewerGateway>> Start(const ViewerGatewayOptions& options, RunLink* link,
                                                      Recorded* recording) {
    const bool is_loopback = IsLoopback(options.address);
    WebServer::Options web;
    web.address = options.address;
    web.port = options.port;
    web.any_port = options.any_port;
    web.access.loopback_only = is_loopback;
    web.access.token = options.token.empty() && !is_loopback ? MakeToken() : options.token;
    if (!is_loopback) web.access.names = {HostName()};
    web.longest_text = options.editor ? kLongestEditRequest : kLongestPageRequest;
    web.files = options.files;
    Result<std::unique_ptr<WebServer>> server = WebServer::Create(web);
    if (!server.ok()) return server.error();
    return std::unique_ptr<ViewerGateway>(
        new RunGateway(options, web.access.token, std::move(server).value(), link, recording));
  }
  ~RunGateway() override { server_->Stop(); }  // before the viewers end, whose queues may wake it still

  std::string Address() const override {
    const std::string host = options_.address == "0.0.0.0" ? HostName() : options_.address;
    const std::string page = "http://" + host + ":" + std::to_string(server_->port()) + "/";
    return token_.empty() ? page : page + "?token=" + token_;
  }
  bool HasShownEnd() const override { return viewers_.have_seen_end(); }

 private:
  RunGateway(const ViewerGatewayOptions& options, std::string token, std::unique_ptr<WebServer> server, RunLink* link,
             Recorded* recording)
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

Result<std::unique_ptr<ViewerGateway>> ViewerGateway::Start(const ViewerGatewayOptions& options, Recorded& recording) {
  return RunGateway::Start(options, nullptr, &recording);
}

}  // namespace troupe
