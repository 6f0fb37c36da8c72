"""A stand-in for Nav2 by rclpy's action server and nav2_msgs, without this project: it drives to waypoints.

usage: ACTION PLAN

ACTION is follow_path or navigate_to_pose. PLAN has a letter for each episode, which says what becomes of its goals: F,
they are followed; E, after ten commands the server says that it has arrived; A, it gives up then; D, the process ends
then; R, goals are rejected. Each goal that is taken is printed: where it leads, and the controller that it asks for. So
is a cancellation.
"""

import math
import os
import sys
from pathlib import Path

import rclpy
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav2_msgs.action import FollowPath, NavigateToPose
from nav_msgs.msg import Odometry
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future
from rosgraph_msgs.msg import Clock

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "nodes"))
from following import Steps

ENOUGH = 10  # commands
LOOK = 0.02  # s between two looks whether a goal is cancelled
PAUSE = 0.9  # s by which the clock goes on between two episodes
ENDLESS = 10**9  # steps
KINDS = {"follow_path": FollowPath, "navigate_to_pose": NavigateToPose}


class Nav2(Node):
    def __init__(self, action, plan):
        super().__init__("nav2")
        self.kind, self.plan, self.goal, self.ends = KINDS[action], plan, None, {}
        self.episode, self.count, self.last = -1, 0, -math.inf
        self.steps = Steps(self.answer, ENDLESS)
        self.publisher = self.create_publisher(TwistStamped, "/cmd_vel", 10)
        for kind, topic, role in ((Odometry, "/odom", "odometry"), (PoseStamped, "/waypoint", "waypoint")):
            self.create_subscription(kind, topic, lambda got, role=role: self.take(role, got.header.stamp, got), 10)
        self.create_subscription(Clock, "/clock", self.tick, 10)
        self.server = ActionServer(
            self,
            self.kind,
            action,
            self.execute,
            goal_callback=self.judge,
            handle_accepted_callback=self.accept,
            cancel_callback=lambda handle: CancelResponse.ACCEPT,
        )
        self.create_timer(LOOK, self.look)

    def tick(self, message):
        if self.kind is FollowPath:  # an episode has one goal for a pose, and any number of paths
            self.note(message.clock)
        self.take("clock", message.clock, message)

    def note(self, stamp):
        seconds = stamp.sec + stamp.nanosec * 1e-9
        if seconds - self.last > (PAUSE if self.kind is FollowPath else 0.0):
            self.episode, self.count = self.episode + 1, 0
            self.what = self.plan[self.episode]
        self.last = max(seconds, self.last)

    def look(self):
        if self.goal is not None and self.goal.is_cancel_requested:
            self.end(self.goal.canceled, 0, "")
            print("cancelled", flush=True)

    def judge(self, request):
        self.note(getattr(request, "path", getattr(request, "pose", None)).header.stamp)
        return GoalResponse.REJECT if self.what == "R" else GoalResponse.ACCEPT

    def accept(self, handle):
        if self.goal is not None:
            self.end(self.goal.abort, 0, "a newer one came")
        self.goal, self.ends[bytes(handle.goal_id.uuid)] = handle, Future()
        request = handle.request
        target = request.path.poses[-1] if hasattr(request, "path") else request.pose
        place = target.pose.position
        print(f"{place.x:.1f} {place.y:.1f} {getattr(request, 'controller_id', '')}", flush=True)
        handle.execute()

    async def execute(self, handle):
        return await self.ends[bytes(handle.goal_id.uuid)]

    def end(self, transition, code, text):
        goal, self.goal = self.goal, None
        transition()
        result = self.kind.Result(error_code=code, error_msg=text)
        self.ends[bytes(goal.goal_id.uuid)].set_result(result)

    def take(self, role, stamp, message):
        self.steps.take(role, (stamp.sec, stamp.nanosec), message)

    def answer(self, stamp, speed, turn):
        if self.goal is None:
            return
        self.count += 1
        if self.count > ENOUGH and self.what == "D":
            os._exit(1)
        if self.count > ENOUGH and self.what == "E":
            self.end(self.goal.succeed, 0, "")
            return
        if self.count > ENOUGH and self.what == "A":
            self.end(self.goal.abort, self.kind.Result.TF_ERROR, "no way")
            return
        command = TwistStamped()
        command.header.stamp.sec, command.header.stamp.nanosec = stamp
        command.twist.linear.x, command.twist.angular.z = speed, turn
        self.publisher.publish(command)


rclpy.init(signal_handler_options=SignalHandlerOptions.NO)  # rclpy's own may end a spin with one of several errors
rclpy.spin(Nav2(*sys.argv[1:]))
