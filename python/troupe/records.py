"""Records: the values that simulations and controllers exchange. Plain tuples with names, so that they can be compared,
copied and pickled.

Units are metres, seconds, radians and their quotients; x points forward, y to the left, z up. Frames: W world, R robot,
S sensor. `pose` of a reading is that of S in R. Arrays are numpy's, and can only be read.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, NamedTuple, Optional, Sequence, Tuple, Union

if TYPE_CHECKING:
    import numpy

__all__ = ["Pose", "Twist", "Event", "SensorInfo", "DriveInfo", "JointInfo", "GripperInfo", "RobotInfo",
           "RangeScan", "RangerReading", "Beam", "BreakBeamReading", "Fiducial", "FiducialReading", "BumperSegment",
           "BumperReading", "Contact", "ContactReading", "Blob", "BlobfinderReading", "Map", "CameraReading", "Place",
           "Reception", "RadioReading", "ImuReading", "JointReading", "GripperReading", "EnergyReading", "Goal",
           "Observation", "GripperCommand", "JointCommand", "RadioMessage", "LightOrder", "CameraOrder", "DoorOrder",
           "LiftInfo", "LiftReading", "LiftOrder", "TrafficOrder", "ChargeOrder", "JobOrder", "WaitOrder", "LoadOrder",
           "Command"]


class Pose(NamedTuple):
    """A pose in 2.5D: of one frame in another."""

    x: float = 0.0  # m
    y: float = 0.0  # m
    z: float = 0.0  # m
    heading: float = 0.0  # rad, counter-clockwise, in (-pi, pi]


class Twist(NamedTuple):
    """The velocity of a robot in its own frame R."""

    vx: float = 0.0  # m/s, forward
    vy: float = 0.0  # m/s, to the left
    wz: float = 0.0  # rad/s, counter-clockwise


class Event(NamedTuple):
    """A change during a tick. Models are named by their full names."""

    tick: int
    type: str  # "stall_began", "gripped", "landed", "said", "door_opened", "person_boarded", ...: docs/testing.md
    robot: Optional[str]
    other: Optional[str]  # the obstacle or support; None for the ground
    object: Optional[str]  # the object of a gripper, or the one that has landed; the door, lift or person
    detail: str  # the joint or gripper, the floor, the reason, or the text


class SensorInfo(NamedTuple):
    """A sensor of a robot. Its place in `RobotInfo.sensors` is its number."""

    name: str
    type: str  # "ranger", "camera", "fiducial", "bumper", "contact", "blobfinder", "radio", "imu", "break_beam"
    pose: Pose  # of the sensor's model in R, with all joints at their starts


class DriveInfo(NamedTuple):
    """A robot's drive. Bounds are (min, max) for x, y (m/s) and heading (rad/s)."""

    type: str  # "differential", "omni" or "car"
    wheelbase: float  # m, of a car
    velocity: Tuple[Tuple[float, float], Tuple[float, float], Tuple[float, float]]


class JointInfo(NamedTuple):
    name: str
    type: str  # "prismatic" (m) or "revolute" (rad)
    min: float
    max: float
    max_speed: float


class GripperInfo(NamedTuple):
    name: str
    left: int  # the finger's number in RobotInfo.joints
    right: int
    lift: Optional[int]
    beams: Optional[int]  # its break beams, in RobotInfo.sensors


class LiftInfo(NamedTuple):
    name: str
    floors: Tuple[str, ...]


class LiftReading(NamedTuple):
    z: float  # m, of the cabin's floor
    floor: int  # that it moves to or stands at
    session: Optional[int]  # the only robot whose calls count


class RobotInfo(NamedTuple):
    """What a controller knows about its robot before the first tick."""

    name: str
    id: int  # as other robots see it, for instance in Reception.sender
    parameters: Dict[str, Any]
    drive: DriveInfo
    sensors: Tuple[SensorInfo, ...]
    joints: Tuple[JointInfo, ...]
    grippers: Tuple[GripperInfo, ...]
    lights: Tuple[str, ...]  # their names
    doors: Tuple[str, ...]  # of the world, their names
    lifts: Tuple[LiftInfo, ...]  # of the world

    def sensor(self, name: str) -> int:
        """The number of the first sensor of that name, else of that type. ValueError if the robot has none."""
        for key in ("name", "type"):
            for number, sensor in enumerate(self.sensors):
                if getattr(sensor, key) == name:
                    return number
        names = ", ".join(f"{sensor.name} ({sensor.type})" for sensor in self.sensors) or "none"
        raise ValueError(f"robot {self.name} has no sensor {name!r}, found: {names}")

    def __deepcopy__(self, memo: Dict[int, Any]) -> "RobotInfo":
        return self  # constant


