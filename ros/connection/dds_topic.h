// DdsTopicWriter and DdsTopicReader: the endpoints of a RosParticipant. Its AddWriter and AddReader list them as those
// of a node.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "ros/connection/best_effort_writers.h"
#include "ros/connection/ros_connection.h"
#include "ros/connection/ros_participant.h"
#include "transport/dds/binding/entity.h"
#include "transport/dds/binding/listener.h"

namespace troupe::ros {

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
  void Take(const Consume& consume) override;

  RosParticipant& owner_;
  const Notices notices_;
  std::optional<BestEffortWriters> best_effort_writers_;  // none: from all writers
  dds::Entity topic_;
  dds::DataReaderListener listener_;
  dds::Entity reader_;
};

}  // namespace troupe::ros
