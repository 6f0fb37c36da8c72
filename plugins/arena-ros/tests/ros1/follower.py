"""A ROS 1 planner as anybody writes one: towards the waypoint, by Debian's Python and message
packages, without this project.
"""

import sys
from pathlib import Path

import rospy
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "nodes"))
from following import Steps


class Follower:
    def __init__(self, steps):
        self.steps = Steps(self.answer, steps)
        self.publisher = rospy.Publisher("/cmd_vel", TwistStamped, queue_size=10, tcp_nodelay=True)
        for topic, kind, role in (
            ("/odom", Odometry, "odometry"),
            ("/waypoint", PoseStamped, "waypoint"),
            ("/clock", Clock, "clock"),
        ):
            rospy.Subscriber(topic, kind, self.take, callback_args=role, tcp_nodelay=True)

    def take(self, message, role):
        stamp = message.clock if role == "clock" else message.header.stamp
        self.steps.take(role, (stamp.secs, stamp.nsecs), message)

    def answer(self, stamp, speed, turn):
        command = TwistStamped()
        command.header.stamp = rospy.Time(*stamp)
        command.twist.linear.x, command.twist.angular.z = speed, turn
        self.publisher.publish(command)


rospy.init_node("follower", disable_rostime=True)
Follower(int(sys.argv[1]))
rospy.spin()
