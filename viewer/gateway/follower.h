// Follower: observes the run as long as there are viewers, and while one is expected. Otherwise the gateway has no DDS
// participant and receives nothing, so that it costs a run nothing.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "viewer/gateway/run_feed.h"
#include "viewer/gateway/run_link.h"

namespace troupe {

class Follower {
 public:
  // The link and the feed must outlive this.
  Follower(RunLink& link, RunFeed& feed);
  ~Follower();
  Follower(const Follower&) = delete;
  Follower& operator=(const Follower&) = delete;

  // Whether there are viewers. Does not wait.
  void SetWanted(bool wanted);
  // A viewer will probably come within seconds: the discovery of the run takes part of one. Does not wait.
  void Expect();
  // The reason why the run cannot be observed; empty: it is, or is not wanted.
  std::string problem() const;

 private:
  void Run();

  RunLink& link_;
  RunFeed& feed_;
  mutable std::mutex mutex_;  // guards the next four
  bool wanted_ = false;
  std::chrono::steady_clock::time_point wanted_until_;
  bool ending_ = false;
  std::string problem_;
  std::condition_variable changed_;
  std::thread thread_;  // last
};

}  // namespace troupe
