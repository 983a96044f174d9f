#include "world-service/core/step.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "common/base/text.h"
#include "common/model/device_limits.h"
#include "common/spatial/check_order.h"
#include "common/spatial/sweep.h"
#include "troupe/check.h"
#include "troupe/radio_limits.h"
#include "world-service/core/people.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

// The proposal of each robot, by id; null for a robot without one, and for one without energy.
// Proposals come sorted by robot, each robot at most once: a caller that breaks this would change results silently, so
// that it is checked in every build.
std::vector<const Proposal*> ProposalByRobot(const Scene& scene, const WorldState& state,
                                             std::span<const Proposal> proposals) {
  const std::size_t robots = state.robots.size();
  std::vector<const Proposal*> by_robot(robots, nullptr);
  for (std::size_t i = 0; i < proposals.size(); ++i) {
    TROUPE_CHECK(proposals[i].robot.index() < robots);
    TROUPE_CHECK(i == 0 || proposals[i - 1].robot < proposals[i].robot);
    if (IsOutOfEnergy(scene, state, proposals[i].robot)) continue;
    by_robot[proposals[i].robot.index()] = &proposals[i];
  }
  return by_robot;
}

// One robot's turn.
// The order within a turn: open fingers, base, joints, close fingers. An object that is let go stays behind when the
// base moves, and one that is gripped is where the fingers have closed.
class RobotTurn {
 public:
  // `proposal` may be null.
  RobotTurn(StepWorkspace& workspace, RobotId robot, const Proposal* proposal)
      : workspace_(workspace), robot_(robot), proposal_(proposal) {}

  void Act() {
    for (GripperId gripper : workspace_.scene.grippers_of(robot_)) {
      const GripperDescription& description = workspace_.world().gripper(gripper);
      if (VelocityOf(description.left) < 0.0 || VelocityOf(description.right) < 0.0) Release(workspace_, gripper);
    }
    ActBase();
    for (JointId joint : workspace_.scene.joints_of(robot_)) ActJoint(joint);
    for (GripperId gripper : workspace_.scene.grippers_of(robot_)) {
      const GripperDescription& description = workspace_.world().gripper(gripper);
      Grip(workspace_, gripper, FingerOf(description.left), FingerOf(description.right));
    }
  }

 private:
  double VelocityOf(JointId joint) const {
    if (proposal_ == nullptr || proposal_->joint_velocities.empty()) return 0.0;
    return proposal_->joint_velocities[NumberOf(joint)];
  }
  // The joint's place among the robot's.
  std::size_t NumberOf(JointId joint) const {
    const std::span<const JointId> joints = workspace_.scene.joints_of(robot_);
    // Joints of a robot are ascending in the scene.
    return static_cast<std::size_t>(std::lower_bound(joints.begin(), joints.end(), joint) - joints.begin());
  }
  FingerMotion FingerOf(JointId joint) const { return {VelocityOf(joint), joint_contacts_[NumberOf(joint)]}; }

  void ActBase() {
    RobotState& robot = workspace_.next.robots[robot_.index()];
    const bool was_stalled = robot.stalled;
    std::optional<Contact> contact;
    if (proposal_ == nullptr || proposal_->twist.IsZero()) {
      robot.twist = {};
      if (proposal_ != nullptr) robot.stalled = false;  // a robot commanded to stop is not stalled
    } else {
      contact = MoveBase(workspace_, robot_, proposal_->twist);
      // An object that stood in the air by its file begins to fall when it is touched.
      if (contact) workspace_.Touch(contact->other);
    }
    // Events tell changes only: a robot that stays stalled tells it once.
    if (robot.stalled == was_stalled) return;
    workspace_.robot_events.push_back({.tick = workspace_.next.tick,
                                       .type = robot.stalled ? EventType::kStallBegan : EventType::kStallEnded,
                                       .robot = robot_,
                                       .other = robot.stalled ? contact->other : std::nullopt});
  }

