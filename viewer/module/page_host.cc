// PageHost: the gateway's place in a page without a gateway: a recording, whose states it steps and compares, or a run,
// and its one viewer. The functions at the end are those that the page's worker (page_worker.js) calls.
//
// One thread, the worker's: it calls troupe_work for some milliseconds at a time, then passes messages on to the page.
// So the page remains responsive while a recording of an hour is proved. The protocol to the page is the gateway's,
// byte by byte; the page does not know which of the two it talks to.
#include <emscripten.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "common/base/json.h"
#include "common/base/or_failure.h"
#include "testing/cases/value_path.h"
#include "viewer/gateway/page_texts.h"
#include "viewer/gateway/page_viewer.h"
#include "viewer/gateway/past_answers.h"
#include "viewer/module/page_run.h"
#include "viewer/module/scenario_values.h"
#include "world-service/replay/replayed_world.h"
#include "world-service/replay/stepped_timeline.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

// Steps a recording from its start, and compares the hash of each state with the recorded one.
// It has a reader of its own, so that the page can go to any state meanwhile.
class Proof {
 public:
  static Result<Proof> Begin(Recording recording) {
    auto shared = std::make_unique<const Recording>(std::move(recording));
    Result<ReplayCursor> cursor = ReplayCursor::At(*shared);
    if (!cursor.ok()) return cursor.error();
    return Proof(std::move(shared), std::move(cursor).value());
  }

  bool done() const { return done_; }
  // Continues for about as long, s.
  void Work(double seconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    do {
      Advance();
    } while (!done_ && std::chrono::steady_clock::now() < end);
  }

  // `states`: that are recorded.
  std::string Text(std::uint64_t states) const {
    Json json = {{"type", "proof"}, {"done", done_}, {"equal", equal_}, {"states", states}, {"problem", problem_}};
    if (!problem_.empty()) json["tick"] = tick_;
    return JsonText(json);
  }

 private:
  Proof(std::unique_ptr<const Recording> recording, ReplayCursor cursor)
      : recording_(std::move(recording)), cursor_(std::move(cursor)) {}
  void Advance() {
    const Result<const RecordedTick*> next = cursor_.Next();
    if (!next.ok()) return End(next.error().message);
    if (next.value() == nullptr) return End(recording_->damage() ? recording_->damage()->problem : std::string());
    tick_ = next.value()->tick;
    if (const Status problem = cursor_.Advance(); !problem.ok()) return End(problem.error().message);
    ++equal_;
  }
  void End(const std::string& problem) {
    problem_ = problem;
    done_ = true;
  }

  std::unique_ptr<const Recording> recording_;
  ReplayCursor cursor_;
  Tick tick_ = 0;  // that was reached last
  std::uint64_t equal_ = 0;
  bool done_ = false;
  std::string problem_;  // empty: no difference
};

class PageHost {
 public:
  // The file is a recording, or a world or a scenario, which begins to run. `name`: of the page. The error is a file
  // that cannot be shown.
  static Result<std::unique_ptr<PageHost>> Open(const std::string& file, const std::string& name,
                                                ShownExpectations expectations) {
    std::unique_ptr<PageHost> host(new PageHost(file));
    host->options_.session = name;
    host->options_.expectations = std::move(expectations);
    const Status failure = IsRecordingPath(file) ? host->OpenRecording() : host->OpenRun();
    if (!failure.ok()) return failure.error();
    return host;
  }

  // As Viewers of the gateway, for one viewer and without queues.
  void Receive(const std::string& text) {
    Result<std::optional<PageRequest>> request = viewer_->Receive(text, true);
    if (!request.ok() || !request.value()) return;
    if (const auto* seek = std::get_if<SeekRequest>(&*request.value())) {
      wanted_ = seek->position ? seek->position : past().Spans()->Last(*seek->tick);
      if (wanted_) viewer_->AwaitPast();
    } else if (std::holds_alternative<LiveRequest>(*request.value())) {
      if (run_) viewer_->ReturnToLive();
    } else if (const auto* series = std::get_if<SeriesRequest>(&*request.value())) {
      Answer(*series);
    } else if (const auto* totals = std::get_if<TotalsRequest>(&*request.value())) {
      Answer(*totals);
    } else if (const auto* expectations = std::get_if<ExpectationsRequest>(&*request.value())) {
      Answer(*expectations);
    } else if (const auto* vehicle = std::get_if<VehicleRequest>(&*request.value())) {
      Answer(*vehicle);
    } else if (const auto* control = std::get_if<PageControl>(&*request.value())) {
      Execute(*control);
    } else if (const auto* edit = std::get_if<PageEdit>(&*request.value())) {
      viewer_->Answer(ReplyToEdit(edit->id, Failure("this page shows a run; troupe edit FILE edits a file")));
    } else if (const auto* again = std::get_if<RunAgainRequest>(&*request.value())) {
      const Status started = RunAgain(*again);
      viewer_->Answer(ReplyToEdit(again->id, started.ok() ? Result<Json>(Json::object()) : started.error()));
    }
  }

