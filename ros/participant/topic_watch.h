// TopicWatch: notes the messages on topics of any type, for a process whose ticks wait for them. After Arm the first
// message on each topic is told, once for each text that was armed.
//
// Where an agent of this host reads the topic, a message counts when it was passed to the agent: what the tick waits
// for is then with the agent before the tick continues. Other topics have a reader that knows no more of a message than
// its first byte, as soon as a writer shows the type.
//
// A text is the round of a wait: a message that came between two texts counts for the text that was armed when it came,
// and arming the text before again has its messages again. Rounds are those of the domain, not of a watch: a process
// that dies leaves its successor what has arrived, also between the two.
//
// A watch tells, too, whether a program that writes on its topic reads /clock: its messages may be those of a timer of
// simulated time.
//
// A watch may be of a node that answers on /world/tick_done by its name, too. Any watch is heard from its first message
// until the program that wrote its newest one has ended, though another program may write on the topic. One that is not
// heard is `present` once a program could write its first message: TickGate then holds no tick back for it any longer.
#pragma once

#include <dds/dds.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ros/connection/ros_participant.h"
#include "ros/messages/messages.h"
#include "transport/dds/binding/domain_participant.h"
#include "transport/dds/binding/entity.h"

namespace troupe::ros {

// TopicReaders: the topics that agents read, and the observer of their messages. From any thread.
class TopicReaders {
 public:
  void Add(const std::string& topic) {
    const std::lock_guard lock(mutex_);
    ++readers_[topic];
  }
  void Remove(const std::string& topic) {
    const std::lock_guard lock(mutex_);
    if (--readers_[topic] <= 0) readers_.erase(topic);
  }
  bool Contain(const std::string& topic) const {
    const std::lock_guard lock(mutex_);
    return readers_.contains(topic);
  }
  // A message was passed to an agent.
  void Note(const std::string& topic) const {
    const std::lock_guard lock(noting_);
    if (note_) note_(topic);
  }
  void Observe(std::function<void(const std::string& topic)> note) {
    const std::lock_guard lock(noting_);
    note_ = std::move(note);
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, int> readers_;  // by topic
  mutable std::mutex noting_;           // held while note_ runs
  std::function<void(const std::string&)> note_;
};

inline constexpr std::string_view kClockTopic = "rt/clock";

class TopicWatch {
 public:
  struct Callbacks {
    // A message has arrived for the text: once after each Arm, on any thread.
    std::function<void(const std::string& text)> on_arrival;
    // Whether a program that writes on the topic reads /clock, when that has changed; false at first. On the one
    // thread.
    std::function<void(bool is_timed)> on_timed;
  };

  // The participant and the readers outlive this. `wake`: Update has something to do; called on any thread.
  TopicWatch(const RosParticipant& participant, TopicReaders& agents, std::function<void()> wake);
  ~TopicWatch();
  TopicWatch(const TopicWatch&) = delete;
  TopicWatch& operator=(const TopicWatch&) = delete;

  using Time = std::chrono::steady_clock::time_point;
  // An announcement of a tick on /world/tick.
  struct Announced {
    std::int32_t seconds = 0;
    std::uint32_t nanoseconds = 0;
    std::string edition;  // its first entry, "edition:3"
  };
  // A watch that is not heard.
  struct Unheard {
    const void* owner;
    std::uint32_t id;
    bool is_node;
    bool is_present;
    std::set<dds_instance_handle_t> programs;  // with a writer on the topic, or one for answers of an unknown node
  };

  // A watch without a slash is of a node.
  static bool IsNode(std::string_view watched) { return watched.find('/') == std::string_view::npos; }

  // From one thread, as all below. The owner tells watches of different agents apart. `watched`: a topic
  // ("rt/anna/cmd_vel"), or the name of a node.
  void Add(const void* owner, std::uint32_t id, const std::string& watched, Callbacks callbacks);
  void Remove(const void* owner, std::uint32_t id);
  void RemoveAll(const void* owner);
  // The messages that were noted for the text are told, if it is the newest one or the one before.
  void Arm(const std::string& text);
  // Nodes are told of the tick whose text is armed: from now on an answer of theirs counts, if it is one to this.
  void Announce(const Announced& announced);
  // Whether each message and each answer that counts calls `wake`, too.
  void WakeOnArrival(bool wakes) { wakes_on_arrival_.store(wakes); }
  // Follows the writers that have become known or have ended: makes readers of topics whose types are known now.
  void Update();

