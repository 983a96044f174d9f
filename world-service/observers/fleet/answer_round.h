// AnswerRound: how a run waits after a tick, until the answers of a fleet control to the messages of this tick have
// come.
//
// MQTT has no order between connections, and each vehicle has its own. So a round has three stages:
//   sending    each vehicle sends itself a message through the broker, behind those of the tick. When these have come
//              back, the broker has all messages of the tick;
//   answering  in lockstep the fleet control is asked, and says when it has answered; else no message comes for a time;
//   receiving  each vehicle sends itself another message. When these have returned, so have the answers, which the
//              broker had before.
// In lockstep no wall time has an influence, but for a broker that loses what vehicles send themselves.
//
// A value without connections and without a clock, which the gateway asks what to do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>

namespace troupe {

struct AnswerWait {
  double quiet_seconds = 0.0;  // of wall time, as all here: without a message, after a tick with a state of a vehicle
  bool is_lockstep = false;    // a fleet control says when it has answered, after each tick with a message of a vehicle

  bool waits() const { return is_lockstep || quiet_seconds > 0.0; }
};

class AnswerRound {
 public:
  static constexpr double kLongestEcho = 10.0;  // s, for what a vehicle sends itself
  static constexpr double kAskAgain = 1.0;      // s
  static constexpr double kMostWaits = 10.0;    // of the quiet time, while messages keep coming
  static constexpr double kLongAnswer = 5.0;    // s, until a run says that it waits

  enum class Act : std::uint8_t {
    kNone,
    kEcho,      // vehicles have to send themselves a message with `token`: Echoed follows
    kAsk,       // the fleet control has to be asked (again)
    kContinue,  // the round is over, and the run may go on
  };

  explicit AnswerRound(const AnswerWait& wait) : wait_(wait) {}

  // After the messages of a tick were handed over for sending.
  void Begin();
  bool is_over() const { return stage_ == Stage::kNone; }
  // Of the present messages of vehicles to themselves.
  std::uint64_t token() const { return token_; }

  // What is due at that time, s of any clock; once for each act.
  Act Next(double now);
  // s until Next is due again at the latest.
  double Rest(double now) const;

  // These clients have sent themselves the message.
  void Echoed(std::set<std::size_t> clients, double now);
  void Returned(std::size_t client, std::uint64_t token);
  void Lost(std::size_t client) { awaited_.erase(client); }  // it has no connection
  // The number of clients whose messages have not returned in time; each is counted once.
  std::size_t TakeMissing();
  // A message of a fleet control has come.
  void Heard(double now);
  // It has answered the tick.
  void Answered();
  // No fleet control answers any more: this round ends, and no other one begins.
  void End();
  // It has been asked for long, and has not answered: once for each round.
  bool TakeIsLate(double now);

 private:
  enum class Stage : std::uint8_t { kNone, kSending, kAnswering, kReceiving };

  void Enter(Stage stage);

  AnswerWait wait_;
  Stage stage_ = Stage::kNone;
  bool is_new_ = false;  // the stage has been entered, and nothing was done for it
  bool has_ended_ = false;
  std::uint64_t token_ = 0;
  std::set<std::size_t> awaited_;  // clients
  std::size_t missing_ = 0;
  double due_ = 0.0;     // s: the end of the stage for lack of echoes or of messages; when to ask again
  double latest_ = 0.0;  // s, of the quiet time; in lockstep when an answer is late
  bool has_told_late_ = false;
};

}  // namespace troupe
