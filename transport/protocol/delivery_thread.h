// DeliveryThread: one thread that makes calls for its targets, one at a time, in the order in which they were posted or
// when their delay is over. Made for transports: a target is the receiving end of one endpoint.
//
// Any thread may call, also from inside a call that is being delivered.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

namespace troupe {

class DeliveryThread {
 public:
  using Target = std::uint64_t;

  DeliveryThread();
  ~DeliveryThread();  // drops the queued calls
  DeliveryThread(const DeliveryThread&) = delete;
  DeliveryThread& operator=(const DeliveryThread&) = delete;

  Target AddTarget();
  // Drops the calls queued for the target. When it returns, none of the target's calls runs, but the one that calls
  // this.
  void RemoveTarget(Target target);

  void Post(Target target, std::function<void()> call, double delay_seconds = 0.0);

  // Waits until nothing is queued without delay and no call runs, at most `seconds`. Returns at once inside a call.
  void WaitUntilIdle(double seconds);

 private:
  using Clock = std::chrono::steady_clock;
  struct Call {
    Target target;
    std::function<void()> call;
  };

  void Run();
  // Moves the calls that are due from later_ to now_.
  void QueueDue();

  std::mutex mutex_;
  std::condition_variable work_;  // something was posted, or it is time to end
  std::condition_variable done_;  // a call ended
  std::deque<Call> now_;
  std::multimap<Clock::time_point, Call> later_;
  std::set<Target> targets_;
  std::optional<Target> running_;  // the target of the running call
  Target next_target_ = 1;
  bool ending_ = false;
  std::thread thread_;  // last, so that it starts when all other members exist
};

}  // namespace troupe
