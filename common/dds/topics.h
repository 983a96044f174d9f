// The names of all topics of the simulation domain. Partition: the session's name.
#pragma once

namespace troupe::dds::topics {

inline constexpr const char* kSession = "troupe/session";      // service to all
inline constexpr const char* kJoin = "troupe/join";            // agent to service
inline constexpr const char* kAdmission = "troupe/admission";  // service to agent
inline constexpr const char* kFrame = "troupe/frame";          // service to all
inline constexpr const char* kProposal = "troupe/proposal";    // agent to service
inline constexpr const char* kStatus = "troupe/status";        // service to tools

}  // namespace troupe::dds::topics
