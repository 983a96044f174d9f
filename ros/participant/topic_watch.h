// TopicWatch: notes the messages on topics of any type, for a process whose ticks wait for them. After Arm the first
// message on each topic is told, once for each text that was armed.
//
// Where an agent of this host reads the topic, a message counts when it was passed to the agent: what the tick waits
// for is then with the agent before the tick continues. Other topics have a reader that knows no more of a message than
// its first byte, as soon as a writer shows the type.
// A text is the round of a wait: a message that came between two texts counts for the text that was armed when it came,
// and arming the text before again has its messages again.
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "ros/connection/ros_participant.h"
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

class TopicWatch {
 public:
  // Called on any thread, for each watch once after Arm.
  using OnArrival = std::function<void(const std::string& text)>;

  // The participant and the readers outlive this. `wake`: Update has something to do; called on any thread.
  TopicWatch(const RosParticipant& participant, TopicReaders& agents, std::function<void()> wake);
  ~TopicWatch();
  TopicWatch(const TopicWatch&) = delete;
  TopicWatch& operator=(const TopicWatch&) = delete;

  // From one thread. The owner tells watches of different agents apart.
  void Add(const void* owner, std::uint32_t id, const std::string& topic, OnArrival on_arrival);
  void Remove(const void* owner, std::uint32_t id);
  void RemoveAll(const void* owner);
  // The messages that were noted for the text are told again, if it is the newest one or the one before: the agent may
  // be the successor of one that has died.
  void Arm(const std::string& text);
  // Makes the readers of topics whose types have become known.
  void Update();

 private:
  struct AnyReader;
  struct Watch {
    const void* owner;
    std::uint32_t id;
    OnArrival on_arrival;
    std::string text;             // that was armed
    bool arrived = false;         // a message for it
    bool arrived_before = false;  // for the text before
  };

  void Note(const std::string& topic);

  const RosParticipant& participant_;
  TopicReaders& agents_;
  const std::function<void()> wake_;
  std::map<std::string, std::unique_ptr<AnyReader>> readers_;  // by topic, of the one thread
  std::mutex mutex_;                                           // guards the three below
  std::string armed_;
  std::string previous_;
  std::multimap<std::string, Watch> watches_;  // by topic
  dds::DataReaderListener listener_;
  dds::Entity publications_;  // a reader of discovered writers
};

}  // namespace troupe::ros
