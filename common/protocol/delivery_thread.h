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
  ~DeliveryThread();  // what is still queued is dropped
  DeliveryThread(const DeliveryThread&) = delete;
  DeliveryThread& operator=(const DeliveryThread&) = delete;

  Target AddTarget();
  // Drops what is queued for the target; none of its calls runs any more when this returns (but one that calls this).
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
  // Moves what is due from later_ to now_.
  void TakeDue();

  std::mutex mutex_;
  std::condition_variable work_;  // something was posted, or it is time to end
  std::condition_variable done_;  // a call ended
  std::deque<Call> now_;
  std::multimap<Clock::time_point, Call> later_;
  std::set<Target> targets_;
  std::optional<Target> running_;  // whose call is running
  Target next_target_ = 1;
  bool ending_ = false;
  std::thread thread_;  // last, so that it starts when everything else is there
};

}  // namespace troupe
