"""What a training says beforehand and while it runs, and what is left of one that is interrupted."""

from __future__ import annotations

import json
import signal
from dataclasses import replace

import numpy as np
import pytest

from arena_core.cli.main import main

torch = pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")

WORDS = ("train", "planner=tiny", "robot=jackal", "out=mine")
TAUGHT = (
    "teacher.planner=pure_pursuit",
    "teacher.rounds=2",
    "teacher.decisions=8",
    "teacher.minibatch=8",
    "teacher.epochs=1",
)


@pytest.fixture
def here(write_recipe):
    """Work in a folder with a recipe that takes no time, and hear Ctrl-C as in a terminal."""
    trip = {"min_distance": 1.5, "max_distance": 4.0}
    folder = write_recipe("tiny", total_steps=1000, task={"pedestrians": 0, "trip": trip, "time_limit": 15.0})
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield folder
    signal.signal(signal.SIGINT, before)


def settings_of(*overrides):
    from arena_gym.building import compose_environment
    from arena_gym.training.session import training_settings

    return training_settings(compose_environment(["recipe=tiny", "robot=jackal", *overrides], primary="train"))


def interrupt_at(monkeypatch, owner, name, call):
    """Have Ctrl-C pressed as something is called for the ``call``-th time."""
    usual, calls = getattr(owner, name), []

    def interrupted(*given, **named):
        calls.append(None)
        if len(calls) == call:
            signal.raise_signal(signal.SIGINT)
        return usual(*given, **named)

    monkeypatch.setattr(owner, name, interrupted)


def training_of(folder):
    return json.loads((folder / "policy.json").read_text())["training"]


def test_true_steps_validations_and_test_are_said_beforehand(here):
    from arena_gym.training.plan import describe_plan

    assert list(describe_plan(settings_of(), 0, taught=False)) == [
        "training: 1000 steps, in rollouts of 256 (4 worlds, 64 steps)",
        "validations: 4 episodes every 600 steps and at the end",
        "test: 4 episodes at the end (test=false: none)",
    ]
    lessons, training, _, test = describe_plan(
        settings_of(*TAUGHT, "total_steps=512", "training.test.episodes=0"), 0, taught=False
    )
    assert lessons == "lessons: 2 of 8 decisions in each of 4 worlds, of pure_pursuit"
    assert training == "training: 512 steps, in rollouts of 256 (4 worlds, 64 steps)"
    assert test == "test: none"
    uneven = next(iter(describe_plan(settings_of("total_steps=1001"), 0, taught=False)))
    assert uneven.startswith("training: 1004 steps, ")
    assert uneven.endswith("; total_steps=1001 is no multiple of the worlds")


@pytest.mark.parametrize(
    ("wanted", "done", "driven"), [(1000, 0, 1000), (1024, 0, 1024), (1025, 1024, 1028), (500, 1024, 1024), (0, 0, 0)]
)
def test_what_is_said_is_what_is_driven(here, wanted, done, driven):
    from arena_gym.training.plan import describe_plan, final_steps

    settings = replace(settings_of(*TAUGHT), total_steps=wanted)
    assert final_steps(settings, done) == driven
    already = f"{done} of them driven already, " if done else ""
    assert f"training: {driven} steps, {already}in rollouts" in next(iter(describe_plan(settings, done, taught=True)))


@pytest.mark.slow
def test_training_without_a_test_drives_the_steps_that_it_said(here, capsys):
    assert main([*WORDS, "test=false"]) == 0
    said = capsys.readouterr().out
    first, reward, training, *_ = said.splitlines()
    assert first == "tiny for jackal, to mine: building its worlds"
    assert reward.startswith("reward: a straight way of 16 m at full speed takes 8.0 s and pays 5.88 ")
    assert training.startswith("training: 1000 steps, ")
    assert "test: none; weights after" in said
    assert not (here / "mine" / "test.json").exists()
    assert (training_of(here / "mine")["steps"], training_of(here / "mine")["score"]) == (1000, None)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("decisions", "said", "lessons"),
    [
        (3, "nothing was learned as yet; resume=true (with the same words) begins again in mine", 0),
        (
            11,
            "mine/taught.pt is kept, after 1 lesson, and mine/policy.onnx, untested; "
            "resume=true (with the same words) goes on",
            1,
        ),
    ],
)
def test_interrupted_lessons_leave_what_is_said(here, capsys, monkeypatch, decisions, said, lessons):
    from arena_gym.driver import Driver

    interrupt_at(monkeypatch, Driver, "drive", 4 * decisions)  # 4 worlds
    assert main([*WORDS, *TAUGHT]) == 130
    assert capsys.readouterr().err.splitlines()[-1].startswith(f"arena: interrupted; {said}")
    assert (here / "mine" / "taught.pt").exists() == (here / "mine" / "policy.onnx").exists() == (lessons > 0)


