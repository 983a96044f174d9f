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
    listener.on_publication_matched = [wanted = wanted_,
                                       owner = participant_](const dds::PublicationMatchedStatus& status) {
      wanted->store(status.current_count > 0, std::memory_order_relaxed);
      if (status.current_count_change > 0) owner->CountReader();
    };
    writer_.set_listener(std::move(listener));
    if (writer_.publication_matched_status().current_count > 0) {  // matched before the listener was set
      *wanted_ = true;
      participant_->CountReader();
    }
    participant_->AddWriter(node.index, writer_.handle());
  }

  // Whether the topic has a reader, so that a message is worth making. One relaxed load, because each topic asks in
  // each tick.
  bool wanted() const { return wanted_->load(std::memory_order_relaxed); }
  dds_entity_t handle() const { return writer_.handle(); }

  void Write(const T& message) noexcept {
    if (dds_write(writer_.handle(), &message) != DDS_RETCODE_OK) participant_->CountLost();
  }

 private:
  RosParticipant* participant_;
  dds::Topic<T> topic_;
  std::shared_ptr<std::atomic<bool>> wanted_ = std::make_shared<std::atomic<bool>>(false);
  dds::DataWriter<T> writer_;
};

// The part of a reader. A topic can have a reliable reader and, once a best-effort writer has come, a best-effort one
// for that. Not from the start: beside a best-effort reader, Cyclone's reliable one may lose what a writer has sent
// before the readers discovered it. The best-effort reader matches reliable writers too, and ignores their messages.
enum class Part : std::uint8_t { kOnlyReader, kReliableReader, kBestEffortReader };

template <typename T>
class RosReader {
 public:
  RosReader(const RosNode& node, const std::string& name, const dds::Qos& qos, Part part = Part::kOnlyReader)
      : topic_(node.participant->participant(), "rt" + node.Resolve(name)),
        reader_(node.participant->subscriber(), topic_,
                dds::Qos(qos) << TypeUserData<T>(node.participant->distribution())) {
    dds::DataReaderListener listener;
    listener.on_data_available = [arrived = arrived_] { arrived->store(true); };
    if (part == Part::kReliableReader) {
      listener.on_requested_incompatible_qos = [missed = missed_](const auto&) { missed->store(true); };
    }
    if (part == Part::kBestEffortReader) {
      best_effort_writers_ = std::make_shared<BestEffortWriters>(reader_.handle());
      listener.on_subscription_matched = [writers = best_effort_writers_](const auto& status) {
        writers->Note(status.last_publication_handle);
      };
    }
    reader_.set_listener(std::move(listener));
    if (part == Part::kReliableReader && reader_.requested_incompatible_qos_status().total_count > 0) *missed_ = true;
    node.participant->AddReader(node.index, reader_.handle(), part == Part::kReliableReader);
  }

  // A writer has come that needs a best-effort reader. For the part kReliableReader.
  bool missed_writer() const { return missed_->load(std::memory_order_relaxed); }

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

  std::shared_ptr<std::atomic<bool>> missed_ = std::make_shared<std::atomic<bool>>(false);
  std::shared_ptr<BestEffortWriters> best_effort_writers_;  // null: from all writers
  dds::Topic<T> topic_;
  std::shared_ptr<std::atomic<bool>> arrived_ = std::make_shared<std::atomic<bool>>(true);  // a sample may wait
  dds::DataReader<T> reader_;
};

}  // namespace troupe::ros