class RangeScan(NamedTuple):
    """The ranges of one ray sensor. Shapes: (rays,), or (planes, rays) with several planes."""

    ranges: "numpy.ndarray[Any, Any]"  # float64, m along the ray; `max` without a hit
    intensities: "numpy.ndarray[Any, Any]"  # float64, of the hit; 0 without one
    fov: float  # rad, from the first ray to the last
    elevations: "numpy.ndarray[Any, Any]"  # float64 (planes,), rad above the horizontal
    pose: Pose
    min: float  # m
    max: float

    @property
    def bearings(self) -> "numpy.ndarray[Any, Any]":
        """float64 (rays,), rad in S, ascending."""
        import numpy
        rays = self.ranges.shape[-1]
        if rays < 2:
            return numpy.zeros(rays)
        return self.fov * ((2.0 * numpy.arange(rays) - (rays - 1)) / (2.0 * (rays - 1)))


class RangerReading(NamedTuple):
    tick: int
    scans: Tuple[RangeScan, ...]  # one for each ray sensor, in the order of the world file

    @property
    def ranges(self) -> "numpy.ndarray[Any, Any]":
        """All ranges in one array (n,), m: those of a ring of sonars in one piece."""
        if len(self.scans) == 1:
            return self.scans[0].ranges.reshape(-1)
        import numpy
        return numpy.concatenate([scan.ranges.reshape(-1) for scan in self.scans] or [numpy.empty(0)])

    @property
    def points(self) -> "numpy.ndarray[Any, Any]":
        """The hits as points (n, 3), m in R; rays without a hit are left out."""
        import numpy
        parts = []
        for scan in self.scans:
            ranges = scan.ranges.reshape(len(scan.elevations), -1)
            flat = ranges * numpy.cos(scan.elevations)[:, None]
            angles = scan.bearings + scan.pose.heading
            points = numpy.stack([scan.pose.x + flat * numpy.cos(angles), scan.pose.y + flat * numpy.sin(angles),
                                  scan.pose.z + ranges * numpy.sin(scan.elevations)[:, None]], axis=-1)
            parts.append(points[ranges < scan.max])
        return numpy.concatenate(parts or [numpy.empty((0, 3))])


class Beam(NamedTuple):
    broken_by: Optional[int]  # the number of the object that is nearest to the beam's first end


class BreakBeamReading(NamedTuple):
    tick: int
    beams: Tuple[Beam, ...]


class Fiducial(NamedTuple):
    """A model that a fiducial finder recognizes."""

    id: int  # its fiducial_return; 0 if it is too far to be identified
    range: float  # m, between the origins, in the plane
    bearing: float  # rad, in S
    pose: Pose  # of the model in S
    size: Tuple[float, float, float]  # m


class FiducialReading(NamedTuple):
    tick: int
    fiducials: Tuple[Fiducial, ...]
    fov: float  # rad
    min: float  # m
    max: float
    pose: Pose


class BumperSegment(NamedTuple):
    pressed: bool
    pose: Pose  # of its middle in R, x pointing away from the robot
    length: float  # m


class BumperReading(NamedTuple):
    tick: int
    segments: Tuple[BumperSegment, ...]


class Contact(NamedTuple):
    part: int  # the model of the robot
    other: int  # the model that it touches
    x: float  # m, in W
    y: float
    z_min: float
    z_max: float


class ContactReading(NamedTuple):
    tick: int
    contacts: Tuple[Contact, ...]


class Blob(NamedTuple):
    """A patch of one colour in the image; right and bottom are beyond its last pixels."""

    color: Tuple[float, float, float, float]  # red, green, blue, alpha, 0 to 1
    left: int
    top: int
    right: int
    bottom: int
    range: float  # m


class BlobfinderReading(NamedTuple):
    tick: int
    width: int  # pixels
    height: int
    fov: float  # rad, of the width
    blobs: Tuple[Blob, ...]


