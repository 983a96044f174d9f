// Endpoints of the participant that one agent after another uses: a writer, a reader and a service. Between two agents
// they are detached. So the nodes of ROS need not discover them again when the robots of an agent are rebuilt, as by a
// reset; and Cyclone DDS keeps some hundred bytes for each endpoint that has ended, as long as its participant lives.
//
// A sink is called on any thread, one call at a time, and never after Detach has returned.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ros/connection/dds_endpoints.h"
#include "ros/connection/ros_participant.h"
#include "ros/link/link.h"
#include "ros/messages/ros_options.h"

namespace troupe::ros {

// FastDdsSide: the services of this host for clients on Fast DDS, in a child process (ros/fast_dds). It is started
// again when it ends; calls that wait for their response then get none. All functions are called on one thread.
class FastDdsSide {
 public:
  using Clock = std::chrono::steady_clock;
  struct Sink {
    // Receives a call as the CDR bytes of its request, with a header.
    std::function<void(std::span<const std::byte> request)> on_request;
    std::function<void(const ServedContent& served)> on_served;  // the service has these endpoints from now on
  };

  // The arguments by which this program becomes the side: NetworkArguments, and this one.
  static constexpr const char* kFlag = "--fast-dds-side";
  static constexpr int kDescriptor = 3;  // of its end of the link

  // `report`: receives the ends of the process, one line each.
  FastDdsSide(const RosNetwork& network, std::function<void(const std::string&)> report);
  ~FastDdsSide();
  FastDdsSide(const FastDdsSide&) = delete;
  FastDdsSide& operator=(const FastDdsSide&) = delete;

  // Serves a service until Remove of the id that it returns.
  std::uint32_t Add(const MadeText& service, Sink sink);
  void Remove(std::uint32_t service);
  // Whether the response with a header of this client is one for the side, which it then gets.
  bool Respond(std::uint32_t service, std::uint64_t client_guid, std::span<const std::byte> response);

  // Readable when Process has something to do; -1: none. It changes with each start.
  int descriptor() const { return link_ ? link_->descriptor() : -1; }
  bool has_output() const { return link_ && link_->pending() > 0; }
  // Passes on what has arrived; notices the end of the process, and starts it again when that is due. True: services
  // have endpoints now.
  bool Process();
  // When Process is to be called in any case.
  std::optional<Clock::time_point> due() const { return due_; }

 private:
  struct Service {
    std::string text;
    Sink sink;
  };

  void Start();
  void Send(LinkKind kind, std::uint32_t id, std::span<const std::byte> content = {});

  const std::vector<std::string> arguments_;
  const std::function<void(const std::string&)> report_;
  std::uint64_t guid_ = 0;  // of the client in the headers of its calls; of each process another one
  pid_t child_ = 0;
  std::unique_ptr<Link> link_;  // null: not started
  std::optional<Clock::time_point> due_;
  Clock::time_point started_ = {};
  std::chrono::milliseconds delay_{0};  // of the next start
  std::uint32_t next_service_ = 0;
  std::map<std::uint32_t, Service> services_;
};

class ReusableWriter {
 public:
  using Sink = DdsTopicWriter::OnMatched;

  // Detached. The constructors throw dds::Exception; the participant must outlive this.
  ReusableWriter(RosParticipant& participant, const TopicSpec& spec);

  // Lists it as one of the node, and tells the sink now and at each change whether it has readers.
  void Attach(std::size_t node, Sink sink);
  // Readers that come later do not get its samples.
  void Detach();

  const dds_topic_descriptor_t& type() const { return type_; }
  const std::string& topic() const { return topic_; }
  bool is_volatile() const { return is_volatile_; }
  // REQUIRES: attached.
  DdsTopicWriter& writer() { return writer_; }

 private:
  RosParticipant& participant_;
  const std::string topic_;
  const dds_topic_descriptor_t& type_;
  const bool is_volatile_;  // keeps no samples
  std::mutex mutex_;        // guards the two below
  Sink sink_;
  bool has_new_ = false;  // a reader has come while it was detached
  DdsTopicWriter writer_;
};

class ReusableReader {
 public:
  struct Sink {
    // `is_again`: an agent before had the sample, or it is of the round before.
    std::function<void(std::span<const std::byte> sample, bool is_again)> on_sample;  // CDR
    std::function<void()> on_missed_writer;
  };

