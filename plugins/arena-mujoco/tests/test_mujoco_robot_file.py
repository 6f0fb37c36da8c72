"""A body from a file, MJCF or URDF: it drives as its robot should, and what is missing in the file is one line."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from arena_core import ConfigurationError, Footprint, InputFileError, Pose
from arena_core.testing import component, robot, scenario
from arena_mujoco.body_attachment import static_model

MODELS = Path(__file__).parent / "models"
CART = [
    f"simulator.body.model={MODELS / 'cart.urdf'}",
    "simulator.body.joints.wheels=[left_wheel_joint,right_wheel_joint]",
    "simulator.body.joints.casters=[caster]",
    "simulator.body.joints.lidar=laser",
]
CAR = [
    f"simulator.body.model={MODELS / 'car.xml'}",
    "simulator.body.joints.wheels=[rear_left,rear_right,front_left,front_right]",
    "simulator.body.joints.steering=[left_steer,right_steer]",
    "simulator.body.joints.lidar=eye",
]
DRIVES = pytest.mark.parametrize("drive", ["planar", "wheels"])


def body_of(name):
    if name == "cart":
        return robot()
    car = Footprint.polygon([[0.45, 0.22], [-0.11, 0.22], [-0.11, -0.22], [0.45, -0.22]])
    return replace(robot("ackermann"), footprint=car, wheelbase=0.34)


def built(simulate, name, *overrides):
    return simulate(body_of(name), *(CART if name == "cart" else CAR), *overrides)


def run(simulator, command, steps, start=None):
    snapshots = [simulator.reset([scenario(start=start or Pose(-2.0, -2.0, 0.3))])]
    return snapshots + [simulator.advance(np.array([command], float), 10) for _ in range(steps)]


def test_file_says_mass_heights_and_wheels(simulate):
    cart, car = built(simulate, "cart")._body, built(simulate, "car")._body
    assert cart.mass == pytest.approx(4.65)
    assert (cart.wheels.radius, cart.height, cart.lidar_height) == pytest.approx((0.06, 0.16, 0.18))
    assert cart.wheels.places == [[pytest.approx(0.0), pytest.approx(y)] for y in (0.14, -0.14)]
    assert cart.clearance == pytest.approx(0.04)
    assert car.mass == pytest.approx(10.2)
    assert (car.wheels.radius, car.height, car.lidar_height) == pytest.approx((0.1, 0.21, 0.3))


@DRIVES
@pytest.mark.parametrize(("name", "command"), [("cart", (0.5, 0.0, 0.6)), ("car", (0.5, 0.0, 0.5))])
def test_body_of_a_file_drives_as_commanded(simulate, drive, name, command):
    last = run(built(simulate, name, f"simulator.drive={drive}"), command, 40)[-1]
    assert not last.failures
    assert last.twists[0] == pytest.approx(command, abs=0.05)
    by_wheels = Pose(-2.0, -2.0, 0.3).compose(Pose.of(last.odometry_poses[0]))
    assert by_wheels.distance(Pose.of(last.poses[0])) < 0.15


def test_mirrored_wheel_turns_the_other_way(simulate):
    last = run(built(simulate, "cart", "simulator.drive=wheels"), (0.4, 0.0, 0.0), 30)[-1]
    assert last.twists[0] == pytest.approx((0.4, 0.0, 0.0), abs=0.03)


def test_robot_on_wheels_of_a_file_stops_at_the_wall(simulate):
    snapshots = run(built(simulate, "cart", "simulator.drive=wheels"), (0.8, 0.0, 0.0), 30, Pose(3.5, 0.0, 0.0))
    assert [contact.kind for snapshot in snapshots for contact in snapshot.contacts[0]][:1] == ["wall"]
    assert 4.70 < snapshots[-1].poses[0, 0] < 4.95 - 0.2 + 0.005  # it leans on its wheels


def test_figures_of_the_robot_do_not_change_the_body_of_a_file(simulate):
    body = built(
        simulate, "cart", "simulator.body.mass=9.0", "simulator.body.height=1.0", "simulator.body.lidar_height=0.5"
    )._body
    assert (body.mass, body.height, body.lidar_height) == pytest.approx((4.65, 0.16, 0.18))
    unnamed = built(simulate, "cart", "simulator.body.joints.lidar=null", "simulator.body.lidar_height=0.5")._body
    assert unnamed.lidar_height == 0.5


def test_both_lidars_see_the_same_from_the_body_of_a_file(simulate):
    sliced, by_rays = (
        run(built(simulate, "cart", "simulator.drive=wheels", f"simulator.lidar={kind}"), (0.0, 0.0, 0.0), 5)[-1]
        for kind in ("slice", "rays")
    )
    assert np.isfinite(by_rays.ranges).mean() > 0.5
    assert (by_rays.ranges < 0.5).sum() == 0  # it does not see itself
    one, other = (np.where(np.isinf(snapshot.ranges), 8.0, snapshot.ranges) for snapshot in (sliced, by_rays))
    assert np.median(np.abs(one - other)) < 0.01


def test_world_is_the_same_in_a_batch_and_alone(simulate):
    worlds = [scenario(start=Pose(-2.0, -2.0, turn)) for turn in (0.0, 1.0)]
    batch, alone = (built(simulate, "cart", "simulator.drive=wheels") for _ in range(2))
    batch.reset(worlds)
    alone.reset(worlds[1:])
    for _ in range(10):
        many, one = batch.advance(np.tile((0.4, 0.0, 0.4), (2, 1)), 10), alone.advance(np.array([(0.4, 0.0, 0.4)]), 10)
    assert many.poses[1].tobytes() == one.poses[0].tobytes()


def wrong(tmp_path, text, ending="xml"):
    path = tmp_path / f"bad.{ending}"
    path.write_text(text)
    return f"simulator.body.model={path}"


@pytest.mark.parametrize(
    ("text", "ending", "said"),
    [
        ("<mujoco><worldbody>", "xml", "is no XML"),
        ("<robot name='a'><link/></robot>", "urdf", "MuJoCo cannot read it"),
        ("", "xml", "is no XML"),
        (
            "<mujoco><asset><mesh file='none.stl'/></asset><worldbody><body><freejoint/><geom "
            "size='1'/></body></worldbody></mujoco>",
            "xml",
            "MuJoCo refuses the model .*none.stl",
        ),
        (
            "<mujoco><worldbody><body name='a'><freejoint/><inertial pos='0 0 0' mass='0' diaginertia='0 0 "
            "0'/></body></worldbody></mujoco>",
            "xml",
            "MuJoCo",
        ),
        (
            "<mujoco><worldbody><body name='arm'><geom size='1'/></body></worldbody></mujoco>",
            "xml",
            r"has 0 free bases among its outermost bodies \(arm\); allowed: one, with a freejoint",
        ),
        ("<mujoco><worldbody/></mujoco>", "xml", r"has 0 free bases .*\(none\)"),
        (
            "<mujoco><worldbody><body name='a'><freejoint/><geom size='1'/></body><body "
            "name='b'><freejoint/><geom size='1'/></body>"
            "</worldbody></mujoco>",
            "xml",
            r"has 2 free bases .*\(a, b\)",
        ),
        (
            "<robot name='a'><link name='a'><collision><geometry><mesh "
            "filename='package://a/none.stl'/></geometry></collision></link></robot>",
            "urdf",
            "MuJoCo refuses the model .*none.stl",
        ),
    ],
)
def test_file_that_is_no_body_is_refused_in_one_line(simulate, tmp_path, text, ending, said):
    with pytest.raises(InputFileError, match=said) as raised:
        simulate(robot(), wrong(tmp_path, text, ending))
    assert "\n" not in str(raised.value)
    assert str(tmp_path / "bad") in str(raised.value)


def test_missing_file_is_refused(simulate, tmp_path):
    with pytest.raises(InputFileError, match=r"none.urdf: is missing; allowed: a MuJoCo model \(MJCF\) or URDF"):
        simulate(robot(), f"simulator.body.model={tmp_path / 'none.urdf'}")


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        (
            ["simulator.body.joints.wheels=[left_wheel_joint,right]"],
            r"simulator.body.joints.wheels is 'right'; allowed, of the hinges of .*cart.urdf: left_wheel_joint, "
            r"right_wheel_joint",
        ),
        (
            ["simulator.body.joints.casters=[ball]"],
            r"joints.casters is 'ball'; allowed, of the bodies of .*: base_link, chassis",
        ),
        (
            ["simulator.body.joints.lidar=camera"],
            r"joints.lidar is 'camera'; allowed, of the bodies and sites of .*laser",
        ),
        (
            ["simulator.body.joints.steering=[left_wheel_joint]"],
            "joints.steering is .*; allowed: none for differential kinematics",
        ),
        (
            ["simulator.body.joints.wheels=[left_wheel_joint]", "simulator.drive=wheels"],
            "has 1 joints; allowed .*: 2 at least",
        ),
    ],
)
def test_name_that_is_not_in_the_file_is_refused_with_those_that_are(simulate, overrides, said):
    with pytest.raises(ConfigurationError, match=said):
        built(simulate, "cart", *overrides)


def test_joint_about_another_axis_is_no_wheel(simulate):
    with pytest.raises(ConfigurationError, match=r"left_steer of .*car.xml turns about another axis than y"):
        built(simulate, "car", "simulator.body.joints.wheels=[left_steer,rear_right]")


def test_car_that_steers_by_no_joint_does_not_drive_on_wheels(simulate):
    with pytest.raises(ConfigurationError, match=r"joints.steering is empty"):
        built(simulate, "car", "simulator.body.joints.steering=[]", "simulator.drive=wheels")


def test_omniwheels_of_a_file_are_refused(simulate):
    with pytest.raises(ConfigurationError, match="allowed: planar"):
        simulate(robot("omnidirectional"), *CART, "simulator.drive=wheels")


def test_body_of_another_robot_is_left_alone(simulate):
    assert simulate(robot(), "simulator.body.of=somebody", "simulator.body.model=none.urdf")._body.own is None
    assert (
        component("simulator", "mujoco", robot=robot(), pedestrians=component("pedestrians", "none"))._body.own is None
    )


def test_picture_has_the_shapes_of_the_file_and_nothing_that_moves(simulate):
    own = built(simulate, "car")._body.own
    model = static_model(
        "<mujoco><worldbody><body name='robot' mocap='true'/></worldbody></mujoco>", "a picture", own, 1
    )
    assert (model.njnt, model.nu) == (0, 0)
    assert model.ngeom == 5
    assert set(model.geom_group.tolist()) == {1}


BODY = "<worldbody><body name='a'><freejoint/><geom size='1'/>{}</body></worldbody>"


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (
            "<mujoco><asset><hfield name='h' nrow='60000' ncol='60000' size='1 1 1 1'/></asset>" + BODY,
            "its size is 3.6e.09",
        ),
        ("<mujoco><size nuserdata='2000000000'/>" + BODY, "nuserdata is 4e.06"),
        ("<mujoco><size nuser_body='2000000000'/>" + BODY, "nuser_body is 4e.06"),
        (
            "<mujoco><worldbody><replicate count='1000000000'><geom size='1'/></replicate></worldbody>",
            "has over 20000 elements",
        ),
        (
            "<mujoco><worldbody>"
            + "<replicate count='100'>" * 5
            + "<geom size='1'/>"
            + "</replicate>" * 5
            + "</worldbody>",
            "has over 20000",
        ),
        ("<mujoco><custom><numeric name='n' size='1000000000'/></custom>" + BODY, "size is 4e.06"),
        (
            "<mujoco><asset><texture name='t' builtin='flat' type='2d' width='90000' height='90000'/></asset>" + BODY,
            "its size is 8.1e.09",
        ),
        ("<mujoco><worldbody><composite type='cable' count='100000 100000 1'/></worldbody>", "its size is 4e.06"),
        ("<mujoco><sensor><user dim='2000000000'/></sensor>" + BODY, "its size is 4e.06"),
        ("<!DOCTYPE a [<!ENTITY b 'c'>]><mujoco>" + BODY, "line 1: has a document type"),
        (
            "<mujoco><include file='own.xml'/><include file='big.xml'/>" + BODY,
            "big.xml: line 1: has over 20000 elements",
        ),
    ],
)
def test_a_model_that_would_take_the_machines_memory_is_refused_at_once(simulate, tmp_path, content, fault):
    (tmp_path / "own.xml").write_text(content.format("") + "</mujoco>")
    (tmp_path / "big.xml").write_text(
        "<mujoco><worldbody><replicate count='1e9'><geom size='1'/></replicate></worldbody></mujoco>"
    )
    with pytest.raises(InputFileError, match=fault):
        simulate(robot(), f"simulator.body.model={tmp_path / 'own.xml'}")


def test_a_joint_whose_name_is_no_utf8_is_one_line(simulate, tmp_path):
    content = (
        "<?xml version='1.0' encoding='latin-1'?><mujoco>"
        + BODY.format("<body><joint name='r\xe4d'/><geom size='1'/></body>")
        + "</mujoco>"
    )
    (tmp_path / "own.xml").write_bytes(content.encode("latin-1"))
    with pytest.raises(InputFileError, match="is no text in UTF-8"):
        simulate(robot(), f"simulator.body.model={tmp_path / 'own.xml'}")
