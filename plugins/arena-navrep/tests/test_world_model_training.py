"""Vision codes what there is, memory foresees what comes, and a training that was cut off goes
on as if it had not been.
"""

from __future__ import annotations

import io
import json
import zipfile

import numpy as np
import pytest

from arena_core import ConfigurationError, testing
from arena_core.cli.main import main
from arena_gym.building import compose_environment
from arena_navrep.prediction import Sequences, prediction_errors
from arena_navrep.rollouts import Rollouts, read_rollouts, write_rollouts
from arena_navrep.world_model import PartCard, write_part

torch = pytest.importorskip("torch", reason="training needs the extra arena-navrep[train]")

TINY = [
    "robot=jackal",
    "world=indoor",
    "world.width=10.0",
    "world.height=10.0",
    "environment.worlds=1",
    "environment.problems_per_world=3",
    "observation_encoder.sectors=30",
    "recording.worlds=8",
    "recording.steps=60",
    "recording.files=2",
    "recording.test_files=1",
    "vision.code=6",
    "vision.epochs=10",
    "vision.minibatch=64",
    "memory.hidden=16",
    "memory.epochs=2",
    "memory.sequence=20",
]


def boxes(count, random):
    """Return scans (N, 40) of a wall with a box somewhere before it."""
    scans = np.full((count, 40), -1.0, np.float32)
    for scan, place, near in zip(scans, random.integers(0, 34, count), random.uniform(0.0, 2.0, count), strict=True):
        scan[place : place + 6] = near
    return torch.from_numpy(scans)


def fitted(network, batches, folder, epochs=4, score=dict, seed=0):
    from arena_navrep.training.fitting import fit_network

    return fit_network(network, batches, score, epochs, 0.003, seed, folder)


def test_vision_draws_again_what_it_coded(tmp_path):
    from arena_gym.training.settings import Convolution
    from arena_navrep.training.vision import Vision

    torch.manual_seed(0)
    vision = Vision(40, 8, [Convolution(8, 5, 2), Convolution(16, 3, 2)], 0.1, 0.0)
    train, test = boxes(2000, np.random.default_rng(0)), boxes(200, np.random.default_rng(1))
    fitted(vision, lambda random: (vision.loss(part, random) for part in train.split(50)), tmp_path, epochs=8)
    with torch.no_grad():
        missed = (vision.decode(vision(test)) - test).square().mean()
    assert missed < 0.25 * (test - test.mean(dim=0)).square().mean()
    assert vision(test).abs().max() <= 6.0


@pytest.mark.slow
def test_vision_that_grants_less_noise_to_what_is_near_draws_that_better(tmp_path):
    from arena_gym.training.settings import Convolution
    from arena_navrep.training.vision import Vision

    train, test = boxes(2000, np.random.default_rng(0)), boxes(200, np.random.default_rng(1))
    missed = {}
    for near in 0.0, 1.5:
        torch.manual_seed(0)
        vision = Vision(40, 3, [Convolution(8, 5, 2), Convolution(16, 3, 2)], 0.1, near)

        def losses(random, vision=vision):
            return (vision.loss(part, random) for part in train.split(50))

        fitted(vision, losses, tmp_path / str(near), epochs=8)
        with torch.no_grad():
            missed[near] = (vision.decode(vision(test)) - test)[test > 0.5].square().mean()
    assert missed[1.5] < 0.7 * missed[0.0]


def spinning(robots, steps, random):
    """Return sequences of codes that turn at a rate of their own, which only one who remembers can foresee."""
    turned = np.cumsum(np.repeat(random.uniform(-0.6, 0.6, (1, robots)), steps, axis=0), axis=0) + random.uniform(
        -3, 3, robots
    )
    codes = np.stack((np.cos(turned), np.sin(turned)), axis=2).astype(np.float32)
    begins = np.zeros((steps, robots), np.bool_)
    begins[0] = True
    before = np.concatenate((np.zeros_like(codes[:1]), codes[:-1]))
    return Sequences(codes, before, np.zeros((steps, robots, 1), np.float32), begins)


def test_memory_foresees_what_only_the_past_tells(tmp_path):
    from arena_navrep.training.memory import Memory
    from arena_navrep.training.stages import _mean_loss, _training_windows

    torch.manual_seed(0)
    memory = Memory(2, 1, 16, 3)
    windows = _training_windows(spinning(400, 20, np.random.default_rng(0)), 20)

    def losses(random):
        for chosen in torch.randperm(400, generator=random).split(20):
            yield _mean_loss(memory, *(part[:, chosen] for part in windows))

    fitted(memory, losses, tmp_path, epochs=20)
    test = spinning(50, 20, np.random.default_rng(1))

    def remembering(numbers):
        with torch.no_grad():
            return memory(torch.from_numpy(numbers)).numpy()

    def forgetful(numbers):
        return remembering(np.concatenate((numbers[:, :-16], np.zeros((len(numbers), 16), np.float32)), axis=1))

    errors = prediction_errors(test, remembering, 16)
    assert errors["prediction"] < 0.65 * errors["persistence"]
    assert prediction_errors(test, forgetful, 16)["prediction"] > 1.3 * errors["prediction"]