  ReusableReader(RosParticipant& participant, const TopicSpec& spec, Part part);

  // Passes the samples on that arrive from now on, or since the constructor; and those that are kept.
  void Attach(std::size_t node, Sink sink);
  void Detach();
  // Samples are kept from now on for the next agent, which has to apply those that the one before has lost: of this
  // round of a wait and of the one before. `is_new_run`: what is kept is not for the next rounds.
  void BeginRound(bool is_new_run);

  const std::string& topic() const { return topic_; }

 private:
  struct Kept {
    std::uint64_t round;
    bool was_passed;  // to an agent, or it is of a round before
    std::vector<std::byte> sample;
  };

  void Pass();

  RosParticipant& participant_;
  const std::string topic_;
  const dds_topic_descriptor_t& type_;
  const std::size_t depth_;
  const Part part_;
  std::mutex mutex_;  // guards all below but the last
  std::optional<Sink> sink_;
  bool used_ = false;        // was attached
  std::uint64_t round_ = 0;  // 0: nothing is kept
  std::deque<Kept> kept_;
  DdsTopicReader reader_;
};

class ReusableService {
 public:
  // Receives a request as its CDR bytes. `is_repeated`: an agent before had it. `caller`: as in DdsService, if it is
  // known.
  using Sink = std::function<void(std::span<const std::byte> request, bool is_repeated, dds_instance_handle_t caller)>;

  // `fast_dds`: serves it too; null: there is none.
  ReusableService(RosParticipant& participant, const ServiceSpec& spec, std::uint32_t domain, FastDdsSide* fast_dds,
                  bool on_cyclone);
  ~ReusableService();
  ReusableService(const ReusableService&) = delete;
  ReusableService& operator=(const ReusableService&) = delete;

  // Passes the requests on that arrive from now on, those that wait since the last Detach, and those that the agent
  // before has not answered: no client waits without end.
  void Attach(std::size_t node, Sink sink);
  void Detach();
  // From now on requests wait for the next Attach, also those that are returned: they were passed to the sink, and by
  // that to nothing. A returned one comes before those that wait.
  void StopPassing();
  void Return(std::vector<std::byte> request, dds_instance_handle_t caller);

  // Serves clients on Cyclone DDS, too, as the constructor does with `on_cyclone`.
  void ServeCyclone();

  // Whether a client waits for a response of the agent.
  bool has_unanswered() const {
    const std::lock_guard lock(mutex_);
    return !unanswered_.empty();
  }
  const dds_topic_descriptor_t& response() const { return response_; }
  // `bytes`: CDR of the response. False: it could not be written.
  bool Respond(const void* response, std::span<const std::byte> bytes);

 private:
  using Bytes = std::vector<std::byte>;
  struct Waiting {
    Bytes request;
    dds_instance_handle_t caller;
  };

  void ListServed(const ServedContent& served);
  // Lists the endpoints as those of the node, if there is one, and no longer.
  void List();
  void Unlist();
  void Pass(std::span<const std::byte> request, dds_instance_handle_t caller = DDS_HANDLE_NIL);
  void PassOfFastDds(std::span<const std::byte> request);
  // REQUIRES: mutex_ is held.
  void KeepUnanswered(Bytes request);

  RosParticipant& participant_;
  const ServiceSpec spec_;
  const dds_topic_descriptor_t& request_;
  const dds_topic_descriptor_t& response_;
  std::optional<std::size_t> node_;                      // while attached
  std::optional<ServedContent> served_;                  // by the side on Fast DDS
  mutable std::mutex mutex_;                             // guards the four below
  Sink sink_;                                            // while attached
  std::size_t returned_ = 0;                             // since StopPassing, at the front of waiting_
  std::deque<Waiting> waiting_;                          // requests
  std::deque<std::pair<CallHeader, Bytes>> unanswered_;  // that an agent was passed
  FastDdsSide* const fast_dds_;
  std::uint32_t fast_id_ = 0;          // with fast_dds_
  std::optional<DdsService> cyclone_;  // none: clients on Cyclone DDS are not served, or not yet
};

}  // namespace troupe::ros