  // Works for about as long at most. Returns the time until there is more to do, s; 0: now.
  double Work(double seconds) {
    double next = kPeriod;
    if (run_) {
      next = std::min(next, run_->Work(seconds));
      shown_.Follow(feed_);
      shown_.Describe(past().Spans()->all());
      NameSession();
    } else if (!proof_->done()) {
      proof_->Work(seconds);
      next = 0.0;
      messages_.push_back(proof_->Text(recorded_->Spans()->last() + 1));
    }
    readings_.BeginPeriod();
    return next;
  }

  // The next message; false: there is none.
  // Proof and scenario before the viewer's own messages. A seek is answered here, so that of several between two calls
  // only the newest costs time.
  bool Next() {
    if (!messages_.empty()) {
      message_ = {std::make_shared<const std::string>(std::move(messages_.front())), true};
      messages_.pop_front();
      return true;
    }
    if (wanted_) {
      const PastAnswer found = answers_->Answer(*std::exchange(wanted_, std::nullopt));
      const FoundState& state = std::get<FoundState>(found);
      if (!state.ok()) viewer_->Answer(ReplyToControl(0, state.error()));
      if (state.ok() && viewer_->in_past()) viewer_->ShowPast(state.value());
    }
    std::optional<WebMessage> message = viewer_->Next();
    if (message) message_ = std::move(*message);
    return message.has_value();
  }
  const WebMessage& message() const { return message_; }

 private:
  static constexpr double kPeriod = 1.0 / kUpdatesPerSecond;  // s

  explicit PageHost(std::string file) : file_(std::move(file)) {}

  Timeline& past() { return recorded_ ? static_cast<Timeline&>(*recorded_) : feed_; }

  // Two readers of the file: one for the page, one for the proof.
  Status OpenRecording() {
    Result<Recording> shown = Recording::Open(file_);
    if (!shown.ok()) return shown.error();
    Result<Recording> compared = Recording::Open(file_);
    if (!compared.ok()) return compared.error();
    Result<std::unique_ptr<SteppedTimeline>> recorded =
        SteppedTimeline::Create(std::move(shown).value(), feed_.worlds());
    if (!recorded.ok()) return recorded.error();
    recorded_ = std::move(recorded).value();
    Result<Proof> proof = Proof::Begin(std::move(compared).value());
    if (!proof.ok()) return proof.error();
    proof_.emplace(std::move(proof).value());
    shown_.content.events = recorded_->Events();
    shown_.timeline = TimelineText(recorded_->Spans()->all());
    MakeViewer();
    wanted_ = 0;
    viewer_->AwaitPast();
    return {};
  }

  Status OpenRun() {
    if (file_.ends_with(".json")) {
      Result<std::string> text = ReadTextFile(file_, {file_});
      if (!text.ok()) return text.error();
      Result<ScenarioText> scenario = ScenarioText::Parse(std::move(text).value(), file_);
      if (!scenario.ok()) return scenario.error();
      scenario_ = std::move(scenario).value();
    }
    if (Status failure = StartRun(); !failure.ok()) return failure;
    MakeViewer();
    return {};
  }

  void MakeViewer() {
    NameSession();
    answers_.emplace(past(), nullptr, feed_, options_.expectations);
    viewer_.emplace(shown_, past(), readings_, kMaxPageRequest);
  }

  // In the memory of the page, with values_.
  Status WriteScenario() {
    if (!scenario_) return {};
    const Result<std::string> text = scenario_->With(values_);
    if (!text.ok()) return text.error();
    std::ofstream(file_, std::ios::binary) << text.value();
    return {};
  }

  // With seed_ and values_.
  Status StartRun() {
    if (Status failure = WriteScenario(); !failure.ok()) return failure;
    Result<std::unique_ptr<PageRun>> run = PageRun::Start(file_, seed_, scenes_, feed_);
    if (!run.ok()) return run.error();
    const Result<std::string> text = ReadTextFile(file_, {file_});
    if (!text.ok()) return text.error();
    run_ = std::move(run).value();
    Json values = Json::array();
    for (const DrawnValue& value : values_) values.push_back({value.path, Json::parse(value.value)});
    messages_.push_back(
        JsonText(Json{{"type", "scenario"},
                      {"seed", run_->seed()},
                      {"text", text.value()},  // of the file that runs, with the changed values
                      {"values", scenario_ ? ChangeableValues(scenario_->tree().root()) : Json::array()},
                      {"changed", std::move(values)}}));
    return {};
  }

