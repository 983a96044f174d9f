// The check of orders (troupe/order.h), the same wherever one enters: from a controller, from an agent's message, from
// a tool and from a recording. A step executes only orders that have passed it.
//
// The reason for one function: an order that one place accepted and another refused would make runs differ, or crash a
// step, which indexes lights, cameras, doors and lifts by the numbers of an order without looking again. An agent
// checks to blame its controller, the service to blame a peer, a recording's reader to find damage.
#pragma once

#include <vector>

#include "common/spatial/scene.h"
#include "troupe/order.h"
#include "troupe/result.h"

namespace troupe {

// Success if the world has what the order of a robot concerns, with finite values within its limits. The error is for
// people, and does not name the robot. REQUIRES: the world has the robot.
Status CheckOrder(const Scene& scene, RobotId robot, const Order& order);
// The same for an order from outside of the simulation, for any robot. The error names the robot, too.
Status CheckInput(const Scene& scene, const Input& input);

// The order with finite numbers beyond the limits of its device set to the nearest ones: the pan and tilt of a camera.
// REQUIRES: the world has the robot.
Order WithinLimits(const WorldDescription& world, RobotId robot, Order order);

// Orders in the sequence in which messages list them: by kind, orders of a kind in their sequence. Orders of different
// kinds do not influence each other.
std::vector<Order> ByKind(std::vector<Order> orders);
std::vector<Input> ByKind(std::vector<Input> inputs);

}  // namespace troupe
