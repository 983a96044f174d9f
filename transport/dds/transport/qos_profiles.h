// The QoS of every topic, by role. One profile serves writers and readers, so that they always match; docs/qos.md has
// the reasons. Lease durations are in seconds and of the writer: a reader asks for none, so that it accepts any.
//
// The choice follows from what a topic is. State that latecomers need (sessions, joins, status) is transient-local with
// depth 1; a stream of which only the newest counts (frames, proposals) is volatile with depth 1 at the writer;
// requests and replies are kept until they are read. Readers of many writers have deep histories, because a topic
// without keys has one queue for all writers.
#pragma once

#include <string>

#include "transport/dds/binding/qos.h"

namespace troupe::dds::qos_profiles {

// How long a write may wait for a reader to make room. Not the default of 100 ms, which Cyclone leaves out of its
// announcements and some other implementations then cannot read.
inline constexpr double kMaxBlockingTime = 0.5;  // s

// `profile` for a reader of many writers: room for messages of all of them, since no topic has keys. A participant is
// known by its writers, so a stranger cannot create or dispose of instances.
Qos FromMany(Qos profile);

// The QoS of all publishers and subscribers: only equal sessions match.
Qos Session(const std::string& session);
// The QoS of the publisher of an agent with this name: a partition of its own, so that permissions tell agents apart.
Qos Agent(const std::string& session, const std::string& name);
// The QoS of the subscriber of all agents' messages.
Qos AllAgents(const std::string& session);
// The name of the agent that publishes in this partition; empty: it is not an agent's.
std::string AgentOfPartition(const std::string& partition);

// The session and the world: kept for latecomers. The lease tells agents that the service has ended.
Qos Description(double lease_seconds = kInfinite);
// Joins of agents, kept until the service has discovered the agent. The lease tells the service that an agent has
// ended.
Qos Join(double lease_seconds = kInfinite);
// Answers to joins: all of them.
Qos Admission();
// Committed ticks: only the latest is of use, because it stands for the whole state.
Qos Frame();
// The same topics, and that of whole frames, as they are read: a message of a participant that is not entitled to send
// frames must not take the place of a frame.
Qos ReceivedFrame();
// Frames as observers read them: lost and late frames are not resent, so that no observer can delay the service.
Qos ObservedFrame();
// Whole frames on request: the latest.
Qos WholeFrame();
// Requests of observers for a whole frame: one of any number is enough.
Qos FrameRequest();
// States of the past, for agents that have asked: a few, because each answers a request.
Qos PastStates();
// Commands of an agent: the latest.
Qos Proposal();
// Requests of tools: all of them.
Qos Control();
// The last replies are kept: a service may receive a request before it has discovered the reader of the reply.
Qos ControlReply();
// The progress of a run, for tools: the latest, also for tools that start later.
Qos Status();

}  // namespace troupe::dds::qos_profiles
