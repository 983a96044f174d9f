// TickAnswers: whether ticks wait for participants in ROS, and which of these have answered. It has no connections and
// no clock, so that each transition can be tested; RosLockstepWait tells it what happens.
//
// The stage of the run:
//
//   kIdle            --Publish: the agents have published a tick-->           kAwaitingAnswers
//   kAwaitingAnswers --Release: none is awaited-->                             kIdle
//   kAwaitingAnswers --Withdraw: an edit or a reset has made another frame--> kIdle
//   kIdle            --SetArming: ROS is not prepared for the next tick-->     kAwaitingArming
//   kAwaitingArming  --SetArming: it is, or is overdue-->                      kIdle
//
// The answer of a participant, a topic or a node:
//
//                a tick is published   its answer to the tick   another answer   the tick reaches the limit
//   kNeverHeard  -                     kDone                    kAwaited         -: it is still starting
//   kAwaited     -                     kDone                    -                kDropped, or the run ends
//   kDone        kAwaited              -                        -                -
//   kDropped     -                     kDone                    kAwaited         -
//
// A tick waits for those that are kNeverHeard or kAwaited. So one that is dropped is awaited again once it is heard of.
//
// A tick may be held back after it is published, because a participant is not there that has never been heard of, or is
// starting (TickGate). The limit counts meanwhile for those only that are known to be absent, and for the others from
// the time at which they are told.
//
// Timers of simulated time are due when the time has advanced. At the first tick, at one that is published again after
// an edit, and after a reset they write nothing, and a tick that waited for their topic would wait for ever. Nothing
// tells such a topic from one whose node is slow but its silence: so at a tick whose time stands, a topic that is
// silent for the limit although a program that reads /clock writes it is taken for one that `follows_time`. From then
// on ticks whose time stands do not wait for it.
//
// Times are wall times in seconds of one clock. A participant is called by the ROS domain and the name. Not safe for
// use by several threads.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "troupe/ids.h"
#include "troupe/result.h"
#include "world-service/service/run_observer.h"

namespace troupe {

class TickAnswers {
 public:
  enum class Stage : std::uint8_t { kIdle, kAwaitingAnswers, kAwaitingArming };
  enum class Answer : std::uint8_t { kNeverHeard, kAwaited, kDone, kDropped };
  // Of the published tick to the participants.
  enum class Delivery : std::uint8_t { kUnknown, kHeld, kTold };
  // The domain, and a topic ("/anna/cmd_vel") or the name of a node.
  using Name = std::pair<std::uint32_t, std::string>;

  struct Options {
    double limit = 0.0;  // s; 0: none
    bool ends_at_limit = true;
    // The service before has released a tick: so the first participants have answered it, or were dropped.
    bool were_heard = false;
  };
  // `report`: a line for users.
  TickAnswers(const Options& options, std::function<void(const std::string& line)> report)
      : options_(options), report_(std::move(report)) {}

  static bool IsTopic(const Name& name) { return name.second.starts_with("/"); }

  Stage stage() const { return stage_; }
  // The tick that was published last.
  Tick tick() const { return tick_; }

  // From now on ticks wait for these.
  void SetParticipants(const std::set<Name>& names);
  void Publish(Tick tick, double now);
  void Withdraw() { stage_ = Stage::kIdle; }
  // The run asks whether the next tick may be made; not while answers are awaited.
  void SetArming(bool awaits) {
    if (stage_ != Stage::kAwaitingAnswers) stage_ = awaits ? Stage::kAwaitingArming : Stage::kIdle;
  }

  // The participant has answered the published tick; or something else.
  void OnAnswer(const Name& name, double now);
  // It had answered the tick before that was edited, while it was awaited: the answer of one that follows the time
  // counts, because it gives no other one.
  void OnAnswerBeforeEdit(const Name& name, double now);
  void OnOtherAnswer(const Name& name);
  // Whether a program that writes on the topic reads /clock.
  void SetReadsClock(const Name& topic, bool reads_clock, double now);

  bool Has(const Name& name) const { return participants_.contains(name); }
  bool is_awaited(const Name& name) const;
  bool are_complete() const;  // no participant is awaited
  // The published tick holds calls of services by these, until others have answered or have called: no limit counts
  // meanwhile for them.
  void SetCalling(const std::set<Name>& calling, double now);
  // How many have been dropped so far.
  std::uint64_t drops() const { return drops_; }
  // `absent`: those among the awaited for which it is held back because no program is there that could answer.
  void SetDelivery(Delivery delivery, const std::set<Name>& absent, double now);
  // The names that the tick waits for, after the limit was applied. The error ends the run. REQUIRES: kAwaitingAnswers.
  Result<std::vector<std::string>> Awaited(double now);
  // REQUIRES: kAwaitingAnswers.
  void Release();

  // The participants for which ticks have waited, longest first.
  std::vector<SlowRobot> Slowest() const;

 private:
  struct Participant {
    Answer answer = Answer::kNeverHeard;
    bool follows_time = false;
    std::optional<double> reads_clock_since = {};  // a program that writes on the topic
    bool is_calling = false;
    double called_until = 0.0;  // when a call of it was executed
    std::uint64_t times_last = 0;
    double waited_seconds = 0.0;
  };

  bool IsAwaited(const Participant& participant) const;
  // The end of a line about one that is awaited.
  std::string CallsThatWait() const;
  // Changes the answer of one that the tick has awaited for too long. The error ends the run.
  Status ApplyLimit(const Name& name, Participant& participant, double now);

  const Options options_;
  const std::function<void(const std::string&)> report_;
  Stage stage_ = Stage::kIdle;
  std::map<Name, Participant> participants_;
  bool has_participants_ = false;  // SetParticipants was called
  std::uint64_t drops_ = 0;
  bool has_reported_ = false;  // that the first answers are awaited
  Tick tick_ = 0;
  double published_at_ = 0.0;  // or told, if it was held back
  Delivery delivery_ = Delivery::kUnknown;
  std::set<Name> absent_;
  std::optional<Tick> released_;  // the last tick that was
  bool time_stands_ = true;       // the tick is not later than that
};

}  // namespace troupe
