"""Send goals to a move_base as anybody does, by Debian's actionlib, without this project.

usage: X Y [FRAME [FEEDBACKS after which it is cancelled]]
"""

import sys

import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal

rospy.init_node("sender")
feedback = []
client = actionlib.SimpleActionClient("move_base", MoveBaseAction)
assert client.wait_for_server(rospy.Duration(60)), "there is no server"
goal = MoveBaseGoal()
goal.target_pose.header.frame_id = sys.argv[3] if len(sys.argv) > 3 else "map"
goal.target_pose.pose.position.x, goal.target_pose.pose.position.y = float(sys.argv[1]), float(sys.argv[2])
goal.target_pose.pose.orientation.w = 1.0
client.send_goal(goal, feedback_cb=lambda message: feedback.append(message.base_position.pose.position.x))
if len(sys.argv) > 4:
    while len(feedback) < int(sys.argv[4]):
        rospy.sleep(0.05)
    client.cancel_goal()
assert client.wait_for_result(rospy.Duration(120)), "no result"
print(
    actionlib.GoalStatus.to_string(client.get_state()),
    client.get_goal_status_text(),
    len(feedback),
    feedback[-1] if feedback else 0.0,
)