  // After an error all is as before.
  Status RunAgain(const RunAgainRequest& again) {
    if (!run_) return Failure("a recording cannot be run again");
    const std::optional<std::uint64_t> seed_before = seed_;
    const std::vector<DrawnValue> values_before = values_;
    if (again.seed) seed_ = again.seed;
    if (again.values) {
      values_.clear();
      for (const auto& [path, value] : *again.values) values_.push_back({path, value});
    }
    Status started = StartRun();
    if (started.ok()) {
      viewer_->ReturnToLive();
      wanted_.reset();
    } else {
      seed_ = seed_before;
      values_ = values_before;
      (void)WriteScenario();
    }
    return started;
  }

  void Execute(const PageControl& control) {
    if (!run_) return viewer_->Answer(ReplyToControl(control.id, Failure("a recording cannot be changed")));
    run_->Request(control.request,
                  [this, id = control.id](const ControlReply& reply) { viewer_->Answer(ReplyToControl(id, reply)); });
  }

  void Answer(const PastQuestion& question) { viewer_->Answer(std::get<PageReply>(answers_->Answer(question))); }

  void NameSession() {
    std::string problem;
    if (recorded_) problem = recorded_->damage().value_or("");
    if (run_ && !run_->failure().ok()) problem = run_->failure().error().ToString();
    std::string text = SessionText(options_, {.connected = true,
                                              .recording = recorded_ != nullptr,
                                              .runs_again = run_ && shown_.content.last,
                                              .problem = std::move(problem)});
    if (!shown_.session || *shown_.session != text) shown_.session = std::make_shared<const std::string>(text);
  }

  const std::string file_;
  ViewerGatewayOptions options_;
  const std::shared_ptr<SceneCache> scenes_ = std::make_shared<SceneCache>();
  RunFeed feed_{scenes_};  // of a run; of a recording its worlds alone
  ShownRun shown_;
  PageReadings readings_;

  // Of a recording.
  std::unique_ptr<SteppedTimeline> recorded_;
  std::optional<Proof> proof_;
  // Of a run.
  std::optional<ScenarioText> scenario_;  // as in the page's file; nothing: it is a world
  std::optional<std::uint64_t> seed_;     // nothing: the file's
  std::vector<DrawnValue> values_;        // in place of the scenario's
  std::unique_ptr<PageRun> run_;

  std::optional<PastAnswers> answers_;
  std::optional<PageViewer> viewer_;
  std::optional<std::uint64_t> wanted_;  // position to show
  std::deque<std::string> messages_;     // before messages of the viewer
  WebMessage message_;
};

std::unique_ptr<PageHost> page_host;
std::string problem;

}  // namespace
}  // namespace troupe

extern "C" {

// `expectations`: as of ToJson(ShownExpectations). The problem; an empty text: none. The other functions need one
// without.
EMSCRIPTEN_KEEPALIVE const char* troupe_open(const char* file, const char* name, const char* expectations) {
  auto host = troupe::OrFailure([&]() -> decltype(troupe::PageHost::Open(file, name, {})) {
    auto shown = troupe::ShownExpectationsFromJson(expectations);
    if (!shown.ok()) return shown.error();
    return troupe::PageHost::Open(file, name, std::move(shown).value());
  });
  troupe::problem = host.ok() ? "" : host.error().ToString();
  if (host.ok()) troupe::page_host = std::move(host).value();
  return troupe::problem.c_str();
}

// A request of the page.
EMSCRIPTEN_KEEPALIVE void troupe_receive(const char* text) {
  troupe::page_host->Receive(text);
}

// PageHost::Work.
EMSCRIPTEN_KEEPALIVE double troupe_work(double seconds) {
  return troupe::page_host->Work(seconds);
}

// 1: there is a message for the page; 0: none.
EMSCRIPTEN_KEEPALIVE int troupe_next() {
  return troupe::page_host->Next() ? 1 : 0;
}
EMSCRIPTEN_KEEPALIVE const char* troupe_message() {
  return troupe::page_host->message().content->data();
}
EMSCRIPTEN_KEEPALIVE unsigned troupe_message_size() {
  return static_cast<unsigned>(troupe::page_host->message().content->size());
}
EMSCRIPTEN_KEEPALIVE int troupe_message_is_text() {
  return troupe::page_host->message().is_text ? 1 : 0;
}

}  // extern "C"
