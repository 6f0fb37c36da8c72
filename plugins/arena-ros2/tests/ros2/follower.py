"""A ROS 2 planner as anybody writes one: towards the waypoint, by rclpy and its message packages, without this project."""

import math

import rclpy
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rosgraph_msgs.msg import Clock


def yaw(q):
    return math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))


class Follower(Node):
    def __init__(self):
        super().__init__("follower")
        self.newest = {}
        self.publisher = self.create_publisher(TwistStamped, "/cmd_vel", 10)
        for topic, kind in (("/odom", Odometry), ("/waypoint", PoseStamped), ("/clock", Clock)):
            self.create_subscription(kind, topic, self.take, 10)

    def take(self, message):
        stamp = message.clock if isinstance(message, Clock) else message.header.stamp
        self.newest[type(message)] = (stamp.sec, stamp.nanosec), message
        if len(self.newest) == 3 and len({each[0] for each in self.newest.values()}) == 1:
            self.decide(stamp)

    def decide(self, stamp):
        where, target = self.newest[Odometry][1].pose.pose, self.newest[PoseStamped][1].pose.position
        bearing = math.atan2(target.y - where.position.y, target.x - where.position.x) - yaw(where.orientation)
        bearing = math.atan2(math.sin(bearing), math.cos(bearing))
        command = TwistStamped()
        command.header.stamp = stamp
        command.twist.linear.x = 0.5 if abs(bearing) < 0.5 else 0.0
        command.twist.angular.z = max(-1.0, min(1.0, 2.0 * bearing))
        self.publisher.publish(command)


rclpy.init()
rclpy.spin(Follower())
