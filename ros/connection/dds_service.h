// DdsService: a service of a RosParticipant, as rmw_cyclonedds lays it out: two topics, whose types begin with the id
// of the caller and the number of its call. Callers on rmw_fastrtps send these two beside the message, where Cyclone's
// interface gives no access; their calls come from the side of ros-participant on Fast DDS.
#pragma once

#include <cstddef>
#include <list>
#include <mutex>
#include <string>
#include <vector>

#include "ros/connection/ros_connection.h"
#include "ros/connection/ros_participant.h"
#include "transport/dds/binding/entity.h"
#include "transport/dds/binding/listener.h"
#include "transport/dds/binding/loaned_samples.h"

namespace troupe::ros {

class DdsService final : public ServiceServer {
 public:
  // Throws dds::Exception. The participant must outlive this. The handler is called on Cyclone's threads.
  DdsService(RosParticipant& owner, const ServiceSpec& spec, Handler handler);
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
  const Handler handler_;
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

}  // namespace troupe::ros
