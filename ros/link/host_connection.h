// HostConnection: the connection of a process to ROS, through the participant of its host in a domain, which the
// program ros-participant has. Tools discover one participant for each host in place of one for each process: discovery
// in DDS costs the product of participants and endpoints, and a thousand agents with a participant each would keep any
// tool busy.
//
// The endpoints exist here at once, and there as soon as that program accepts the connection. When it ends, they are
// made again in the next one from the list of made parts, with the last samples of latched topics: the owner notices
// nothing but a gap. Writers never wait for it: beyond a limit of unsent bytes a stream keeps its newest sample only,
// since an old pose is of no use.
//
// A thread of the connection calls the handlers of services; samples arrive on it, and by Receive. Locks, outer first:
// executing_ (a handler runs) or changing_ (`changed` runs), then mutex_ (all state). Handlers and `changed` are called
// without mutex_, so that they may call this object; `on_arrival` of a reader is called with it, and must not.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/wake_event.h"
#include "ros/connection/ros_connection.h"
#include "ros/link/link.h"

namespace troupe::ros {

class HostConnection final : public RosConnection {
 public:
  // Whether a sample, an endpoint or its end is sent at once, or by Flush with all others since the last one. One that
  // flushes shows ticks: it reacts to ConsumeShowAgain.
  enum class Sending : std::uint8_t { kAtOnce, kByFlush };

  // `socket`: the name at which the program listens, or will. Throws std::system_error without resources.
  HostConnection(Distribution distribution, std::string socket, std::uint32_t domain, Sending sending);
  ~HostConnection() override;

  std::size_t AddNode(const std::string& node_namespace, const std::string& name) override;
  std::unique_ptr<TopicWriter> MakeWriter(std::size_t node, const TopicSpec& spec) override;
  std::unique_ptr<TopicReader> MakeReader(std::size_t node, const TopicSpec& spec, Part part,
                                          std::function<void()> on_arrival) override;
  std::unique_ptr<ServiceServer> MakeService(std::size_t node, const ServiceSpec& spec,
                                             ServiceServer::Handler handler) override;
  void Announce() override;
  // From now on DrainMismatches has the reports of RosParticipant::WatchDistributions.
  void WatchDistributions();
  std::vector<std::string> DrainMismatches() override;
  void Receive() override;
  void Flush() override;
  // Waits until the program has made all endpoints, and has told which have readers, with the messages kept for them;
  // for some seconds at most, or one without a program.
  void AwaitSettled();
  // Waits until all that was written has been passed to the program, or for a second: it may be dead.
  void AwaitSent();
  // Whether the program has asked since the last call to show the tick again to all readers; then ConfirmShown follows.
  bool ConsumeShowAgain() { return must_show_again_.exchange(false); }
  void ConfirmShown();

  // `changed` is called on the thread of the connection after messages have arrived: readers may have samples, and
  // watched() may have changed. It replaces the one before; with {} it returns after that one's last call.
  void WatchTopics(std::function<void()> changed);
  // The calls below are for a process whose ticks wait for ROS; WatchTopics comes before them.
  // Notes messages of any type on the topic ("rt/anna/cmd_vel"), or answers of the node ("driver"), from the next Arm
  // on. Returns its id, for Unwatch.
  std::uint32_t Watch(const std::string& watched);
  void Unwatch(std::uint32_t watch);
  // From now on messages count for `text`, unless they do already.
  void Arm(const std::string& text);
  // The tick whose text is armed is published: nodes may know of it.
  void Show();
  // Has all that other processes of this host have passed to the program by now written to ROS.
  void Collect();
  // Writes a std_msgs/Header by a latched writer of this connection, with the topics behind its text that have had
  // messages since Arm; not before the `awaited` watches, if they have never been heard of, can receive these. The
  // reader loses what has arrived before that: it is no answer.
  void Tell(const TopicWriter& writer, const void* header, const TopicReader& answers,
            const std::set<std::uint32_t>& awaited);
  // The tick of the newest Tell waits for these from now on.
  void Await(const std::set<std::uint32_t>& awaited);
  // The state of these. Lost with the program; then Arm, Collect, Tell and Watch are repeated by the connection.
  struct Watched {
    std::string armed;                // the newest text that the program knows
    std::set<std::uint32_t> arrived;  // watches with a message for that text
    std::string armed_before = {};    // the same of the text before
    std::set<std::uint32_t> arrived_before = {};
    std::set<std::uint32_t> timed;  // watches of topics that a program writes which reads /clock
    bool is_told = false;           // the newest Tell has been performed
    // Until then: it is held back, if that is known, and the awaited watches without a program.
    std::optional<std::set<std::uint32_t>> held_for = {};
    // Watches whose programs have called services: their calls wait until others have answered or have called.
    std::set<std::uint32_t> calling = {};
  };
  Watched watched();

