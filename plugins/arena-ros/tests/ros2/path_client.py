"""Send paths to a controller as anybody does, by rclpy's action client and nav2_msgs, without this project.

usage: PLAN FIELD=VALUE...

PLAN is a word for each goal, sent one after the other: STRAIGHT to (8.5, 3), SIDE to (5, 4.5), EMPTY, NAN, POINT.
Each is sent once the goal before has given five feedbacks or has ended; CANCEL cancels the last goal then.
FIELD=VALUE sets a text of all goals, FRAME=NAME the frame of their paths, ACTION=NAME who is asked. Before, the
simulated robot is put to its start. One line is printed for each goal: status, error code, how many feedbacks came, the
first and last distance to the goal, the highest speed, and the message.
"""

import math
import sys
import time

import rclpy
from geometry_msgs.msg import PoseStamped
from nav2_msgs.action import FollowPath
from nav_msgs.msg import Odometry
from rclpy.action import ActionClient
from rclpy.node import Node
from std_msgs.msg import Empty

PLACES = {"STRAIGHT": [(1.5, 3.0), (8.5, 3.0)], "SIDE": [(1.5, 3.0), (5.0, 4.5)], "EMPTY": [], "POINT": [(2.0, 3.0)]}
PLACES["NAN"] = [(1.5, 3.0), (math.nan, 3.0)]
ENOUGH = 5  # feedbacks
LONG = 120.0  # s


class Client(Node):
    def __init__(self, fields):
        super().__init__("path_client")
        self.fields, self.frame, self.x = fields, fields.pop("FRAME", "map"), math.nan
        self.client = ActionClient(self, FollowPath, fields.pop("ACTION", "/follow_path"))
        self.create_subscription(Odometry, "/ground_truth", self.hear, 10)
        self.reset = self.create_publisher(Empty, "/arena/reset", 10)

    def hear(self, message):
        self.x = message.pose.pose.position.x

    def begin(self):
        assert self.client.wait_for_server(LONG), "there is no server"
        self.wait(lambda: not math.isnan(self.x))
        while self.x > PLACES["STRAIGHT"][0][0] + 0.2:
            self.reset.publish(Empty())
            rclpy.spin_once(self, timeout_sec=0.5)

    def send(self, plan):
        goal, heard = FollowPath.Goal(**self.fields), []
        goal.path.header.frame_id = self.frame
        for x, y in PLACES[plan]:
            pose = PoseStamped()
            pose.pose.position.x, pose.pose.position.y = x, y
            goal.path.poses.append(pose)
        sent = self.client.send_goal_async(goal, lambda message: heard.append(message.feedback))
        rclpy.spin_until_future_complete(self, sent, timeout_sec=LONG)
        assert sent.result().accepted
        return sent.result(), sent.result().get_result_async(), heard

    def wait(self, condition):
        end = time.monotonic() + LONG
        while not condition():
            rclpy.spin_once(self, timeout_sec=0.1)
            assert time.monotonic() < end, "it did not come so far"


rclpy.init()
words = sys.argv[1:]
node = Client(dict(word.split("=", 1) for word in words if "=" in word))
node.begin()
goals = []
for plan in [word for word in words if "=" not in word]:
    if goals:
        node.wait(lambda: len(goals[-1][2]) >= ENOUGH or goals[-1][1].done())
    if plan == "CANCEL":
        goals[-1][0].cancel_goal_async()
    else:
        goals.append(node.send(plan))
for _, result, heard in goals:
    node.wait(result.done)
    answer = result.result()
    ends = [f"{heard[k].distance_to_goal:.2f}" for k in (0, -1)] if heard else ["-", "-"]
    speed = max((each.speed for each in heard), default=0.0)
    print(answer.status, answer.result.error_code, len(heard), *ends, f"{speed:.2f}", answer.result.error_msg)
