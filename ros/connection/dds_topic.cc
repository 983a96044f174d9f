#include "ros/connection/dds_topic.h"

#include <utility>

#include "ros/connection/user_data.h"
#include "transport/dds/binding/loaned_samples.h"
#include "transport/dds/binding/status.h"
#include "transport/dds/binding/topic.h"

namespace troupe::ros {

DdsTopicWriter::DdsTopicWriter(RosParticipant& owner, const TopicSpec& spec, OnMatched on_matched)
    : owner_(owner),
      on_matched_(std::move(on_matched)),
      topic_(dds::CreateTopic(owner.participant(), *spec.type, spec.topic)),
      writer_(dds::Check(
          dds_create_writer(owner.publisher().handle(), topic_.handle(),
                            (ToDds(spec.qos) << TypeUserData(owner.distribution(), *spec.type)).get(), nullptr),
          "creating a writer of topic '" + spec.topic + "'")) {
  listener_.on_publication_matched = [this](const dds::PublicationMatchedStatus& status) {
    ReactToMatch(status.current_count > 0, status.current_count_change > 0);
  };
  dds::SetListener(writer_.handle(), listener_);
  dds::PublicationMatchedStatus before;
  dds::Check(dds_get_publication_matched_status(writer_.handle(), &before), "reading publication_matched");
  if (before.current_count > 0) ReactToMatch(true, true);  // matched before the listener was set
}

DdsTopicWriter::~DdsTopicWriter() {
  owner_.RemoveEndpoint(writer_.handle());
  writer_.close();  // before the members that its listener uses
}

void DdsTopicWriter::ReactToMatch(bool wanted, bool is_new) {
  SetWanted(wanted);
  if (wanted) owner_.NoteWanted();
  if (is_new) NoteReader();
  if (on_matched_) on_matched_(wanted, is_new);
}

bool DdsTopicWriter::Write(const void* sample) noexcept {
  return dds_write(writer_.handle(), sample) == DDS_RETCODE_OK;
}

DdsTopicReader::DdsTopicReader(RosParticipant& owner, const TopicSpec& spec, Part part, Notices notices)
    : owner_(owner),
      notices_(std::move(notices)),
      topic_(dds::CreateTopic(owner.participant(), *spec.type, spec.topic)),
      reader_(dds::Check(
          dds_create_reader(owner.subscriber().handle(), topic_.handle(),
                            (ToDds(spec.qos) << TypeUserData(owner.distribution(), *spec.type)).get(), nullptr),
          "creating a reader of topic '" + spec.topic + "'")) {
  listener_.on_data_available = [this] {
    SetArrived();
    if (notices_.on_arrival) notices_.on_arrival();
  };
  const auto miss = [this] {
    SetMissedWriter();
    if (notices_.on_missed_writer) notices_.on_missed_writer();
  };
  if (part == Part::kReliableReader) {
    listener_.on_requested_incompatible_qos = [miss](const auto&) { miss(); };
  }
  if (part == Part::kBestEffortReader) {
    best_effort_writers_.emplace(reader_.handle());
    listener_.on_subscription_matched = [this](const auto& status) {
      best_effort_writers_->Note(status.last_publication_handle);
    };
  }
  dds::SetListener(reader_.handle(), listener_);
  if (part == Part::kReliableReader) {
    dds::RequestedIncompatibleQosStatus before;
    dds::Check(dds_get_requested_incompatible_qos_status(reader_.handle(), &before), "reading incompatible QoS");
    if (before.total_count > 0) miss();
  }
}

DdsTopicReader::~DdsTopicReader() {
  owner_.RemoveEndpoint(reader_.handle());
  reader_.close();  // before the members that its listener uses
}

void DdsTopicReader::Take(const Consume& consume) {
  for (;;) {
    const auto samples = dds::Loan<char>(reader_.handle(), dds_take, "taking samples");
    if (samples.empty()) return;
    for (const auto sample : samples) {
      const bool accepted = !best_effort_writers_ || best_effort_writers_->Contains(sample.info().publication_handle());
      if (sample.info().valid() && accepted) consume(&sample.data());
    }
  }
}

}  // namespace troupe::ros
