// All converters between messages (transport/protocol/messages.h) and the types on the wire (idl/). A value on the wire
// is valid while its message and its arena live; reading one fails if it breaks the contract of its file in idl/.
//
// Converting checks form, never meaning: enumerators are known, lengths agree, numbers that would break arithmetic are
// finite where a message's file says so. Meaning needs a world, and is checked by its receiver (CheckState,
// ValidateProposal, CheckInput, CheckRobotCommand).
#pragma once

#include <vector>

#include "idl/admission.h"
#include "idl/control.h"
#include "idl/frame.h"
#include "idl/frame_request.h"
#include "idl/history.h"
#include "idl/join.h"
#include "idl/order.h"
#include "idl/proposal.h"
#include "idl/robot_command.h"
#include "idl/session.h"
#include "idl/status.h"
#include "idl/world.h"
#include "transport/dds/binding/domain_participant.h"
#include "transport/dds/binding/wire.h"
#include "transport/protocol/messages.h"
#include "troupe/pose.h"
#include "troupe/result.h"
#include "troupe/robot_command.h"
#include "troupe/world_description.h"

TROUPE_DDS_TYPE(troupe_wire_Admissions);
TROUPE_DDS_TYPE(troupe_wire_Control);
TROUPE_DDS_TYPE(troupe_wire_ControlReply);
TROUPE_DDS_TYPE(troupe_wire_Frame);
TROUPE_DDS_TYPE(troupe_wire_FrameRequest);
TROUPE_DDS_TYPE(troupe_wire_History);
TROUPE_DDS_TYPE(troupe_wire_Join);
TROUPE_DDS_TYPE(troupe_wire_Proposal);
TROUPE_DDS_TYPE(troupe_wire_Session);
TROUPE_DDS_TYPE(troupe_wire_Status);

namespace troupe::dds {

// Valid while the messages and the arena live.
troupe_wire_Admissions ToWire(const std::vector<AdmissionMessage>& messages, WireArena& arena);
Result<std::vector<AdmissionMessage>> FromWire(const troupe_wire_Admissions& wire);

troupe_wire_Control ToWire(const ControlRequest& message, WireArena& arena);
troupe_wire_ControlReply ToWire(const ControlReply& message, WireArena& arena);
Result<ControlRequest> FromWire(const troupe_wire_Control& wire);
Result<ControlReply> FromWire(const troupe_wire_ControlReply& wire);

// With `before`, the state of the previous tick, the frame has only the changes since. REQUIRES: `before` is null or
// has as many robots, joints, grippers and objects.
troupe_wire_Frame ToWire(const FrameMessage& message, const WorldState* before, WireArena& arena);
troupe_wire_Frame ToWire(const FrameMessage& message, WireArena& arena);  // a whole one

// False if the frame has the changes since a frame that is not `message`.
bool CanRead(const troupe_wire_Frame& wire, const FrameMessage& message);
// Brings `message`, the last frame, up to this one. An error when the sample breaks the contract of idl/frame.idl;
// `message` is then empty. REQUIRES: CanRead(wire, message)
Status FromWire(const troupe_wire_Frame& wire, FrameMessage& message);

troupe_wire_FrameRequest ToWire(const FrameRequest& message, WireArena& arena);
Result<FrameRequest> FromWire(const troupe_wire_FrameRequest& wire);

// A frame is written as the changes since the previous entry where it can be.
troupe_wire_History ToWire(const HistoryMessage& message, WireArena& arena);
Result<HistoryMessage> FromWire(const troupe_wire_History& wire);

troupe_wire_Join ToWire(const JoinMessage& message, WireArena& arena);
Result<JoinMessage> FromWire(const troupe_wire_Join& wire);

// Orders of tools for one tick. CheckInput compares them with a world.
troupe_wire_InputColumns ToWire(const std::vector<Input>& inputs, WireArena& arena);
Status FromWire(const troupe_wire_InputColumns& wire, std::vector<Input>& inputs);

troupe_wire_Proposal ToWire(const ProposalMessage& message, WireArena& arena);

// Fills `message` instead of returning one, so that its memory is used again: one arrives from each agent in each tick.
// An error when the sample breaks the contract of idl/proposal.idl; `message` is then unspecified.
Status FromWire(const troupe_wire_Proposal& wire, ProposalMessage& message);

// The strings and sequences of the result live in the arena.
troupe_wire_RobotCommand ToWire(const RobotCommand& command, WireArena& arena);

// Numbers that are not finite pass: CheckRobotCommand compares with a world.
Result<RobotCommand> FromWire(const troupe_wire_RobotCommand& wire);

troupe_wire_Session ToWire(const SessionMessage& message, WireArena& arena);
Result<SessionMessage> FromWire(const troupe_wire_Session& wire);

troupe_wire_Status ToWire(const StatusMessage& message, WireArena& arena);
Result<StatusMessage> FromWire(const troupe_wire_Status& wire);

inline troupe_wire_Pose PoseToWire(const Pose& pose) {
  return {pose.x, pose.y, pose.z, pose.heading};
}

inline Pose PoseFromWire(const troupe_wire_Pose& wire) {
  return {wire.x, wire.y, wire.z, wire.heading};
}

// Valid while the description and the arena live.
troupe_wire_World ToWire(const WorldDescription& world, WireArena& arena);
Result<WorldDescription> FromWire(const troupe_wire_World& wire);

}  // namespace troupe::dds