def test_memory_unrolled_is_memory_step_by_step():
    from arena_navrep.training.memory import Memory

    memory, random = Memory(3, 2, 5, 2), np.random.default_rng(0)
    inputs = torch.from_numpy(random.normal(size=(9, 4, 5)).astype(np.float32))
    begins = torch.from_numpy(random.random((9, 4)) < 0.3)
    with torch.no_grad():
        together, hidden = memory.unroll_memory(inputs, begins), torch.zeros(4, 5)
        for k in range(9):
            hidden = memory(torch.cat((inputs[k], torch.where(begins[k][:, None], 0.0, hidden)), dim=1))[:, :5]
            assert torch.allclose(hidden, together[k], atol=1e-6)


def test_surprise_is_that_of_the_mixture():
    from arena_navrep.training.memory import Memory

    memory, random = Memory(1, 1, 4, 3), torch.Generator().manual_seed(0)
    hidden, before = torch.randn(1, 4, generator=random), torch.randn(1, 1, generator=random)
    with torch.no_grad():
        codes = torch.linspace(-60.0, 60.0, 60001)[:, None]
        density = (-memory.negative_log_likelihood(hidden.expand(60001, 4), before.expand(60001, 1), codes)).exp() / (
            2.0 * torch.pi
        ) ** 0.5
        assert float(density.sum() * 0.002) == pytest.approx(1.0, abs=1e-3)
        mean = float((density * codes[:, 0]).sum() * 0.002)
        assert float(memory.expected_codes(hidden, before)) == pytest.approx(mean, abs=1e-2)


class CutOffError(Exception):
    """The training was cut off."""


def test_fit_that_was_cut_off_ends_as_if_it_had_not_been(tmp_path):
    ends = []
    for name in ("whole", "cut"):
        scores = iter([{}, CutOffError(), {}, {}, {}] if name == "cut" else [{}] * 4)

        def score(scores=scores):
            following = next(scores)
            if isinstance(following, Exception):
                raise following
            return following

        for _ in range(2):
            torch.manual_seed(3)
            network = torch.nn.Linear(3, 1)

            def losses(random, network=network):
                for _ in range(5):
                    yield network(torch.randn(8, 3, generator=random)).square().mean()

            try:
                curve = fitted(network, losses, tmp_path / name, score=score)
                break
            except CutOffError:
                continue
        assert [row["epoch"] for row in curve] == [1, 2, 3, 4]
        ends.append(network.weight.detach().clone())
    assert (ends[0] == ends[1]).all()


def test_fit_whose_loss_is_no_number_is_one_line_and_keeps_the_epochs_before(tmp_path):
    network = torch.nn.Linear(1, 1)
    factors = iter([1.0, 1.0, float("inf"), 1.0])

    def batches(random):
        yield (network(torch.rand(8, 1, generator=random)) * next(factors)).square().mean()

    with pytest.raises(
        ConfigurationError,
        match=r"the learning rate of vision is 0\.003, and in epoch 3 it is no number .* allowed: a smaller one",
    ):
        fitted(network, batches, tmp_path / "vision")
    kept = json.loads((tmp_path / "vision" / "curve.json").read_text())
    assert [row["epoch"] for row in kept] == [1, 2]
    again = torch.nn.Linear(1, 1)
    curve = fitted(
        again, lambda random: iter([again(torch.rand(8, 1, generator=random)).square().mean()]), tmp_path / "vision"
    )
    assert curve[:2] == kept
    assert all(torch.isfinite(weights).all() for weights in again.parameters())


def test_checkpoint_that_is_none_is_refused(tmp_path):
    (tmp_path / "checkpoint.pt").write_bytes(b"no checkpoint")
    with pytest.raises(ConfigurationError, match=r"checkpoint\.pt"):
        fitted(torch.nn.Linear(1, 1), lambda random: iter(()), tmp_path)


def test_checkpoint_of_a_gpu_goes_on_without_one(tmp_path):
    network = torch.nn.Linear(2, 1)

    def losses(random):
        yield network(torch.ones(1, 2)).square().mean()

    fitted(network, losses, tmp_path, epochs=1)
    path, there = tmp_path / "checkpoint.pt", io.BytesIO()
    with zipfile.ZipFile(path) as before, zipfile.ZipFile(there, "w") as after:
        for item in before.namelist():  # the pickle says of each tensor where it lay
            after.writestr(item, before.read(item).replace(b"X\x03\0\0\0cpu", b"X\x06\0\0\0cuda:0"))
    assert b"cuda:0" in there.getvalue()
    path.write_bytes(there.getvalue())
    assert [row["epoch"] for row in fitted(network, losses, tmp_path, epochs=2)] == [1, 2]


