#include "transport/security/security_documents.h"

#include <initializer_list>
#include <vector>

#include "transport/protocol/topics.h"

namespace troupe {
namespace {

// Cyclone compares the number by which the process knows the domain, which can be any.
constexpr const char* kAllDomains = "<domains><id_range><min>0</min><max>230</max></id_range></domains>\n";

std::string TopicRule(const char* topic, const char* metadata_protection) {
  return std::string("<topic_rule>\n<topic_expression>") + topic +
         "</topic_expression>\n"
         "<enable_discovery_protection>true</enable_discovery_protection>\n"
         "<enable_liveliness_protection>true</enable_liveliness_protection>\n"
         "<enable_read_access_control>true</enable_read_access_control>\n"
         "<enable_write_access_control>true</enable_write_access_control>\n"
         "<metadata_protection_kind>" +
         metadata_protection +
         "</metadata_protection_kind>\n"
         "<data_protection_kind>NONE</data_protection_kind>\n"
         "</topic_rule>\n";
}

struct Access {
  std::vector<const char*> publish;
  std::vector<const char*> subscribe;
  std::string publish_partition = "*";
};

Access AccessOf(const Role& role) {
  using namespace topics;  // NOLINT(google-build-using-namespace): a table of topics
  switch (role.kind) {
    case Role::Kind::kService:
      return {{kSession, kFrame, kWholeFrame, kAdmission, kHistory, kStatus, kControlReply},
              {kJoin, kProposal, kControl, kFrameRequest, kSession}};
    case Role::Kind::kAgent:
      // Names have no wildcards, so the end of the partition is this agent's in any session.
      return {{kJoin, kProposal}, {kSession, kAdmission, kFrame, kHistory}, "*/" + role.agent_name};
    case Role::Kind::kOperator:
      return {{kControl, kFrameRequest}, {kSession, kStatus, kControlReply, kFrame, kWholeFrame}};
    case Role::Kind::kObserver:
      return {{kFrameRequest}, {kSession, kStatus, kFrame, kWholeFrame}};
  }
  return {};
}

std::string Criteria(const char* element, const std::vector<const char*>& topics, const std::string& partition) {
  std::string text = std::string("<") + element + "><topics>\n";
  for (const char* topic : topics) text += std::string("<topic>") + topic + "</topic>\n";
  return text + "</topics><partitions><partition>" + partition + "</partition></partitions></" + element + ">\n";
}

std::string Document(const char* schema, const std::string& content) {
  return std::string(
             "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
             "<dds xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" xsi:noNamespaceSchemaLocation="
             "\"https://www.omg.org/spec/DDS-SECURITY/20170901/") +
         schema + "\">\n" + content + "</dds>\n";
}

}  // namespace

std::string GovernanceDocument() {
  using namespace topics;  // NOLINT(google-build-using-namespace): a table of topics
  std::string rules;
  for (const char* topic : {kSession, kFrame, kWholeFrame, kHistory, kJoin, kControl, kControlReply, kStatus}) {
    rules += TopicRule(topic, "ENCRYPT");
  }
  for (const char* topic : {kProposal, kAdmission, kFrameRequest}) rules += TopicRule(topic, "SIGN");
  return Document("omg_shared_ca_governance.xsd",
                  std::string("<domain_access_rules><domain_rule>\n") + kAllDomains +
                      "<allow_unauthenticated_participants>false</allow_unauthenticated_participants>\n"
                      "<enable_join_access_control>true</enable_join_access_control>\n"
                      "<discovery_protection_kind>ENCRYPT</discovery_protection_kind>\n"
                      "<liveliness_protection_kind>SIGN</liveliness_protection_kind>\n"
                      "<rtps_protection_kind>NONE</rtps_protection_kind>\n"
                      "<topic_access_rules>\n" +
                      rules + "</topic_access_rules>\n</domain_rule></domain_access_rules>\n");
}

std::string PermissionsDocument(const Role& role, const std::string& subject, const Validity& validity) {
  const Access access = AccessOf(role);
  return Document("omg_shared_ca_permissions.xsd",
                  "<permissions><grant name=\"" + subject + "\">\n<subject_name>" + subject +
                      "</subject_name>\n<validity><not_before>" + validity.not_before + "</not_before><not_after>" +
                      validity.not_after + "</not_after></validity>\n<allow_rule>\n" + kAllDomains +
                      Criteria("publish", access.publish, access.publish_partition) +
                      Criteria("subscribe", access.subscribe, "*") +
                      "</allow_rule>\n<default>DENY</default>\n</grant></permissions>\n");
}

}  // namespace troupe
