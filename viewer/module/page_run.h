// PageRun: a run inside a page: the world service and the agent of its robots on one thread, by the same protocol as
// between processes, so that it has the hashes of `troupe run` and executes the same requests. Their messages wait in a
// queue.
//
// A queue and not calls: the coordinator and the agents' protocol may not be entered from inside each other. Wall time
// serves for pacing only; leases and deadlines are infinite, because a browser may suspend a page for hours.
//
// It acts only inside Work and Request.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/spatial/scene_cache.h"
#include "transport/protocol/transport.h"
#include "troupe/result.h"
#include "world-service/service/run_observer.h"
#include "world-service/service/run_service.h"
#include "world-service/service/tick_coordinator.h"
#include "worldfile/load_world.h"

namespace troupe {

class PageRun {
 public:
  // Starts the run of a world or a scenario, with its own seed or another one, at real time or the speed that it has
  // for viewers. Adds its scenes to the page's. The observer, which outlives the run, receives all sessions,
  // frames and statuses. The error is one of the file, or a world that cannot run in a page.
  static Result<std::unique_ptr<PageRun>> Start(const std::string& file, std::optional<std::uint64_t> seed,
                                                const std::shared_ptr<SceneCache>& scenes, ObserverHandler& observer);
  ~PageRun();
  PageRun(const PageRun&) = delete;
  PageRun& operator=(const PageRun&) = delete;

  // Does what is due, for about as long at most, wall time in s. Returns the time until more is due; 0: it is now.
  double Work(double seconds);
  // Executes a request, and replies once, now or in a call of Work.
  void Request(const control::Request& request, const ControlReplyTo& reply);

  std::uint64_t seed() const { return coordinator_->scene()->world().seed; }
  // The failure that has ended the run.
  const Status& failure() const { return coordinator_->error(); }

 private:
  // The endpoints put messages into the queue, in place of a network.
  class Service;
  class Agent;
  using Message = std::function<void(double now)>;

  PageRun(LoadedWorld loaded, const std::string& file, const LoadOverrides& overrides,
          const std::shared_ptr<SceneCache>& scenes, ObserverHandler& observer);
  // Robots by name; empty: all.
  void AddAgent(const std::vector<std::string>& robots);
  void WorkOfAgents(double now);
  // Status for the page twice in a second; events are in the frames.
  void Report(double now);
  double NextDue() const;

  ObserverHandler& observer_;
  ServiceOptions service_;
  PhaseTimes phase_times_;
  std::deque<Message> messages_;
  std::shared_ptr<const SessionMessage> session_;  // the newest; null before
  std::unique_ptr<Service> endpoint_;
  std::unique_ptr<TickCoordinator> coordinator_;
  std::vector<std::unique_ptr<Agent>> agents_;
  AgentId newest_agent_ = 0;
  double next_status_ = 0.0;  // wall time, s
};

}  // namespace troupe
