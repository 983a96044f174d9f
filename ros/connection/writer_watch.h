// WriterWatch: finds writers on our readers' topics that match none of them, because the type differs or the writer is
// not reliable; and those of another run in the same domain. DDS itself does not report these, and a user would see
// only that a command has no effect.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ros/messages/ros_options.h"
#include "transport/dds/binding/domain_participant.h"
#include "transport/dds/binding/entity.h"

namespace troupe::ros {

struct Mismatch {
  std::string topic;   // on DDS: "rt/anna/cmd_vel"; empty: the distribution, of no topic
  std::string report;  // a line for people
};

class WriterWatch {
 public:
  explicit WriterWatch(const dds::DomainParticipant& participant);

  // Watches the topic of a reader. Several readers of a topic may have different types.
  void Expect(dds_entity_t reader, bool accepts_best_effort);

  // Of its constructor. The next Drain considers all writers that are there.
  void LookAgain(const dds::DomainParticipant& participant);

  // Reports participants whose list of nodes has another layout than that of the distribution, and other writers of
  // /clock than those of this participant if it has one, too.
  void ExpectOneRun(Distribution distribution) {
    distribution_ = distribution;
    expects_one_clock_ = true;
  }

  // One for each topic and problem found since the last call. A single status read if discovery found nothing new.
  std::vector<Mismatch> Drain();

 private:
  struct Expected {
    std::set<std::string> types;
    bool reliable = true;  // no reader matches other writers
  };
  // The report on a writer; none if it matches, or if the same problem was reported.
  std::optional<std::string> Judge(const dds_builtintopic_endpoint_t& writer);
  std::optional<std::string> JudgeDistribution(const dds_builtintopic_endpoint_t& writer);
  std::optional<std::string> JudgeClock(const dds_builtintopic_endpoint_t& writer);

  dds_guid_t self_{};
  bool expects_one_clock_ = false;                          // and has not reported a second one
  bool has_clock_ = false;                                  // this participant
  bool has_other_clock_ = false;                            // another one
  dds::Entity publications_;                                // a reader of discovered writers
  std::map<std::string, Expected> expected_;                // by topic
  std::optional<Distribution> distribution_;                // none: not reported, or reported
  std::set<std::pair<std::string, std::string>> reported_;  // topic and problem
};

}  // namespace troupe::ros
