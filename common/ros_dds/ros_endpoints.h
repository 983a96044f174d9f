// RosWriter<T> and RosReader<T>: the endpoints of a node on a topic. Their constructors throw dds::Exception; no other
// call throws: a sample that cannot be written is counted (RosParticipant::lost) and dropped.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "common/dds/binding/data_reader.h"
#include "common/dds/binding/data_writer.h"
#include "common/ros_dds/best_effort_writers.h"
#include "common/ros_dds/ros_participant.h"
#include "common/ros_dds/topic_types.h"
#include "common/ros_dds/user_data.h"

namespace troupe::ros {

template <typename T>
class RosWriter {
 public:
  RosWriter(const RosNode& node, const std::string& name, const dds::Qos& qos)
      : participant_(node.participant),
        topic_(participant_->participant(), "rt" + node.Resolve(name)),
        writer_(participant_->publisher(), topic_, dds::Qos(qos) << TypeUserData<T>(participant_->distribution())) {
    dds::DataWriterListener listener;
    listener.on_publication_matched = [wanted = wanted_](const dds::PublicationMatchedStatus& status) {
      wanted->store(status.current_count > 0, std::memory_order_relaxed);
    };
    writer_.set_listener(std::move(listener));
    if (writer_.publication_matched_status().current_count > 0) *wanted_ = true;  // matched before the listener was set
    participant_->AddWriter(node.index, writer_.handle());
  }

  // Whether the topic has a reader, so that a message is worth making. One relaxed load, because each topic asks in
  // each tick.
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

// Of which matched writers a reader consumes messages. The second choice is for a best-effort reader beside a reliable
// one, because it matches reliable writers too.
enum class From : std::uint8_t { kAllWriters, kBestEffortWriters };

template <typename T>
class RosReader {
 public:
  RosReader(const RosNode& node, const std::string& name, const dds::Qos& qos, From from = From::kAllWriters)
      : topic_(node.participant->participant(), "rt" + node.Resolve(name)),
        reader_(node.participant->subscriber(), topic_,
                dds::Qos(qos) << TypeUserData<T>(node.participant->distribution())) {
    dds::DataReaderListener listener;
    listener.on_data_available = [arrived = arrived_] { arrived->store(true); };
    if (from == From::kBestEffortWriters) {
      best_effort_writers_ = std::make_shared<BestEffortWriters>(reader_.handle());
      listener.on_subscription_matched = [writers = best_effort_writers_](const auto& status) {
        writers->Note(status.last_publication_handle);
      };
    }
    reader_.set_listener(std::move(listener));
    node.participant->AddReader(node.index, reader_.handle());
  }

  // Calls `consume` with each message received since the last call. Without one it is a single load.
  template <typename Consume>
  void Drain(const Consume& consume) {
    if (!arrived_->load()) return;
    arrived_->store(false);  // before take(): a message that arrives now is consumed, or sets the flag again
    try {
      for (;;) {
        const dds::LoanedSamples<T> samples = reader_.take();
        if (samples.empty()) return;
        for (const auto sample : samples) {
          if (sample.info().valid() && Accepts(sample.info().publication_handle())) consume(sample.data());
        }
      }
    } catch (const dds::Exception&) {  // out of memory; the next call reads the remaining samples
      arrived_->store(true);
    }
  }

 private:
  bool Accepts(dds_instance_handle_t writer) const {
    return best_effort_writers_ == nullptr || best_effort_writers_->Contains(writer);
  }

  std::shared_ptr<BestEffortWriters> best_effort_writers_;  // null: from all writers
  dds::Topic<T> topic_;
  std::shared_ptr<std::atomic<bool>> arrived_ = std::make_shared<std::atomic<bool>>(true);  // a sample may wait
  dds::DataReader<T> reader_;
};

}  // namespace troupe::ros
