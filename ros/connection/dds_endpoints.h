// The endpoints of a node in ROS on DDS: topics and services, with the user data by which ROS 2 knows their types. Only
// ros-participant has them; the other processes have endpoints of the link (ros/link/host_connection.h) behind the same
// interfaces.
//
// Listeners run on threads of Cyclone DDS, at any time between construction and close. Each destructor therefore closes
// its entity, which waits for a running listener, before the members that the listener uses are destroyed. Constructors
// throw dds::Exception; Write never throws.
#pragma once

#include <dds/dds.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ros/connection/ros_connection.h"
#include "ros/connection/ros_participant.h"
#include "ros/connection/type_descriptions.h"
#include "transport/dds/binding/domain_participant.h"
#include "transport/dds/binding/entity.h"
#include "transport/dds/binding/loaned_samples.h"
#include "transport/dds/binding/qos.h"

namespace troupe::ros {

// Which implementation of DDS a participant has. RTPS 2.2, section 9.3.1.1: a GUID begins with the number of the
// vendor.
inline bool IsOfVendor(const dds_guid_t& participant, std::uint8_t number) {
  return participant.v[0] == 0x01 && participant.v[1] == number;
}
inline bool IsOfCyclone(const dds_guid_t& participant) {
  return IsOfVendor(participant, 0x10);
}
inline bool IsOfFastDds(const dds_guid_t& participant) {
  return IsOfVendor(participant, 0x0f);
}

// BestEffortWriters: which of the writers that match a reader are not reliable. A writer may have left when its message
// is read, so each is noted when it is discovered.
class BestEffortWriters {
 public:
  // REQUIRES: the reader exists while the other functions are called.
  explicit BestEffortWriters(dds_entity_t reader) : reader_(reader) {}

  // From any thread. `writer`: as in SubscriptionMatchedStatus; without effect if it is reliable, or has left.
  void Note(dds_instance_handle_t writer);
  bool Contains(dds_instance_handle_t writer);

 private:
  dds_entity_t reader_;
  std::mutex mutex_;
  std::set<dds_instance_handle_t> noted_;  // guarded by the mutex
};

// DdsTopicWriter and DdsTopicReader: the endpoints of a RosParticipant. Its AddWriter and AddReader list them as those
// of a node.

class DdsTopicWriter final : public TopicWriter {
 public:
  // Called on Cyclone's threads when a reader has come or gone.
  using OnMatched = std::function<void(bool wanted, bool is_new)>;

  // Throws dds::Exception. The participant must outlive this.
  DdsTopicWriter(RosParticipant& owner, const TopicSpec& spec, OnMatched on_matched = {});
  ~DdsTopicWriter() override;

  bool Write(const void* sample) noexcept override;

  dds_entity_t handle() const { return writer_.handle(); }

 private:
  void ReactToMatch(bool wanted, bool is_new);

  RosParticipant& owner_;
  const OnMatched on_matched_;
  dds::Entity topic_;
  dds::DataWriterListener listener_;
  dds::Entity writer_;
};

class DdsTopicReader final : public TopicReader {
 public:
  // Called on Cyclone's threads.
  struct Notices {
    std::function<void()> on_arrival;
    std::function<void()> on_missed_writer;
  };

  // Throws dds::Exception. The participant must outlive this.
  DdsTopicReader(RosParticipant& owner, const TopicSpec& spec, Part part, Notices notices = {});
  ~DdsTopicReader() override;

  dds_entity_t handle() const { return reader_.handle(); }

 private:
  void ConsumeArrived(const Consume& consume) override;

  RosParticipant& owner_;
  const Notices notices_;
  std::optional<BestEffortWriters> best_effort_writers_;  // none: from all writers
  dds::Entity topic_;
  dds::DataReaderListener listener_;
  dds::Entity reader_;
};

// DdsService: a service of a RosParticipant, as rmw_cyclonedds lays it out: two topics, whose types begin with the id
// of the caller and the number of its call. Callers on rmw_fastrtps send these two beside the message, where Cyclone's
// interface gives no access; their calls come from the side of ros-participant on Fast DDS.
class DdsService final : public ServiceServer {
 public:
  // Receives a request, and the participant that called, as endpoints on builtin topics name it; DDS_HANDLE_NIL: it has
  // left.
  using OnRequest = std::function<void(const void* request, dds_instance_handle_t caller)>;

  // Throws dds::Exception. The participant must outlive this. The handler is called on Cyclone's threads.
  DdsService(RosParticipant& owner, const ServiceSpec& spec, OnRequest on_request);
  ~DdsService() override;

  void Start() override;
  bool Respond(const void* response) noexcept override;

  // For AddReader and AddWriter of the participant.
  dds_entity_t request_reader() const { return reader_.handle(); }
  dds_entity_t response_writer() const { return writer_.handle(); }

 private:
  // Samples of one call of dds_take, with a flag for each handled one.
  struct Batch {
    dds::LoanedSamples<CallHeader> samples;
    std::vector<bool> handled;
  };

  void Serve();
  void Deliver(Batch& batch, std::size_t i);

  RosParticipant& owner_;
  const OnRequest on_request_;
  const std::string id_;
  dds::Entity request_topic_;
  dds::Entity response_topic_;
  std::mutex mutex_;  // guards waiting_
  dds::DataWriterListener writer_listener_;
  dds::DataReaderListener reader_listener_;
  dds::Entity writer_;
  dds::Entity reader_;
  std::list<Batch> waiting_;  // destroyed before reader_, which lent the samples
};

// The user data with which ROS marks an endpoint.

inline dds::UserData TypeUserData(Distribution distribution, const dds_topic_descriptor_t& type) {
  return {TypeMark(distribution, type.m_typename)};
}

template <typename T>
dds::UserData TypeUserData(Distribution distribution) {
  return TypeUserData(distribution, *dds::TopicTraits<T>::descriptor());
}

// A client recognizes the two endpoints of one service by their `id`.
inline dds::UserData ServiceUserData(Distribution distribution, const std::string& id,
                                     const dds_topic_descriptor_t& type) {
  return {"serviceid=" + id + ";" + TypeUserData(distribution, type).bytes};
}

}  // namespace troupe::ros