def test_network_is_there_only_with_its_card(tmp_path, monkeypatch):
    def cut_off(*_):
        raise CutOffError

    monkeypatch.setattr("arena_navrep.world_model.write_text_whole", cut_off)
    with pytest.raises(CutOffError):
        write_part(tmp_path / "vision.onnx", b"network", PartCard("vision", "jackal", {}, (), 1, 1, 1, 0, "", ""))
    assert not (tmp_path / "vision.onnx").exists()


def test_rollouts_are_read_as_they_were_written(tmp_path):
    random = np.random.default_rng(0)
    written = [
        Rollouts(
            random.random((5, 2, 4), np.float32), random.random((5, 2, 3), np.float32), random.random((5, 2)) < 0.3
        )
        for _ in "ab"
    ]
    for index, one in enumerate(written):
        write_rollouts(tmp_path / "rollouts" / f"test_{index:02}.npz", one)
    read = read_rollouts(tmp_path, "test", 2)
    assert read.scans == pytest.approx(np.concatenate([one.scans for one in written], axis=1), abs=1e-3)
    assert (read.begins == np.concatenate([one.begins for one in written], axis=1)).all()
    (tmp_path / "rollouts" / "test_01.npz").write_bytes(b"PK")
    with pytest.raises(Exception, match=r"test_01\.npz: damaged"):
        read_rollouts(tmp_path, "test", 2)


@pytest.mark.parametrize("robot", ["turtlebot3", "jackal", "robotino"])
def test_world_model_depends_on_where_its_controller_drives_and_not_on_how_it_learns(robot):
    controller = compose_environment([f"robot={robot}", "recipe=navrep"], primary="train")
    world_model = compose_environment([f"robot={robot}"], primary="world_model")
    assert not {"training", "total_steps", "planner"} & world_model.keys()
    assert world_model["reward"] == compose_environment(primary="environment")["reward"], "none is learned from"
    assert all(
        world_model[name] == controller[name] for name in ("action", "world", "environment", "guide", "randomization")
    )
    assert {**world_model["task"], "trip": None} == {**controller["task"], "trip": None}, (
        "short ways are how a TurtleBot3 learns"
    )


@pytest.mark.slow
def test_world_model_and_controller_are_trained_and_drive(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["navrep", "all", *TINY]) == 0
    folder = tmp_path / "trainings" / "world_model_jackal"
    curve = json.loads((folder / "vision" / "curve.json").read_text())
    assert curve[-1]["error"] < curve[0]["error"]
    assert curve[-1]["error"] < 0.85 * curve[-1]["spread"]

    assert (
        "convolutions of 32, 64, 64 channels over 30 sectors"
        in json.loads((folder / "vision.json").read_text())["training"]["shrunk"]
    )
    assert "recurrent units of 16 in place" in json.loads((folder / "memory.json").read_text())["training"]["shrunk"]

    lost = folder / "rollouts" / "train_01.npz"
    before = lost.read_bytes()
    lost.unlink()
    assert main(["navrep", "record", *TINY, "resume=true"]) == 0
    assert lost.read_bytes() == before
    assert main(["navrep", "memory", *TINY]) == 2
    assert main(["navrep", "memory", *TINY, "memory.hidden=8", "resume=true"]) == 2
    assert "another memory" in capsys.readouterr().err
    assert main(["navrep", "evidence", f"out={folder}"]) == 0
    assert "if nothing changed" in capsys.readouterr().out

    small = [
        *(word for word in TINY if not word.startswith(("recording", "vision", "memory", "observation"))),
        "total_steps=2048",
    ]
    quick = [
        "teacher.rounds=2",
        "teacher.decisions=8",
        "training.optimization.environments=8",
        "training.optimization.steps=128",
        "training.optimization.minibatch=512",
        "training.validation.every=100000",
        "training.validation.episodes=4",
        "training.test.episodes=4",
    ]
    assert main(["train", "planner=navrep", *small, *quick]) == 0
    policy = tmp_path / "trainings" / "navrep_jackal_0" / "policy.onnx"
    assert {p.name for p in policy.parent.glob("*.onnx")} == {"policy.onnx", "policy.vision.onnx", "policy.memory.onnx"}
    assert sum(path.stat().st_size for path in policy.parent.glob("*.onnx")) < 2e6
    assert main(["navrep", "evidence", f"policy={policy}", "episodes=4"]) == 0
    assert "memory gains" in capsys.readouterr().out
    monkeypatch.delenv("ARENA_DISABLED_PLUGINS", raising=False)
    assert testing.planner("navrep", testing.component("robot", "jackal"), f"planner.policy={policy}")
    words = [
        "planner=navrep",
        f"planner.policy={policy}",
        "robot=jackal",
        "world=empty",
        "episodes=1",
        "task.time_limit=5.0",
    ]
    assert main(["run", *words, "executor=serial", "report=false", f"hydra.run.dir={tmp_path / 'run'}"]) == 0