@pytest.mark.slow
def test_interrupted_training_leaves_the_best_policy_and_goes_on_to_the_same_weights(here, capsys, monkeypatch):
    from arena_gym.training import trainer

    with monkeypatch.context() as patch:
        steps = []
        noted = trainer.TrainingReport.note

        def note(report, *of):
            steps.append(of[0])
            if steps[-1] == 900:
                signal.raise_signal(signal.SIGINT)
            noted(report, *of)

        patch.setattr(trainer.TrainingReport, "note", note)
        assert main(list(WORDS)) == 130
    last = capsys.readouterr().err.splitlines()[-1]
    kept = "mine/checkpoint.pt is kept, after 768 steps, and mine/policy.onnx, untested"
    assert last == f"arena: interrupted; {kept}; resume=true (with the same words) goes on from there"
    told = training_of(here / "mine")
    assert (told["weights"], told["steps"], told["score"], told["choice"]["steps"]) == ("best", 768, None, 768)
    assert steps[-1] == 900, "nothing was driven after it"
    assert main([*WORDS, "resume=true"]) == 0
    assert "training: 1000 steps, 768 of them driven already" in capsys.readouterr().out
    assert main([*WORDS[:-1], "out=whole"]) == 0
    ends = [torch.load(here / name / "checkpoint.pt", weights_only=True)["policy"] for name in ("mine", "whole")]
    assert all(torch.equal(weights, ends[1][part]) for part, weights in ends[0].items())
    assert (here / "mine" / "policy.onnx").read_bytes() == (here / "whole" / "policy.onnx").read_bytes()


@pytest.mark.slow
def test_policy_that_was_tested_is_spared_by_an_interrupted_training_that_went_on(here, capsys, monkeypatch):
    from arena_gym.training import trainer

    assert main([*WORDS, "total_steps=512"]) == 0
    before = (here / "mine" / "policy.onnx").read_bytes()
    interrupt_at(monkeypatch, trainer.TrainingReport, "note", 10)
    assert main([*WORDS, "total_steps=4096", "resume=true"]) == 130
    assert "mine/policy.onnx as it was; resume=true" in capsys.readouterr().err
    assert (here / "mine" / "policy.onnx").read_bytes() == before
    assert training_of(here / "mine")["score"] is not None


@pytest.fixture
def clock(monkeypatch):
    from arena_gym.training import report

    times = [100.0]
    monkeypatch.setattr(report, "monotonic", lambda: times[-1])
    return times


def test_time_left_is_none_that_has_passed_and_compiling_does_not_count(clock):
    from arena_gym.training.report import NOT_KNOWN, RecentEpisodes, TimesColumn, TrainingReport

    report = TrainingReport(10_000)
    report.begin(0, 10_000, 100_000)
    (task, _) = report.tasks
    assert str(TimesColumn().render(task)) == f"0:00:00 so far, {NOT_KNOWN}"
    for seconds, steps in ((75.0, 1000), (10.0, 2000), (10.0, 3000)):  # kernels are compiled in the first
        report.begin_rollout()
        assert report.time_left() == NOT_KNOWN
        clock.append(clock[-1] + seconds)
        report.end_rollout(steps)
    report.begin_rollout()
    clock.append(clock[-1] + 5.0)
    report.note(3500, RecentEpisodes(), "")
    assert report.time_left() == "0:01:05 left but for validations"
    report.end_validation(40.0)
    assert report.time_left() == "0:01:45 left"  # another one is due at the end


def test_bar_goes_on_from_where_a_checkpoint_was(clock):
    from arena_gym.training.report import RecentEpisodes, TrainingReport

    report = TrainingReport(10_000)
    report.start_side_task("episodes that ran are driven again", 1)
    assert [task.visible for task in report.tasks] == [False, True]
    report.update_side_task(1)
    report.begin(4000, 9000, 100_000)
    assert [(task.completed, task.total, task.visible) for task in report.tasks] == [(4000, 9000, True), (1, 1, False)]
    report.note(4500, RecentEpisodes(), ", level 2")
    assert (report.tasks[0].completed, report.tasks[0].description) == (4500, "training, level 2")
    for steps in (5000, 6000, 7000):
        report.begin_rollout()
        clock.append(clock[-1] + 10.0)
        report.end_rollout(steps)
    assert report.time_left() == "0:00:20 left but for validations"


def test_test_shows_how_many_episodes_are_over_and_what_is_left(clock):
    from arena_gym.training.report import NOT_KNOWN, TrainingReport

    report = TrainingReport(10_000)
    heard = report.start_evaluation("test, episodes", 100)
    heard.begin(np.full(10, 10))
    task = report.tasks[1]
    for step in range(1, 501):
        clock.append(clock[-1] + 0.1)
        heard.step(np.full(10, step % 100 == 0))
        if step in (99, 200):
            assert task.fields["left"]() == (NOT_KNOWN if step == 99 else "0:01:20 left")
    assert (task.description, task.completed, task.visible) == ("test, episodes", 50, True)
    assert task.fields["left"]() == "0:00:50 left"


def test_lessons_show_what_is_left_of_all_of_them(clock):
    from arena_gym.training.report import NOT_KNOWN, TrainingReport
    from arena_gym.training.time_left import ImitationPace

    report, pace = TrainingReport(0), ImitationPace(4, 10)
    report.start_lesson(1, 4, pace, 10)
    for decisions in range(1, 11):
        pace.drove(60.0 if decisions == 1 else 1.0)
        report.update_side_task(decisions)
    assert report.tasks[1].fields["left"]() == NOT_KNOWN  # learning takes who knows how long
    pace.learned(5.0, 1)
    report.start_lesson(2, 4, pace, 10)
    assert report.tasks[1].fields["left"]() == "0:01:15 left of all lessons"
