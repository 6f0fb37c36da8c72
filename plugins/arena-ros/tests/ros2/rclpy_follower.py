"""A ROS 2 planner as anybody writes one: towards the waypoint, by rclpy and its message
packages, without this project.
"""

import sys
from pathlib import Path

import rclpy
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rosgraph_msgs.msg import Clock

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "nodes"))
from following import Steps


class Follower(Node):
    def __init__(self, steps):
        super().__init__("follower")
        self.steps = Steps(self.answer, steps)
        self.publisher = self.create_publisher(TwistStamped, "/cmd_vel", 10)
        self.create_subscription(
            Odometry, "/odom", lambda message: self.take("odometry", message.header.stamp, message), 10
        )
        self.create_subscription(
            PoseStamped, "/waypoint", lambda message: self.take("waypoint", message.header.stamp, message), 10
        )
        self.create_subscription(Clock, "/clock", lambda message: self.take("clock", message.clock, message), 10)

    def take(self, role, stamp, message):
        self.steps.take(role, (stamp.sec, stamp.nanosec), message)

    def answer(self, stamp, speed, turn):
        command = TwistStamped()
        command.header.stamp.sec, command.header.stamp.nanosec = stamp
        command.twist.linear.x, command.twist.angular.z = speed, turn
        self.publisher.publish(command)


rclpy.init(signal_handler_options=SignalHandlerOptions.NO)  # as in nav2_server.py
rclpy.spin(Follower(int(sys.argv[1])))
