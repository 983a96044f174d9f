// WriterWatch: finds writers that mean our readers and that these cannot read: their type is another one, or they are
// not reliable where a reader asks for that. DDS says nothing of them, and people wonder why nothing happens.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/dds/domain_participant.h"
#include "common/dds/entity.h"

namespace troupe::ros {

class WriterWatch {
 public:
  explicit WriterWatch(const dds::DomainParticipant& participant);

  // Watches the topic of a reader. Several readers of a topic may have different types.
  void Expect(dds_entity_t reader);

  // What was found since the last call, a line for each kind of writer of a topic. Quick when nothing changed.
  std::vector<std::string> TakeReports();

 private:
  struct Expected {
    std::set<std::string> types;
    bool reliable = false;
  };
  std::string Judge(const dds_builtintopic_endpoint_t& writer);

  dds::Entity publications_;                                // reader of what discovery tells
  std::map<std::string, Expected> expected_;                // by topic
  std::set<std::pair<std::string, std::string>> reported_;  // topic, and what is wrong
};

}  // namespace troupe::ros
