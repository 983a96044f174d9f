// ViewerGateway: shows a run, or a recording of one, to browsers. It follows the run as an observer (run_feed.h),
// serves the page, and sends each viewer the world, then updates: at most kUpdatesPerSecond, each the difference from
// the viewer's last one. A viewer that is slow skips updates, and delays nothing.
//
// Threads: one of the web server, on which all viewers are served and nothing waits; one for changes of the run, one
// for questions about the past, one that observes the run. Requests that change something go through RunLink::Ask to
// the service, as those of `troupe ctl`: the gateway has no power that a tool lacks.
//
// Without viewers it observes nothing and costs a run nothing.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/spatial/scene_cache.h"
#include "recording/timeline/timeline.h"
#include "transport/protocol/transport.h"
#include "troupe/result.h"
#include "viewer/gateway/edit_operation.h"
#include "viewer/gateway/expectation_rows.h"
#include "viewer/gateway/web_server.h"

namespace troupe {

// An observer that follows a run until it is destroyed; no handler call runs any more then.
class RunObservation {
 public:
  virtual ~RunObservation() = default;
  // The run has other keys than this observation began with, for instance because it began later: another observation
  // is needed. Does not wait.
  virtual bool IsOutdated() { return false; }
};

// RunLink: the gateway's connection to a run, over any transport.
class RunLink {
 public:
  virtual ~RunLink() = default;

  // Begins to follow the run, which need not exist yet. The handler outlives the observation.
  virtual Result<std::unique_ptr<RunObservation>> Observe(ObserverHandler& handler) = 0;

  // The run is followed without viewers, too, so that they have its past: it has no journal that could be read.
  virtual bool follows_always() const { return false; }
  // The run so far, of its journal. Null: there is none. May take a while. On any thread; the cache outlives the
  // result.
  virtual std::shared_ptr<RecordedTimeline> ReadJournal(WorldCache& worlds) {
    (void)worlds;
    return nullptr;
  }

  // The whole file of the journal, for a run that is over. Nothing: there is none, or it is too large to be sent.
  virtual std::optional<std::string> ReadRecording() { return std::nullopt; }
  virtual bool has_recording() const { return false; }

  // Whether RunAgain has an effect: the run is started again, once it is over, by the program that has started it. With
  // its own seed, or another one. On the thread of the server.
  virtual bool can_run_again() const { return false; }
  virtual void RunAgain(std::optional<std::uint64_t> seed) { (void)seed; }

  // Sends a request to the run's service and waits for the reply. Called on one thread, another one than Observe.
  virtual Result<ControlReply> Ask(const control::Request& request) = 0;

  // An operation of the editor's page (viewer/editor), and an object for the reply. On the thread of Ask.
  virtual Result<nlohmann::json> Edit(const EditOperation& operation) {
    (void)operation;
    return Failure("this page shows a run; troupe edit FILE edits a file");
  }
};

inline constexpr std::uint16_t kViewerPort = 8470;
inline constexpr int kUpdatesPerSecond = 60;

struct ViewerGatewayOptions {
  std::string session;                    // for the page
  std::string address = "127.0.0.1";      // IPv4 to listen on
  std::uint16_t port = kViewerPort;       // 0: any
  bool any_port = true;                   // if the port is in use, another one
  bool view_only = false;                 // refuses requests that change the run
  bool editor = false;                    // the page edits a file: requests may be as long as its text
  std::vector<std::string> command = {};  // that started the run, for the page; empty: it is not known
  ShownExpectations expectations = {};    // of the run's scenario, for rows under the timeline
  std::string token = {};                 // of the page's address; empty: none on a loopback address, else a random one
  std::shared_ptr<SceneCache> scenes = {};  // of the process; null: no service is in it
  std::span<const PageFile> files = PageFiles();
};

class ViewerGateway {
 public:
  // Serves until the gateway is destroyed. The link or the recording must outlive it.
  static Result<std::unique_ptr<ViewerGateway>> Start(const ViewerGatewayOptions& options, RunLink& link);
  static Result<std::unique_ptr<ViewerGateway>> Start(const ViewerGatewayOptions& options, RecordedTimeline& recording);
  virtual ~ViewerGateway() = default;

  // The URL of the page, with the token.
  virtual std::string Address() const = 0;

  // True if each viewer has received the end of the run, or there are no viewers. For a gateway that ends with its run.
  virtual bool HasShownEnd() const = 0;
};

}  // namespace troupe
