"""The names of the motion models, as Nav2 calls them."""

from typing import Literal

MotionModel = Literal["DiffDrive", "Omni", "Ackermann"]