  void ActJoint(JointId id) {
    const bool was_blocked = workspace_.next.joints[id.index()].blocked;
    const std::optional<Contact> contact = MoveJoint(workspace_, id, VelocityOf(id));
    joint_contacts_.push_back(contact);
    if (!contact) return;
    workspace_.Touch(contact->other);
    if (was_blocked || IsGrip(id, *contact)) return;
    workspace_.robot_events.push_back({.tick = workspace_.next.tick,
                                       .type = EventType::kBlocked,
                                       .robot = robot_,
                                       .other = contact->other,
                                       .detail = workspace_.world().joint(id).name});
  }

  // The contact of a pad with an object is part of gripping it, not a blocked joint.
  bool IsGrip(JointId joint, const Contact& contact) const {
    const std::optional<ObjectId> object = contact.other ? workspace_.scene.object_of(*contact.other) : std::nullopt;
    if (!object || workspace_.IsMounted(*object)) return false;
    for (GripperId id : workspace_.scene.grippers_of(robot_)) {
      const GripperDescription& gripper = workspace_.world().gripper(id);
      if ((joint == gripper.left && contact.mine == gripper.left_pad) ||
          (joint == gripper.right && contact.mine == gripper.right_pad)) {
        return true;
      }
    }
    return false;
  }

  StepWorkspace& workspace_;
  const RobotId robot_;
  const Proposal* const proposal_;
  std::vector<std::optional<Contact>> joint_contacts_;  // by the robot's joints
};

// Islands that a thread claims at a time.
constexpr std::size_t kClaim = 4;

// Once all robots have acted.
// In one thread but for people. The order is explained in step.h.
StepResult Finish(StepWorkspace& workspace, const WorldState& before, const TickOrders& given,
                  ThreadPool* people_pool) {
  const std::span<const Proposal* const> by_robot = given.proposals;
  // The file's before those of tools.
  std::vector<Input> inputs = TimedInputs(workspace.world(), workspace.next.tick);
  inputs.insert(inputs.end(), given.inputs.begin(), given.inputs.end());
  const TickOrders orders{inputs, by_robot};
  RuleLanes(orders, workspace);
  CallLifts(orders, workspace);
  MoveDoors(orders, workspace);
  MoveLifts(workspace);
  HandOverLoads(orders, workspace);
  DropLostObjects(workspace);
  LetObjectsFall(workspace);
  MovePeople(workspace, people_pool);
  AssignChargers(orders, workspace);
  MoveGoods(orders, workspace);
  DirectTraffic(orders, workspace);
  CoverZones(workspace);
  UpdateWaits(orders, workspace);
  Transmit(workspace.world(), by_robot, workspace.next);
  ExchangeEnergy(workspace);
  OperateDevices(orders, workspace);
  SetTwists(orders.inputs, workspace);
  StepResult result{std::move(workspace.next), std::move(workspace.robot_events)};
  // From the order in which robots acted, or threads finished, to that of ids; the events of one robot keep their
  // order.
  std::stable_sort(result.events.begin(), result.events.end(),
                   [](const Event& a, const Event& b) { return a.robot < b.robot; });
  std::move(workspace.object_events.begin(), workspace.object_events.end(), std::back_inserter(result.events));
  AddBuildingEvents(workspace.scene, before, result.state, result.events);
  AddTrafficEvents(workspace.scene.world(), before, result.state, result.events);
  return result;
}

StepMemory MemoryFor(const Scene& scene, const WorldState& state, BodyIndex& bodies) {
  TROUPE_CHECK(state.robots.size() == scene.world().robots.size());
  // The index is moved in, brought to the state by the few bodies that differ, and moved out again at the end of the
  // step.
  StepMemory memory(scene, state, std::move(bodies));
  memory.next.tick = state.tick + 1;
  // Before any motion: the velocities of the tick that ends here are the "velocities before" of the next one, from
  // which units find their acceleration.
  KeepVelocities(scene, memory.bodies, memory.next);
  return memory;
}

std::string ToText(const Twist& twist) {
  char text[128];
  std::snprintf(text, sizeof text, "(%.6g m/s, %.6g m/s, %.6g rad/s)", twist.vx, twist.vy, twist.wz);
  return text;
}

