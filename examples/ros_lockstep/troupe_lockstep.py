"""An executor for rclpy nodes for which the ticks of Troupe wait (docs/ros2-lockstep.md of Troupe).

    import rclpy
    import troupe_lockstep

    rclpy.init()
    troupe_lockstep.spin([MyNode()], "driver", needs=["scan"])

For each tick it waits until the nodes have all messages of the tick, delivers them in a fixed order, runs the timers of simulated
time that are due, and answers. All callbacks run in the calling thread, so that no callback group runs beside another.
"""
import rclpy
from rclpy.clock import ClockType
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from std_msgs.msg import Header

_CLOCK = "/clock"
_NEVER_AWAITED = (_CLOCK, "/parameter_events", "/world/tick")


class Refused(Exception):
    """A node that cannot take part, with the reason."""


class _Subscription:
    """A subscription of a node, with the messages that wait for their tick."""

    def __init__(self, subscription):
        self.subscription = subscription
        self.topic = subscription.topic_name
        self.waiting = []

    def take(self):
        while True:
            with self.subscription.handle:
                taken = self.subscription.handle.take_message(self.subscription.msg_type, self.subscription.raw)
            if taken is None:
                return
            self.waiting.append(taken)

    def deliver(self):
        for message, info in self.waiting:
            with_info = getattr(self.subscription, "_callback_type", None)
            if with_info is not None and with_info.name == "WithMessageInfo":
                self.subscription.callback(message, info)
            else:
                self.subscription.callback(message)
        self.waiting = []


class _Tick:
    """An announcement: the time, the edition of the world, and the number of messages by topic."""

    def __init__(self, header):
        self.header = header
        self.stamp = Time.from_msg(header.stamp).nanoseconds
        entries = {}
        for part in header.frame_id.split():
            name, _, number = part.rpartition(":")
            entries[name] = int(number)
        self.edition = entries.pop("edition", 0)
        self.counts = {name: number for name, number in entries.items() if name.startswith("/")}


class LockstepExecutor:
    """Runs nodes tick by tick.

    `nodes`: in the order of their callbacks. `name`: by which --ros-lockstep names them. `needs`: topics of which a message must
    have arrived before the first answer.
    """

    def __init__(self, nodes, name, needs=()):
        self._nodes = list(nodes)
        self._name = name
        self._control = rclpy.create_node("lockstep_" + "".join(c if c.isalnum() else "_" for c in name))
        self._ticks = []
        kept = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._tick_input = self._control.create_subscription(Header, "/world/tick", self._ticks.append, kept)
        self._done = self._control.create_publisher(Header, "/world/tick_done", QoSProfile(depth=10))
        self._needs = {self._nodes[0].resolve_topic_name(topic) for topic in needs}
        self._subscriptions = {}
        self._last = None  # time and edition of the newest tick that was answered
        for node in self._nodes:
            actions = [entry for entry in node.waitables if type(entry).__name__ in ("ActionServer", "ActionClient")]
            if actions or list(node.clients):
                raise Refused(f"node {node.get_name()} has clients or actions, whose answers belong to no tick")
            node.set_parameters([Parameter("use_sim_time", Parameter.Type.BOOL, True)])

    def _inputs(self):
        """All subscriptions, those that were made meanwhile too, in the order of the nodes."""
        for node in self._nodes:
            for subscription in node.subscriptions:
                self._subscriptions.setdefault(subscription, _Subscription(subscription))
        return list(self._subscriptions.values())

    def _wait(self, inputs):
        """Until something has arrived, or for a while."""
        handles = [entry.subscription.handle for entry in inputs] + [self._tick_input.handle]
        services = [service for node in self._nodes for service in node.services]
        context = self._control.context
        wait_set = rclpy_implementation.WaitSet(len(handles), 0, 0, 0, len(services), 0, context.handle)
        wait_set.clear_entities()
        for handle in handles:
            wait_set.add_subscription(handle)
        for service in services:
            wait_set.add_service(service.handle)
        wait_set.wait(100_000_000)

    def _take(self, inputs):
        for entry in inputs:
            entry.take()
            if entry.topic == _CLOCK:
                entry.deliver()  # the time of the nodes
        tick = _Subscription(self._tick_input)
        tick.take()
        tick.deliver()

    def _serve(self):
        """Services, as those of parameters. They belong to no tick."""
        for node in self._nodes:
            for service in node.services:
                with service.handle:
                    taken = service.handle.service_take_request(service.srv_type.Request)
                if taken is not None and taken[0] is not None:
                    service.send_response(service.callback(taken[0], service.srv_type.Response()), taken[1])

    def _has_all(self, inputs, tick):
        for node in self._nodes:
            clock = node.get_clock()
            if clock.clock_type == ClockType.ROS_TIME and clock.now().nanoseconds != tick.stamp:
                return False
        for entry in inputs:
            if entry.topic in _NEVER_AWAITED:
                continue
            if self._last is None:
                # Perhaps published before this program came; what it needs is then shown again.
                if entry.topic in self._needs and not entry.waiting:
                    return False
            elif len(entry.waiting) < tick.counts.get(entry.topic, 0):
                return False
        if self._last is None:
            for node in self._nodes:
                for publisher in node.publishers:
                    if publisher.topic_name.endswith("/cmd_vel") and publisher.get_subscription_count() == 0:
                        return False
            return self._done.get_subscription_count() > 0
        return True

    def _run_tick(self, inputs, tick):
        for entry in sorted(inputs, key=lambda entry: entry.topic):  # stable: of one topic in the order of the nodes
            if self._last is None and entry.topic in tick.counts:  # not what was shown a second time
                entry.waiting = entry.waiting[-tick.counts[entry.topic]:]
            if entry.topic != _CLOCK:
                entry.deliver()
        for node in self._nodes:
            for timer in node.timers:
                while not timer.is_canceled() and timer.is_ready():
                    timer.handle.call_timer()
                    timer.callback()
        for node in self._nodes:
            for publisher in node.publishers:
                if publisher.topic_name not in ("/rosout", "/parameter_events"):
                    publisher.wait_for_all_acked()

    def spin(self):
        """Until rclpy is shut down."""
        while rclpy.ok():
            inputs = self._inputs()
            self._wait(inputs)
            self._take(inputs)
            self._serve()
            if not self._ticks:
                continue
            tick = _Tick(self._ticks[-1])
            if self._last is not None and tick.stamp < self._last[0]:
                self._last = None  # a reset
            if (tick.stamp, tick.edition) != self._last:  # else it is announced again, with nothing new
                if not self._has_all(inputs, tick):
                    continue
                self._run_tick(inputs, tick)
                self._last = (tick.stamp, tick.edition)
            if self._ticks[-1] is tick.header:
                self._ticks.clear()
            self._done.publish(Header(stamp=tick.header.stamp, frame_id=f"{self._name} edition:{tick.edition}"))


def spin(nodes, name, needs=()):
    """Runs the nodes until rclpy is shut down; Ctrl-C ends it without an error."""
    executor = LockstepExecutor(nodes, name, needs)
    try:
        executor.spin()
    except KeyboardInterrupt:
        pass