 private:
  class Writer;
  class Reader;
  class Service;
  using Bytes = std::vector<std::byte>;
  struct Made {
    std::uint32_t id;
    std::string text;  // a MadeText
  };
  struct Request {
    std::uint32_t service;
    bool is_repeated;
    Bytes bytes;
  };

  void Run();
  // Until the link is broken, or the end.
  void Serve();
  // On the thread: connects, and sends all that has been made so far. False: nothing accepts.
  bool Open();
  void ExecuteRequests();
  void ReportArrivals();

  // REQUIRES of those below: mutex_ is held.
  void Send(LinkKind kind, std::uint32_t id, std::span<const std::byte> content = {});
  std::uint32_t Make(const MadeText& made);
  void Process(const LinkMessage& message);
  void ProcessWatched(const LinkMessage& message);
  void SendTell();
  void SendHeld();
  void ReceiveNow();
  void FlushNow();
  void Close();

  // Those below hold it.
  template <typename Endpoint>
  std::uint32_t AddEndpoint(const MadeText& made, std::map<std::uint32_t, Endpoint*>& endpoints, Endpoint* endpoint);
  void Remove(std::uint32_t id);

  const std::string socket_;
  const std::uint32_t domain_;
  const Sending sending_;
  const WakeEvent wake_;
  std::atomic<bool> stop_ = false;
  std::atomic<bool> must_show_again_ = false;
  std::mutex executing_;  // held while a handler runs, and by the end of a service
  std::mutex changing_;   // guards the one below, and is held while it runs
  std::function<void()> changed_;
  std::mutex mutex_;  // guards all below
  std::condition_variable settled_;
  bool is_settling_ = false;    // AwaitSettled waits
  std::unique_ptr<Link> link_;  // null: not connected. Only the thread replaces it
  bool broken_ = false;         // the thread is to close the link
  std::uint32_t next_id_ = 0;   // of the next part
  std::vector<Made> made_;      // in the sequence of making; a new participant is sent all of it
  bool announced_ = false;
  std::map<std::uint32_t, Writer*> writers_;
  std::map<std::uint32_t, Reader*> readers_;
  std::map<std::uint32_t, Service*> services_;
  std::map<std::uint32_t, Bytes> latched_;  // by writer, the last sample
  std::map<std::uint32_t, Bytes> held_;     // by writer of a stream, the newest sample that is to be sent
  std::deque<Request> requests_;
  std::vector<std::string> mismatches_;
  bool has_arrived_ = false;                     // a message, since the last call of changed_
  std::string arm_;                              // the newest
  int tells_ = 0;                                // calls of Tell that are not answered yet
  std::pair<std::uint32_t, Bytes> newest_tell_;  // its writer and content
  Bytes newest_awaited_;                         // of that
  std::uint32_t answers_ = 0;                    // its reader
  Watched watched_;
  std::thread thread_;  // last, because it uses all other members
};

}  // namespace troupe::ros