class Map(NamedTuple):
    """The static bodies of a world at one height."""

    occupied: "numpy.ndarray[Any, Any]"  # bool (rows, columns); row 0 is the lowest in y
    resolution: float  # m, of a cell
    origin: Tuple[float, float]  # m in W: the lower left corner of cell (0, 0)


class CameraReading(NamedTuple):
    tick: int
    colors: "numpy.ndarray[Any, Any]"  # uint8 (height, width, 3): red, green, blue
    depths: "numpy.ndarray[Any, Any]"  # float32 (height, width), m ahead; -inf: too near, inf: beyond the limits, or no hit
    models: "numpy.ndarray[Any, Any]"  # int32 (height, width): the model seen; -1: ground, -2: nothing
    focal_length: Tuple[float, float]  # pixels: of the columns, of the rows
    center: Tuple[float, float]  # pixels from the left and upper edge
    min: float  # m
    max: float
    pose: Pose

    @property
    def points(self) -> "numpy.ndarray[Any, Any]":
        """What is seen as points (n, 3), m in S; pixels without a hit are left out."""
        import numpy
        rows, columns = numpy.nonzero(numpy.isfinite(self.depths))
        depths = self.depths[rows, columns].astype(float)
        return numpy.stack([depths, depths * (self.center[0] - columns - 0.5) / self.focal_length[0],
                            depths * (self.center[1] - rows - 0.5) / self.focal_length[1]], axis=-1)


class Place(NamedTuple):
    """Of the sender's antenna, seen from the receiver's."""

    range: float  # m
    bearing: float  # rad, in S
    elevation: float  # rad, above the horizontal


class Reception(NamedTuple):
    """A message that a radio receives."""

    sender: int  # a robot's number
    to_all: bool
    data: bytes
    rssi: float  # dBm
    tick: int  # in which it was sent
    place: Optional[Place]


class RadioReading(NamedTuple):
    tick: int
    receptions: Tuple[Reception, ...]
    range: float  # m, of the messages that it sends


class ImuReading(NamedTuple):
    tick: int
    heading: float  # rad, of S in W
    turn: float  # rad/s, about z
    force: Tuple[float, float, float]  # m/s^2, in S; upwards with gravity
    pose: Pose


Reading = Union[RangerReading, BreakBeamReading, FiducialReading, BumperReading, ContactReading, BlobfinderReading,
                CameraReading, RadioReading, ImuReading, None]


class JointReading(NamedTuple):
    position: float  # m or rad
    velocity: float
    blocked: bool  # a contact ended the last tick's motion
    moving: bool  # on its way to its target


class GripperReading(NamedTuple):
    """Models are named; None: nothing."""

    fingers: str  # "open", "closing", "closed" or "opening"
    lift_moving: bool
    lift_position: float  # m
    lift_percent: float
    left_contact: Optional[str]
    right_contact: Optional[str]
    held: Optional[str]
    clamped: Optional[str]  # between the pads, also while another gripper holds it
    beams: Tuple[Optional[str], ...]  # the object in each beam, where the controller subscribes to them


class EnergyReading(NamedTuple):
    joules: float
    capacity: float  # J; 0: endless
    charge_watts: float


class Goal(NamedTuple):
    number: int  # another number is another goal
    waypoints: Tuple[Tuple[float, float], ...]  # m, in the frame of the pose estimate
    heading: Optional[float]  # rad, at the last one
    heights: Tuple[float, ...]  # m, of the floors at the points; none: on the level of the robot


_MASK = (1 << 64) - 1


def _uniform(*key: int) -> float:
    state = 0x6A09E667F3BCC908  # as troupe/random.h
    for word in key:
        state = ((state ^ word) * 0x9E3779B97F4A7C15) & _MASK
        state ^= state >> 30
        state = (state * 0xBF58476D1CE4E5B9) & _MASK
        state ^= state >> 27
        state = (state * 0x94D049BB133111EB) & _MASK
        state ^= state >> 31
    return (state >> 11) * 2.0**-53


