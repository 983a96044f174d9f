#include "ros/participant/cyclone_programs.h"

#include <string_view>
#include <utility>

#include "ros/connection/dds_endpoints.h"
#include "transport/dds/binding/loaned_samples.h"

namespace troupe::ros {
namespace {

bool IsOfARun(const dds_qos_t* qos) {
  void* bytes = nullptr;
  std::size_t size = 0;
  if (!dds_qget_userdata(qos, &bytes, &size) || bytes == nullptr) return false;
  const bool is_marked =
      std::string_view(static_cast<const char*>(bytes), size).find(kMarkOfRuns) != std::string_view::npos;
  dds_free(bytes);
  return is_marked;
}

}  // namespace

CyclonePrograms::CyclonePrograms(const RosParticipant& participant, std::function<void()> wake)
    : participants_(dds::Check(
          dds_create_reader(participant.participant().handle(), DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr),
          "creating a reader of discovered participants")) {
  listener_.on_data_available = std::move(wake);
  dds::SetListener(participants_.handle(), listener_);
  listener_.on_data_available();  // for those that were found before
}

bool CyclonePrograms::Found() {
  while (!found_) {
    const auto samples =
        dds::Loan<dds_builtintopic_participant_t>(participants_.handle(), dds_take, "taking participants");
    if (samples.empty()) return false;
    for (const auto sample : samples) {
      if (!sample.info().valid()) continue;
      found_ = found_ || (IsOfCyclone(sample.data().key) && !IsOfARun(sample.data().qos));
    }
  }
  return true;
}

}  // namespace troupe::ros
