// Viewer: a client of the gateway, in the protocol of the page (page_viewer.h) or of Foxglove (foxglove_client.h): the
// state that it shows, and the messages that wait for it.
//
// A viewer is asked for its next message when its socket can send one, so that it can choose the newest state then.
// What it shows is either the live run, shared by all viewers (ShownRun), or a past state of its own.
//
// Threads: that of the web server, with all that viewers share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "viewer/gateway/page_messages.h"
#include "viewer/gateway/page_request.h"
#include "viewer/gateway/run_feed.h"
#include "viewer/gateway/web_server.h"

namespace troupe {

// The live run, as all viewers see it that are not in the past. Followed once per period, whatever the number of
// viewers.
struct ShownRun {
  // Messages of the page, as JSON.
  std::shared_ptr<const std::string> session;
  std::shared_ptr<const std::string> status;    // null: none yet
  std::shared_ptr<const std::string> timeline;  // as above: the spans of the past, of a run and of a recording
  FeedContent content;                          // of a recording: the events alone
  StateRows rows;                               // of the state
  std::uint64_t update = 0;                     // counts the versions of the content
  std::vector<TimeSpan> spans = {};             // of the timeline of a run

  // Reads the newest content of the feed, with its rows and its status.
  void Follow(const RunFeed& feed);
  // Describes the timeline of a run, where the page does not know it by the ends of the past in each update.
  void Describe(std::vector<TimeSpan> newest);
};

class Viewer {
 public:
  explicit Viewer(const ShownRun& run) : run_(run) {}
  virtual ~Viewer() = default;
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  // Applies a message of the viewer. The value is a request that the gateway is to execute, if there is one; the error
  // a message that no such client sends.
  virtual Result<std::optional<PageRequest>> Receive(std::string_view message, bool is_text) = 0;
  // The reply to a request.
  virtual void Answer(PageReply reply) = 0;
  // Next has a message.
  virtual bool NeedsMessage() const = 0;
  // Nothing: there is no message at present.
  virtual std::optional<WebMessage> Next() = 0;
  // The position to seek to now, of a viewer that plays a recording.
  virtual std::optional<std::uint64_t> PositionToShow() { return std::nullopt; }

  bool has_waiting() const { return !waiting_.empty(); }

  // It shows, or waits for, a past state.
  bool in_past() const { return in_past_; }
  void AwaitPast() { in_past_ = true; }
  void ShowPast(SharedState past) {
    past_ = std::move(past);
    past_is_new_ = true;
  }
  virtual void ReturnToLive() {
    in_past_ = past_is_new_ = false;
    past_.reset();
  }

 protected:
  // Null: none yet.
  const SharedState& shown() const { return in_past_ ? past_ : run_.content.state; }
  std::optional<WebMessage> NextWaiting() {
    if (waiting_.empty()) return std::nullopt;
    WebMessage message = std::move(waiting_.front());
    waiting_.pop_front();
    return message;
  }

  const ShownRun& run_;
  bool in_past_ = false;
  bool past_is_new_ = false;  // it was not sent yet
  std::deque<WebMessage> waiting_;

 private:
  SharedState past_;
};

}  // namespace troupe