  std::vector<Unheard> FindUnheard();
  bool is_all_heard();
  // Writers of answers whose nodes are not known.
  bool has_unknown_node();
  // The names of the services by which a program on Cyclone DDS tells the parameters of its nodes, each from its node's
  // own thread: "/driver/get_parameters".
  std::vector<std::string> ParameterServicesOf(dds_instance_handle_t program) const;
  // The topics that the programs read, and those of readers that have come since.
  std::set<std::string> FindRead(const std::set<dds_instance_handle_t>& programs, Time since) const;
  // The topics and nodes without a message for the armed text: among these watches of the owner, or, for null, among
  // all.
  std::set<std::string> FindMissing(const void* owner, const std::set<std::uint32_t>& ids);
  // The nodes that make no call for the armed text until others have answered or have called.
  std::set<std::string> FindWaiting();
  // Whether a message of this topic or node has come, and its writer has not ended.
  bool IsHeard(const std::string& watched);
  // The watches of the owner of these topics and nodes.
  std::set<std::uint32_t> IdsOf(const void* owner, const std::set<std::string>& watched);
  // What a program writes that is watched: topics, and the nodes that are known by their answers. `may_be_node`: it may
  // answer as a node that is not known.
  std::set<std::string> WatchedOf(dds_instance_handle_t program, bool& may_be_node);
  // When a writer or a reader of the domain has last come or gone.
  Time changed_at() const { return changed_at_; }

 private:
  struct AnyReader;
  struct AnswerReader;
  struct Watch {
    const void* owner;
    std::uint32_t id;
    Callbacks callbacks;
    bool is_timed = false;  // as it was told
  };
  struct Round {
    std::string text;                         // empty: none was armed
    std::set<std::string> arrived;            // topics, and nodes that have answered
    std::optional<Announced> announced = {};  // once nodes are told
    std::set<std::string> waiting = {};       // nodes
  };
  struct Writer {
    std::string topic;
    dds_instance_handle_t program;
  };
  struct Reader {
    std::string topic;
    dds_instance_handle_t program;
    Time came_at;
  };
  struct ParameterService {
    std::string name;
    dds_instance_handle_t program;
  };

  void Note(const std::string& watched);
  // REQUIRES: mutex_ is held.
  void NoteArrival(const std::string& watched);
  void NoteAnswer(const Header& answer, dds_instance_handle_t writer);
  void NoteWriter(const std::string& watched, dds_instance_handle_t writer);
  void FollowWriters();
  void FollowReaders();
  bool IsWatched(const std::string& topic);
  void Forget(const Writer& ended, dds_instance_handle_t handle);
  // REQUIRES: mutex_ is held. Of answers, whose nodes are not known.
  bool is_unknown(dds_instance_handle_t writer) const;
  std::size_t unknown_writers() const;
  void MakeReader(const dds_builtintopic_endpoint_t& writer);
  void TellTimed();
  // A process that has died leaves its readers to its successor, which adds its watches before it arms another text.
  void EndUnwatchedReaders();

  const RosParticipant& participant_;
  TopicReaders& agents_;
  const std::function<void()> wake_;
  std::map<std::string, std::unique_ptr<AnyReader>> readers_;  // by topic, of the one thread, as those below
  std::unique_ptr<AnswerReader> answers_;                      // once a node is watched
  std::map<dds_instance_handle_t, Writer> writers_;            // on watched topics
  std::map<dds_instance_handle_t, Reader> of_domain_;          // of topics, not of services
  std::map<dds_instance_handle_t, ParameterService> parameter_services_;
  Time changed_at_ = std::chrono::steady_clock::now();
  std::mutex mutex_;  // guards the four below
  Round round_;
  Round previous_;
  std::multimap<std::string, Watch> watches_;  // by topic or node
  // The writer of the newest message; null: it is not known.
  std::map<std::string, dds_instance_handle_t> heard_;
  std::atomic<bool> wakes_on_arrival_ = false;
  dds::DataReaderListener listener_;
  dds::Entity publications_;   // a reader of discovered writers
  dds::Entity subscriptions_;  // of discovered readers
};

}  // namespace troupe::ros
