"""A ROS 2 planner over DDS with types and serialisation of Cyclone DDS's own, without this project."""

import sys
import time
from dataclasses import dataclass
from pathlib import Path

from cyclonedds.core import Listener, Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float64, int32, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "nodes"))
from following import Steps


@dataclass
class Time(IdlStruct, typename="builtin_interfaces.msg.dds_.Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class Clock(IdlStruct, typename="rosgraph_msgs.msg.dds_.Clock_"):
    clock: Time


@dataclass
class Header(IdlStruct, typename="std_msgs.msg.dds_.Header_"):
    stamp: Time
    frame_id: str


@dataclass
class Vector(IdlStruct, typename="geometry_msgs.msg.dds_.Vector3_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Point(IdlStruct, typename="geometry_msgs.msg.dds_.Point_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs.msg.dds_.Quaternion_"):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
class Pose(IdlStruct, typename="geometry_msgs.msg.dds_.Pose_"):
    position: Point
    orientation: Quaternion


@dataclass
class PoseStamped(IdlStruct, typename="geometry_msgs.msg.dds_.PoseStamped_"):
    header: Header
    pose: Pose


@dataclass
class PoseWithCovariance(IdlStruct, typename="geometry_msgs.msg.dds_.PoseWithCovariance_"):
    pose: Pose
    covariance: array[float64, 36]


@dataclass
class Twist(IdlStruct, typename="geometry_msgs.msg.dds_.Twist_"):
    linear: Vector
    angular: Vector


@dataclass
class TwistWithCovariance(IdlStruct, typename="geometry_msgs.msg.dds_.TwistWithCovariance_"):
    twist: Twist
    covariance: array[float64, 36]


@dataclass
class Odometry(IdlStruct, typename="nav_msgs.msg.dds_.Odometry_"):
    header: Header
    child_frame_id: str
    pose: PoseWithCovariance
    twist: TwistWithCovariance


@dataclass
class TwistStamped(IdlStruct, typename="geometry_msgs.msg.dds_.TwistStamped_"):
    header: Header
    twist: Twist


LOOPBACK = (
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface "
    "address='127.0.0.1'/></Interfaces><AllowMulticast>false</AllowMulticast>"
    "</General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
    "<Peers><Peer address='127.0.0.1'/></Peers></Discovery></Domain></CycloneDDS>"
)
RELIABLE = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10))


class Follower(Listener):
    """Decides once odometry, waypoint and clock of one step are there."""

    def __init__(self, participant, steps):
        super().__init__()
        self.steps, self.kept = Steps(self.answer, steps), []
        self.writer = DataWriter(participant, Topic(participant, "rt/cmd_vel", TwistStamped), qos=RELIABLE)
        for topic, kind in (("rt/odom", Odometry), ("rt/waypoint", PoseStamped), ("rt/clock", Clock)):
            self.kept.append(DataReader(participant, Topic(participant, topic, kind), qos=RELIABLE, listener=self))

    def on_data_available(self, reader):
        for message in reader.take(N=10):
            if not isinstance(message, Odometry | PoseStamped | Clock):
                continue
            stamp = message.clock if isinstance(message, Clock) else message.header.stamp
            role = {Odometry: "odometry", PoseStamped: "waypoint", Clock: "clock"}[type(message)]
            self.steps.take(role, (stamp.sec, stamp.nanosec), message)

    def answer(self, stamp, speed, turn):
        self.writer.write(
            TwistStamped(Header(Time(*stamp), "base_link"), Twist(Vector(speed, 0.0, 0.0), Vector(0.0, 0.0, turn)))
        )


number = int(sys.argv[2])
domain = Domain(number, LOOPBACK)
follower = Follower(DomainParticipant(number), int(sys.argv[1]))
while True:
    time.sleep(1.0)
