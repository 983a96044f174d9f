// RosWriter<T> and RosReader<T>: a node's end of a topic. Neither ever throws while the simulation runs: a sample that
// cannot be written is counted (RosParticipant::lost) and forgotten.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "common/dds/data_reader.h"
#include "common/dds/data_writer.h"
#include "common/ros_dds/ros_participant.h"
#include "common/ros_dds/topic_types.h"
#include "common/ros_dds/type_hash.h"

namespace troupe::ros {

// With the type's hash, which ROS 2 from Iron on looks for and warns about when there is nothing.
template <typename T>
dds::UserData TypeUserData() {
  return {"typehash=" + TypeHash(dds::TopicTraits<T>::descriptor()->m_typename) + ";"};
}

template <typename T>
class RosWriter {
 public:
  RosWriter(const RosNode& node, const std::string& name, const dds::Qos& qos)
      : participant_(node.participant),
        topic_(participant_->participant(), "rt" + node.Resolve(name)),
        writer_(participant_->publisher(), topic_, dds::Qos(qos) << TypeUserData<T>()) {
    dds::DataWriterListener listener;
    listener.on_publication_matched = [wanted = wanted_](const dds::PublicationMatchedStatus& status) {
      wanted->store(status.current_count > 0, std::memory_order_relaxed);
    };
    writer_.set_listener(std::move(listener));
    if (writer_.publication_matched_status().current_count > 0) *wanted_ = true;  // they came before
    participant_->AddWriter(node.index, writer_.handle());
  }

  // Somebody reads it: worth making a message. Costs next to nothing, because it is asked for each topic at each tick.
  bool wanted() const { return wanted_->load(std::memory_order_relaxed); }

  void Write(const T& message) noexcept {
    if (dds_write(writer_.handle(), &message) != DDS_RETCODE_OK) participant_->CountLost();
  }

 private:
  RosParticipant* participant_;
  dds::Topic<T> topic_;
  std::shared_ptr<std::atomic<bool>> wanted_ = std::make_shared<std::atomic<bool>>(false);
  dds::DataWriter<T> writer_;
};

template <typename T>
class RosReader {
 public:
  RosReader(const RosNode& node, const std::string& name, const dds::Qos& qos)
      : topic_(node.participant->participant(), "rt" + node.Resolve(name)),
        reader_(node.participant->subscriber(), topic_, dds::Qos(qos) << TypeUserData<T>()) {
    dds::DataReaderListener listener;
    listener.on_data_available = [came = came_] { came->store(true); };
    reader_.set_listener(std::move(listener));
    node.participant->AddReader(node.index, reader_.handle());
  }

  // Calls `take` with each message that came since the last call. Costs next to nothing when none has.
  template <typename Take>
  void Drain(const Take& take) {
    if (!came_->load()) return;
    came_->store(false);  // before taking: what comes now is taken, or counts for the next call
    try {
      for (;;) {
        const dds::LoanedSamples<T> samples = reader_.take();
        if (samples.empty()) return;
        for (const auto sample : samples) {
          if (sample.info().valid()) take(sample.data());
        }
      }
    } catch (const dds::Exception&) {  // out of memory; what is left comes with the next call
      came_->store(true);
    }
  }

 private:
  dds::Topic<T> topic_;
  std::shared_ptr<std::atomic<bool>> came_ = std::make_shared<std::atomic<bool>>(true);  // something, perhaps
  dds::DataReader<T> reader_;
};

}  // namespace troupe::ros
