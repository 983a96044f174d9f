// PageHost: in a page without a gateway, the place of the gateway: a recording, its one viewer, and the comparison of
// all of its states. The functions at the end are those that the page's worker (page_worker.js) calls.
#include <emscripten.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "common/base/json.h"
#include "launcher/commands/recorded_states.h"
#include "viewer/gateway/page_texts.h"
#include "viewer/gateway/page_viewer.h"
#include "viewer/gateway/past_reader.h"
#include "world-service/replay/replayed_world.h"

namespace troupe {
namespace {

// Steps a recording from its start, and compares the hash of each state with the recorded one.
class Proof {
 public:
  explicit Proof(const Recording& recording) : recording_(recording), world_(recording), reader_(recording) {}

  // Goes on for about as long.
  void Continue(std::chrono::duration<double, std::milli> time) {
    const auto end = std::chrono::steady_clock::now() + time;
    while (!done_ && std::chrono::steady_clock::now() < end) Advance();
  }

  nlohmann::json ToJson() const {
    nlohmann::json json = {{"type", "proof"}, {"done", done_}, {"equal", equal_}, {"problem", problem_}};
    if (!problem_.empty()) json["tick"] = tick_.tick;
    return json;
  }

 private:
  void Advance() {
    const Result<bool> more = reader_.Next(tick_);
    if (!more.ok()) return End(more.error().message);
    if (!more.value()) return End(recording_.damage() ? recording_.damage()->problem : std::string());
    if (const Status problem = world_.Follow(tick_); !problem.ok()) return End(problem.error().message);
    ++equal_;
  }
  void End(const std::string& problem) {
    problem_ = problem;
    done_ = true;
  }

  const Recording& recording_;
  ReplayedWorld world_;
  TickReader reader_;
  RecordedTick tick_;
  std::uint64_t equal_ = 0;
  bool done_ = false;
  std::string problem_;  // empty: no difference
};

class PageHost {
 public:
  // The error is a file that is no recording, or of another version of the step.
  static Result<std::unique_ptr<PageHost>> Open(const std::string& path, const std::string& name) {
    Result<Recording> shown = Recording::Open(path);
    if (!shown.ok()) return shown.error();
    Result<Recording> compared = Recording::Open(path);
    if (!compared.ok()) return compared.error();
    std::unique_ptr<PageHost> host(new PageHost(std::move(compared).value()));
    Result<std::unique_ptr<RecordedStates>> states =
        RecordedStates::Create({std::move(shown).value(), {}, true}, host->shelf_);
    if (!states.ok()) return states.error();
    host->Show(std::move(states).value(), name);
    return host;
  }

  void Receive(const std::string& text) {
    Result<std::optional<PageRequest>> request = viewer_->Receive(text, true);
    if (!request.ok() || !request.value()) return;
    if (const auto* seek = std::get_if<SeekRequest>(&*request.value())) {
      wanted_ = seek->position ? seek->position : states_->PositionOf(*seek->tick);
      if (wanted_) viewer_->AwaitPast();
    } else if (const auto* series = std::get_if<SeriesRequest>(&*request.value())) {
      viewer_->Answer(reader_->Series(*series));
    } else if (const auto* totals = std::get_if<TotalsRequest>(&*request.value())) {
      viewer_->Answer(reader_->Totals(*totals));
    } else if (const auto* control = std::get_if<PageControl>(&*request.value())) {
      viewer_->Answer(ReplyToControl(control->id, Failure("a recording cannot be changed")));
    } else if (const auto* edit = std::get_if<PageEdit>(&*request.value())) {
      viewer_->Answer(ReplyToEdit(edit->id, Failure("this page shows a run; troupe edit FILE edits a file")));
    } else if (const auto* again = std::get_if<RunAgainRequest>(&*request.value())) {
      viewer_->Answer(ReplyToEdit(again->id, Failure("the run can only be started again by its command")));
    }
  }

  // The next message; false: there is none.
  bool Next() {
    readings_.BeginPeriod();
    if (wanted_) {
      Result<std::shared_ptr<const ViewedState>> found = states_->At(*std::exchange(wanted_, std::nullopt));
      if (found.ok()) {
        viewer_->ShowPast(std::move(found).value());
      } else {
        viewer_->Answer(ReplyToControl(0, found.error()));
      }
    }
    std::optional<WebMessage> message = viewer_->Next();
    if (message) message_ = std::move(*message);
    return message.has_value();
  }
  const WebMessage& message() const { return message_; }

  void ContinueProof(double milliseconds) {
    proof_.Continue(std::chrono::duration<double, std::milli>(milliseconds));
    nlohmann::json json = proof_.ToJson();
    json["states"] = states_->range()->last + 1;
    message_ = {std::make_shared<const std::string>(JsonText(json)), true};
  }

 private:
  explicit PageHost(Recording recording) : recording_(std::move(recording)), proof_(recording_) {}

  void Show(std::unique_ptr<RecordedStates> states, const std::string& name) {
    states_ = std::move(states);
    run_.content.events = states_->Events();
    run_.timeline = TimelineText(states_->Spans());
    const nlohmann::json session = {{"type", "session"},
                                    {"session", name},
                                    {"view_only", true},
                                    {"connected", true},
                                    {"recording", true},
                                    {"editor", false},
                                    {"command", nlohmann::json::array()},
                                    {"runs_again", false},
                                    {"saves_recording", false},
                                    {"problem", states_->damage().value_or("")}};
    run_.session = std::make_shared<const std::string>(JsonText(session));
    reader_.emplace(*states_);
    viewer_.emplace(run_, *states_, readings_, kLongestPageRequest);
    wanted_ = 0;
    viewer_->AwaitPast();
  }

  const Recording recording_;  // that is compared
  Proof proof_;
  WorldShelf shelf_;
  std::unique_ptr<RecordedStates> states_;
  ShownRun run_;
  PageReadings readings_;
  std::optional<PastReader> reader_;
  std::optional<PageViewer> viewer_;
  std::optional<std::uint64_t> wanted_;  // position to show
  WebMessage message_;
};

std::unique_ptr<PageHost> page_host;
std::string problem;

}  // namespace
}  // namespace troupe

extern "C" {

// The problem; an empty text: none. The other functions need one without.
EMSCRIPTEN_KEEPALIVE const char* troupe_open(const char* path, const char* name) {
  troupe::Result<std::unique_ptr<troupe::PageHost>> host = troupe::PageHost::Open(path, name);
  troupe::problem = host.ok() ? "" : host.error().ToString();
  if (host.ok()) troupe::page_host = std::move(host).value();
  return troupe::problem.c_str();
}

// A request of the page.
EMSCRIPTEN_KEEPALIVE void troupe_receive(const char* text) {
  troupe::page_host->Receive(text);
}

// 1: there is a message for the page; 0: none.
EMSCRIPTEN_KEEPALIVE int troupe_next() {
  return troupe::page_host->Next() ? 1 : 0;
}

// Compares further states; the message tells how many are equal.
EMSCRIPTEN_KEEPALIVE void troupe_continue_proof(double milliseconds) {
  troupe::page_host->ContinueProof(milliseconds);
}

// The message of the last of the two functions above.
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
