// The names of all topics of the simulation domain, for transports and for permissions.
#pragma once

namespace troupe::topics {

inline constexpr const char* kSession = "troupe/session";             // service to all
inline constexpr const char* kJoin = "troupe/join";                   // agent to service
inline constexpr const char* kAdmission = "troupe/admission";         // service to agent
inline constexpr const char* kFrame = "troupe/frame";                 // service to agents and observers
inline constexpr const char* kFrameRequest = "troupe/frame_request";  // observer to service
inline constexpr const char* kWholeFrame = "troupe/whole_frame";      // service to observers
inline constexpr const char* kHistory = "troupe/history";             // service to agents
inline constexpr const char* kProposal = "troupe/proposal";           // agent to service
inline constexpr const char* kStatus = "troupe/status";               // service to tools
inline constexpr const char* kControl = "troupe/control";             // tool to service
inline constexpr const char* kControlReply = "troupe/control_reply";  // service to tool

}  // namespace troupe::topics
