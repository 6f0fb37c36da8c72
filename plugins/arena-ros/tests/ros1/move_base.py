"""A planner that serves move_base's action as move_base does: by actionlib, at a rate of the simulated clock, with
commands without stamps.

usage: FOLLOW|GIVE_UP TOPIC

FOLLOW drives towards the goal straight on and stops there, GIVE_UP aborts after twenty commands; TOPIC says where it
is.
"""

import sys
from pathlib import Path

import actionlib
import rospy
from geometry_msgs.msg import Twist
from move_base_msgs.msg import MoveBaseAction, MoveBaseResult
from nav_msgs.msg import Odometry

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "nodes"))
from following import command

NEAR = 0.1  # m


class MoveBase:
    def __init__(self, gives_up, topic):
        self.gives_up, self.pose = gives_up, None
        self.publisher = rospy.Publisher("/cmd_vel", Twist, queue_size=10, tcp_nodelay=True)
        rospy.Subscriber(topic, Odometry, self.take, tcp_nodelay=True)
        self.server = actionlib.SimpleActionServer("move_base", MoveBaseAction, self.drive, auto_start=False)
        self.server.start()

    def take(self, message):
        self.pose = message.pose.pose

    def drive(self, goal):
        target, rate, count = goal.target_pose.pose.position, rospy.Rate(10), 0
        while not rospy.is_shutdown():
            rate.sleep()
            if self.server.is_preempt_requested():
                self.server.set_preempted()
                return
            if self.pose is None:
                continue
            count += 1
            if self.gives_up and count > 20:
                self.server.set_aborted(MoveBaseResult(), "no way")
                return
            if abs(target.x - self.pose.position.x) + abs(target.y - self.pose.position.y) < NEAR:
                self.publisher.publish(Twist())
                self.server.set_succeeded()
                return
            twist = Twist()
            twist.linear.x, twist.angular.z = command(self.pose, target)
            self.publisher.publish(twist)


rospy.init_node("move_base")
MoveBase(sys.argv[1] == "GIVE_UP", sys.argv[2])
rospy.spin()
