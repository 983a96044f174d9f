// The gateway of a run to fleet controls that speak VDA 5050 over MQTT: a connection to the broker for each robot with
// the controller `vda5050`, with its last will.
//
// It carries messages and decides nothing: those of a fleet control become commands of a tick, which the journal and
// recordings have; those of vehicles were made by their controllers, with headers and simulated timestamps, and leave
// after the tick. Only the messages of the topic `connection` are its own. So a replay and a rewind need no broker.
//
// Threads: one of its own has the connections. The calls of RunObserver leave messages for it, and never wait for the
// broker but in OnBegin and OnEnd.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "transport/mqtt/broker.h"
#include "troupe/world_description.h"
#include "world-service/observers/fleet/answer_round.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// `wait`: how the run waits for answers after ticks with messages of vehicles. The error is a world without vehicles,
// or with two of the same topics. `lines`: receives lines for users, on any thread.
Result<std::unique_ptr<RunObserver>> MakeFleetGateway(const mqtt::Broker& broker, const AnswerWait& wait,
                                                      const WorldDescription& world,
                                                      std::function<void(const std::string&)> lines);

}  // namespace troupe