Status CheckJointVelocities(const Scene& scene, const Proposal& proposal) {
  const std::vector<double>& velocities = proposal.joint_velocities;
  if (velocities.empty()) return Status();
  const std::span<const JointId> joints = scene.joints_of(proposal.robot);
  for (std::size_t i = 0; i < std::min(joints.size(), velocities.size()); ++i) {
    const JointDescription& joint = scene.world().joint(joints[i]);
    // An agent computes the velocity from a position and an interval: rounding may exceed the limit by a bit.
    if (std::abs(velocities[i]) <= joint.max_speed * (1.0 + 1e-9)) continue;
    char text[96];
    std::snprintf(text, sizeof text, "%.6g, expected at most %.6g either way", velocities[i], joint.max_speed);
    return BadInput("found a velocity of joint '" + joint.name + "' of " + text);
  }
  if (velocities.size() == joints.size()) return Status();
  return BadInput("found velocities of " + std::to_string(velocities.size()) +
                  " joints, expected none or those of the robot's " + std::to_string(joints.size()));
}

Status CheckRadioMessages(const WorldDescription& world, const Proposal& proposal) {
  for (const RadioMessage& message : proposal.messages) {
    if (!message.to || message.to->index() < world.robots.size()) continue;
    return BadInput("found a radio message to robot " + std::to_string(message.to->index()) + ", expected one of " +
                    std::to_string(world.robots.size()) + " robots");
  }
  return CheckMessages(world.robot(proposal.robot), world.interval_seconds(), proposal.messages);
}

Status CheckTextAndOrders(const Scene& scene, const Proposal& proposal) {
  if (proposal.say.size() > kMaxSaidBytes) {
    return BadInput("found a text of " + std::to_string(proposal.say.size()) + " bytes, expected at most " +
                    std::to_string(kMaxSaidBytes));
  }
  // It is printed on terminals.
  if (!IsPlainLine(proposal.say)) {
    return BadInput("found a text with a control character or a byte that is not UTF-8, expected a line of UTF-8");
  }
  if (proposal.fleet.size() > kMaxFleetMessages) {
    return BadInput("found " + std::to_string(proposal.fleet.size()) +
                    " messages to a fleet control, expected at most " + std::to_string(kMaxFleetMessages));
  }
  for (const FleetMessage& message : proposal.fleet) {
    if (!IsToVehicle(message.topic) && message.text.size() <= kMaxFleetBytes &&
        message.text.find('\0') == std::string::npos) {
      continue;
    }
    return BadInput(
        "found a message to a fleet control that is too long, has a byte of value 0, or is not of a vehicle");
  }
  for (const Order& order : proposal.orders) {
    if (Status problem = CheckOrder(scene, proposal.robot, order); !problem.ok()) return problem;
  }
  return {};
}

}  // namespace

StepResult Step(const Scene& scene, const WorldState& state, std::span<const Proposal> proposals,
                std::span<const Input> inputs) {
  BodyIndex bodies(scene);
  return Step(scene, state, proposals, bodies, nullptr, inputs);
}

StepResult Step(const Scene& scene, const WorldState& state, std::span<const Proposal> proposals, BodyIndex& bodies,
                ThreadPool* people_pool, std::span<const Input> inputs) {
  const std::size_t count = state.robots.size();
  const std::vector<const Proposal*> by_robot = ProposalByRobot(scene, state, proposals);
  StepMemory memory = MemoryFor(scene, state, bodies);
  StepWorkspace workspace(scene, memory);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = (memory.next.tick + k) % count;  // so that no robot is always first
    RobotTurn(workspace, RobotId(i), by_robot[i]).Act();
  }
  StepResult result = Finish(workspace, state, {inputs, by_robot}, people_pool);
  bodies = std::move(memory.bodies);
  return result;
}

Stepper::Stepper(const Scene& scene, std::shared_ptr<ThreadPool> pool, std::size_t fewest_robots)
    : scene_(scene),
      pool_(pool && pool->size() > 1 && scene.world().robots.size() >= fewest_robots ? pool : nullptr),
      people_pool_(pool && pool->size() > 1 && scene.world().people.size() >= kMinPeople ? pool : nullptr),
      indices_(pool_ ? pool_->size() : 1, BodyIndex(scene)) {}

