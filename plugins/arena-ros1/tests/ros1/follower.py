"""A ROS 1 planner as anybody writes one: towards the waypoint, by Debian's Python and message packages, without this project."""

import math
import sys

import rospy
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock


def yaw(q):
    return math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))


class Follower:
    def __init__(self, steps):
        self.steps = steps
        self.newest = {}
        self.done = None
        self.publisher = rospy.Publisher("/cmd_vel", TwistStamped, queue_size=10, tcp_nodelay=True)
        for topic, kind in (("/odom", Odometry), ("/waypoint", PoseStamped)):
            rospy.Subscriber(topic, kind, self.take, callback_args=topic, tcp_nodelay=True)
        rospy.Subscriber("/clock", Clock, lambda message: self.take_stamp("/clock", message.clock, message), tcp_nodelay=True)

    def take(self, message, topic):
        self.take_stamp(topic, message.header.stamp, message)

    def take_stamp(self, topic, stamp, message):
        self.newest[topic] = stamp, message
        stamps = {each[0] for each in self.newest.values()}
        if len(self.newest) == 3 and len(stamps) == 1:
            self.decide(stamp)

    def decide(self, stamp):
        self.steps -= 1
        if self.steps == 0:
            rospy.signal_shutdown("tired")
            return
        where, target = self.newest["/odom"][1].pose.pose, self.newest["/waypoint"][1].pose.position
        bearing = math.atan2(target.y - where.position.y, target.x - where.position.x) - yaw(where.orientation)
        bearing = math.atan2(math.sin(bearing), math.cos(bearing))
        command = TwistStamped()
        command.header.stamp = stamp
        command.twist.linear.x = 0.5 if abs(bearing) < 0.5 else 0.0
        command.twist.angular.z = max(-1.0, min(1.0, 2.0 * bearing))
        self.publisher.publish(command)


rospy.init_node("follower", disable_rostime=True)
Follower(int(sys.argv[1]) if len(sys.argv) > 1 else -1)
rospy.spin()