class Observation(NamedTuple):
    """What a controller knows in one tick."""

    tick: int
    time: float  # s, simulated
    interval: float  # s, the length of a tick
    pose: Pose  # of R, estimated: in W (gps), or from where the robot started (odometry)
    twist: Twist  # executed during the last tick
    stalled: bool  # a contact ended the last motion
    sensors: Tuple[Reading, ...]  # as in RobotInfo.sensors; None where not subscribed, or not measured yet
    joints: Tuple[JointReading, ...]
    grippers: Tuple[GripperReading, ...]
    lights: Tuple[bool, ...]
    energy: Optional[EnergyReading]
    goal: Optional[Goal]  # that a user has sent the robot to
    random_key: int  # of this robot and tick
    doors: Tuple[float, ...] = ()  # of the world: from 0, closed, to 1
    lifts: Tuple[LiftReading, ...] = ()  # of the world

    def random(self, i: int = 0) -> float:
        """The i-th of this tick's uniform numbers in [0, 1): the same in every run with the same seed."""
        return _uniform(self.random_key, i)


class GripperCommand(NamedTuple):
    """A part that is None keeps its last command."""

    gripper: int = 0
    fingers: Optional[str] = None  # "open", "close" or "stay"
    lift: Optional[float] = None  # percent, 0 to 100
    opening: Optional[float] = None  # percent, in place of `fingers`


class JointCommand(NamedTuple):
    """One of the two; valid until the next command to the joint."""

    joint: int
    position: Optional[float] = None  # m or rad
    velocity: Optional[float] = None  # m/s or rad/s


class RadioMessage(NamedTuple):
    radio: int  # in RobotInfo.sensors
    data: bytes
    to: Optional[int] = None  # a robot's number; None: all in range


class LightOrder(NamedTuple):
    light: int
    on: bool


class CameraOrder(NamedTuple):
    sensor: int
    pan: float = 0.0  # rad, to the left
    tilt: float = 0.0  # rad, upwards


class DoorOrder(NamedTuple):
    door: int
    opening: float = 1.0  # from 0, closed, to 1


class LiftOrder(NamedTuple):
    """A call, which begins a session: until it is ended, the calls of other robots do not count."""

    lift: int
    floor: int = 0
    ends: bool = False  # ends the session, without a call


class TrafficOrder(NamedTuple):
    """Takes part in the planned traffic of lanes, in each tick in which it does. Vertices are counted through all graphs of the world."""

    at: int  # the vertex that it is at, of the graph that it drives on
    goal: Optional[int] = None  # of the same graph; None: it makes room for others
    holds: bool = False  # it stays where it is, for instance while it is loaded
    finished: int = 0  # moves since it takes part
    driven: float = 0.0  # m, along the lane of its present move
    blocked: bool = False  # a body that takes no part is in the way of its present move


class ChargeOrder(NamedTuple):
    """Wants to charge, in each tick in which it does. Vertices are counted through all graphs of the world."""

    vertex: Optional[int] = None  # that it wants for itself; None: it waits, and keeps what it has
    at_charger: bool = False  # the vertex is a charger, not a place where it waits for one


class JobOrder(NamedTuple):
    """Brings goods, in each tick in which it does."""

    free: bool = False  # it may get another job
    loads: bool = False  # it has the goods of its job from now on
    delivers: bool = False  # they are where they have to be


class WaitOrder(NamedTuple):
    """Says that it stands on its way to a goal, in each tick in which it does: the table `waits`, signals and events tell it."""

    thing: Optional[int] = None  # the model for which it waits; None: it does not know
    lane: Optional[int] = None  # on which it cannot go on, counted through all graphs of the world


class LoadOrder(NamedTuple):
    """Takes an object onto the robot, or puts it down from there, as at a station. Without an effect where it cannot."""

    object: int  # the root model of the object
    takes: bool = True  # False: puts it down at
    x: float = 0.0  # m, in W
    y: float = 0.0


class Command(NamedTuple):
    """The command for one tick. A motion ends with the tick; the other commands are valid until the next ones."""

    vx: float = 0.0  # m/s; of differential and omni drives, in R
    vy: float = 0.0
    wz: float = 0.0  # rad/s
    speed: float = 0.0  # m/s, of the steered wheel of a car
    steering: float = 0.0  # rad, of a car
    grippers: Sequence[GripperCommand] = ()
    joints: Sequence[JointCommand] = ()
    messages: Sequence[RadioMessage] = ()
    orders: Sequence[Union[LightOrder, CameraOrder, DoorOrder, LiftOrder, TrafficOrder, ChargeOrder, JobOrder, WaitOrder, LoadOrder]] = ()  # executed in order
    report: str = ""  # an event of the run, for users
    say: str = ""  # a text for users, an event of the run