StepResult Stepper::Step(const WorldState& state, std::span<const Proposal> proposals, std::span<const Input> inputs) {
  if (!pool_) return troupe::Step(scene_, state, proposals, indices_.front(), people_pool_.get(), inputs);
  const std::vector<const Proposal*> by_robot = ProposalByRobot(scene_, state, proposals);
  islands_.Find(scene_, state, by_robot);
  StepMemory memory = MemoryFor(scene_, state, indices_.front());
  // Threads write different rows of one state, needs_support and lowered: an island has its own robots, objects and
  // grippers. All else is of each thread.
  std::vector<std::vector<Event>> events(indices_.size());  // by thread
  std::atomic<std::size_t> next = 0;                        // the first island that no thread has claimed
  pool_->Run(indices_.size(), [&](std::size_t thread) {
    // Woken too late: it spares the index its update.
    if (next >= islands_.count()) return;
    // An index shows the bodies of other islands where they were before the step, or after it if this thread has moved
    // them: neither is within reach of an island, so that it makes no difference.
    BodyIndex& bodies = thread == 0 ? memory.bodies : indices_[thread];
    if (thread != 0) bodies.Assign(state);
    for (std::size_t first = next.fetch_add(kClaim); first < islands_.count(); first = next.fetch_add(kClaim)) {
      for (std::size_t island = first; island < std::min(first + kClaim, islands_.count()); ++island) {
        StepWorkspace workspace(scene_, memory, bodies, islands_.objects(island), islands_.grippers(island));
        workspace.robot_events = std::move(events[thread]);
        for (const RobotId robot : islands_.robots(island)) {
          RobotTurn(workspace, robot, by_robot[robot.index()]).Act();
        }
        events[thread] = std::move(workspace.robot_events);
      }
    }
  });
  // Index 0 has seen only the islands of its own thread.
  memory.bodies.Assign(memory.next);
  StepWorkspace workspace(scene_, memory);
  // The events of each robot are of one island, in their order.
  for (std::vector<Event>& of_thread : events) {
    std::move(of_thread.begin(), of_thread.end(), std::back_inserter(workspace.robot_events));
  }
  StepResult result = Finish(workspace, state, {inputs, by_robot}, people_pool_.get());
  indices_.front() = std::move(memory.bodies);
  return result;
}

WorldState InitialState(const Scene& scene) {
  WorldState placed = PlacedState(scene.world());
  if (placed.objects.empty()) return placed;
  // Only the modes and supports of objects depend on more than the description.
  StepMemory memory(scene, placed);
  StepWorkspace workspace(scene, memory);
  FindSupports(workspace);
  return std::move(memory.next);
}

Status ValidateProposal(const Scene& scene, const WorldState& state, const Proposal& proposal) {
  const WorldDescription& world = scene.world();
  TROUPE_CHECK(state.robots.size() == world.robots.size());
  const std::size_t index = proposal.robot.index();
  if (index >= world.robots.size()) {
    return BadInput("found robot " + std::to_string(index) + ", expected one of " +
                    std::to_string(world.robots.size()) + " robots");
  }
  if (!IsFinite(proposal.twist)) return BadInput("found a twist that is not finite: " + ToText(proposal.twist));
  const DriveDescription& drive = world.robots[index].drive;
  const Twist& current = state.robots[index].twist;
  const double seconds = world.interval_seconds();
  // An agent clamps by the same function (device_limits.h), so that only a faulty or hostile one is refused.
  if (!WithinLimits(drive, current, proposal.twist, seconds)) {
    return BadInput("found the twist " + ToText(proposal.twist) + " after " + ToText(current) +
                    ", expected one within the drive's bounds: " +
                    ToText(ClampToLimits(drive, current, proposal.twist, seconds)) + " is the nearest");
  }
  if (Status problem = CheckJointVelocities(scene, proposal); !problem.ok()) return problem;
  if (Status problem = CheckRadioMessages(world, proposal); !problem.ok()) return problem;
  return CheckTextAndOrders(scene, proposal);
}

}  // namespace troupe
