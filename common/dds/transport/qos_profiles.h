// The QoS of every topic, by role. One profile serves writers and readers, so that they always match; docs/qos.md has
// the reasons. Lease durations are in seconds and of the writer: a reader asks for none, so that it accepts any.
#pragma once

#include <string>

#include "common/dds/binding/qos.h"

namespace troupe::dds::qos_profiles {

// How long a write may wait for a reader to make room. Not the default of 100 ms, which Cyclone leaves out of its
// announcements and some other implementations then cannot read.
inline constexpr double kMaxBlockingTime = 0.5;  // s

// Of all publishers and subscribers: only participants of the same session meet.
Qos Session(const std::string& session);

// The session and the world: kept for latecomers. The lease tells agents that the service is gone.
Qos Description(double lease_seconds = kInfinite);
// Joins of agents, kept until the service has found the agent. The lease tells the service that an agent is gone.
Qos Join(double lease_seconds = kInfinite);
// Answers to joins: all of them, each agent's latest.
Qos Admission();
// Committed ticks: only the latest is of use, for it holds everything.
Qos Frame();
// The same topic as observers read it: what is lost or late is gone, so that no observer can delay the service.
Qos ObservedFrame();
// Whole frames on request: the latest.
Qos WholeFrame();
// Requests of observers for a whole frame: one of any number is enough.
Qos FrameRequest();
// Commands of the agents: each agent's latest.
Qos Proposal();
// Requests of tools: all of them.
Qos Control();
// The last answer to each client waits for it: a service may have got a request before it has found who reads the
// answer.
Qos ControlReply();
// How the run goes, for tools: the latest of each run, also for tools that start later.
Qos Status();

}  // namespace troupe::dds::qos_profiles
