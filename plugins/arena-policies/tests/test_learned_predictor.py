"""The learned predictor: what a network's answers mean, which files it takes, what it refuses."""

from __future__ import annotations

import dataclasses
import json
import subprocess
import sys
from copy import deepcopy

import numpy as np
import pytest
from onnx import TensorProto, helper, numpy_helper

from arena_core import InputFileError, Tracks, testing
from arena_policies.card import content_sha256
from arena_prediction.card import PredictorCard, read_card, write_card
from arena_prediction.features import LAYOUT, SIZE
from arena_prediction.hypotheses import SCALE_TIME, AnswerReader, answer_size
from arena_prediction.predictor import LearnedPredictor
from arena_prediction.trust import Trust, TrustRules

TIMES = (0.5, 1.0, 2.0)
HYPOTHESES = 3
ANSWERS = answer_size(HYPOTHESES, len(TIMES))
RULES = TrustRules(lag=1.0, memory=20.0, prior=0.2)


def network_bytes(answers, inputs=SIZE):
    """Return an ONNX file that answers with the same numbers for every track, whatever it is told."""
    nothing = numpy_helper.from_array(np.zeros((inputs, len(answers)), np.float32), "nothing")
    same = numpy_helper.from_array(np.array(answers, np.float32), "same")
    graph = helper.make_graph(
        [
            helper.make_node("MatMul", ["tracks", "nothing"], ["silence"]),
            helper.make_node("Add", ["silence", "same"], ["answers"]),
        ],
        "constant",
        [helper.make_tensor_value_info("tracks", TensorProto.FLOAT, ["worlds", inputs])],
        [helper.make_tensor_value_info("answers", TensorProto.FLOAT, ["worlds", len(answers)])],
        [nothing, same],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 18)], ir_version=9)
    return bytes(model.SerializeToString())


@pytest.fixture
def make(tmp_path):
    """Return a function that writes a network with its card and returns its path; changes are of the card."""

    def write(answers=None, inputs=SIZE, **changes):
        content = network_bytes(np.zeros(ANSWERS) if answers is None else answers, inputs)
        card = PredictorCard(LAYOUT, HYPOTHESES, TIMES, (1.0,) * len(TIMES), content_sha256(content), "MIT")
        path = tmp_path / "mine.onnx"
        path.write_bytes(content)
        write_card(path.with_suffix(".json"), dataclasses.replace(card, **changes))
        return path

    return write


def read(answers, turn=0.0, scale=1.0, widths=(1.0, 1.0, 1.0, 1.0), trust=1.0):
    """Return what answers mean for a track at (1, 2) that heads by ``turn``."""
    reader = AnswerReader(np.array((0.0, *TIMES)), HYPOTHESES, np.array(widths))
    velocities = scale * np.array(((np.cos(turn), np.sin(turn)),))
    covariances = np.diag((0.01, 0.01, 0.04, 0.04))[None]
    tracks = Tracks(np.zeros(1, np.int32), np.array(((1.0, 2.0),)), velocities, np.array((0.3,)), covariances)
    frames = np.array(((np.cos(turn), np.sin(turn), scale, 1.0),))
    return reader.predictions(tracks, frames, np.array(answers, np.float32)[None], trust)


def answers_of(logits=(0.0, 0.0, 0.0), ways=None, unsure=-2.0):
    ways = np.zeros((HYPOTHESES, len(TIMES), 2)) if ways is None else ways
    return np.concatenate((logits, np.ravel(ways), np.full(2 * HYPOTHESES * len(TIMES), unsure)))


def test_answers_of_nothing_are_a_constant_velocity():
    said = read(answers_of(), turn=0.6, scale=0.8)
    velocity = 0.8 * np.array((np.cos(0.6), np.sin(0.6)))
    np.testing.assert_allclose(said.at(TIMES)[0], np.array((1.0, 2.0)) + np.outer(TIMES, velocity))


def test_weights_are_those_of_the_logits_and_add_up_to_one():
    said = read(answers_of(logits=(1.0, 3.0, -2.0)))
    expected = np.exp((1.0, 3.0, -2.0)) / np.exp((1.0, 3.0, -2.0)).sum()
    np.testing.assert_allclose(said.weights[:, 0], expected)
    assert said.weights.sum() == pytest.approx(1.0)


def test_the_means_are_those_of_the_most_probable_hypothesis():
    ways = np.zeros((HYPOTHESES, len(TIMES), 2))
    ways[1, :, 1] = 0.1
    said = read(answers_of(logits=(0.0, 2.0, 1.0), ways=ways))
    np.testing.assert_array_equal(said.means, said.alternatives[1])
    assert (said.means[0, 1:, 1] > 2.0).all()


@pytest.mark.parametrize("turn", [0.0, np.pi / 2, -2.0])
def test_answers_count_in_the_frame_and_on_the_scale_of_the_track(turn):
    ways = np.zeros((HYPOTHESES, len(TIMES), 2))
    ways[0, 2] = (0.1, 0.3)
    said = read(answers_of(logits=(5.0, 0.0, 0.0), ways=ways), turn, scale=0.4)
    reach, c, s = 0.4 * (2.0 + SCALE_TIME), np.cos(turn), np.sin(turn)
    off = (0.8 + 0.1 * reach, 0.3 * reach)
    np.testing.assert_allclose(
        said.means[0, 3], (1.0 + c * off[0] - s * off[1], 2.0 + s * off[0] + c * off[1]), rtol=1e-6
    )


def test_the_covariance_is_the_mean_square_error_of_the_means_over_all_hypotheses():
    rng = np.random.default_rng(5)
    logits, ways = rng.normal(size=HYPOTHESES), 0.3 * rng.normal(size=(HYPOTHESES, len(TIMES), 2))
    said = read(answers_of(logits, ways, unsure=-1.0), turn=0.8, widths=(1.0, 1.5, 1.5, 1.5))
    deviation = np.exp(-1.0) * (2.0 + SCALE_TIME)
    off = said.alternatives[:, 0, 3] - said.means[0, 3]
    expected = deviation**2 * np.eye(2) + np.einsum("m,mi,mj->ij", said.weights[:, 0], off, off)
    np.testing.assert_allclose(said.covariances[0, 3], 1.5**2 * expected, rtol=1e-5)


def test_a_track_is_now_as_sure_as_its_tracker_says():
    np.testing.assert_allclose(read(answers_of()).covariances[0, 0], 0.01 * np.eye(2))


def test_doubt_goes_on_growing_after_the_last_time():
    said = read(answers_of(), turn=0.4)
    assert (np.linalg.eigvalsh(said.spreads) > -1e-9).all()
    growing = said.deviations((1.0, 2.0, 3.0, 4.0))[0]
    assert (np.diff(growing) > 0.0).all()
    slopes = np.diff(said.deviations((2.0, 3.0, 4.0))[0])
    assert slopes[0] == pytest.approx(slopes[1])


def test_after_the_last_time_each_keeps_the_velocity_of_the_last_leg():
    ways = np.zeros((HYPOTHESES, len(TIMES), 2))
    ways[:, 2, 1] = 0.2
    said = read(answers_of(ways=ways))
    later = said.at((1.0, 2.0, 3.0))[0]
    np.testing.assert_allclose(later[2] - later[1], later[1] - later[0])


def test_half_the_trust_is_half_the_way_off_the_straight_line():
    ways = np.zeros((HYPOTHESES, len(TIMES), 2))
    ways[1, :, 1] = 0.4
    ways[2, :, 1] = -0.4
    answers = answers_of(logits=(0.0, 2.0, 1.0), ways=ways)
    whole, half, none = (read(answers, trust=share) for share in (1.0, 0.5, 0.0))
    np.testing.assert_allclose(half.means, 0.5 * (whole.means + none.means))
    np.testing.assert_allclose(none.at(TIMES), read(answers_of()).at(TIMES))
    np.testing.assert_array_equal(half.alternatives[2], whole.alternatives[2])
    np.testing.assert_array_equal(half.means, half.alternatives[1])


def trust_after(done, steps=60):
    """Return how far a network is trusted that expects all to drift to the left by 0.3 m in 1 s, where they drift by a
    share ``done`` of that.
    """
    trust = Trust(RULES, np.array((0.0, *TIMES)), HYPOTHESES)
    ways = np.zeros((HYPOTHESES, len(TIMES), 2))
    ways[:, 1, 1] = 0.3 / (1.0 + SCALE_TIME)
    answers, frames = np.array(answers_of(ways=ways), np.float32)[None], np.array(((1.0, 0.0, 1.0, 1.0),))
    for k in range(steps):
        places = np.array(((0.1 * k, 0.3 * done * 0.1 * k),))
        going = np.array(((1.0, 0.0),))
        tracks = Tracks(np.array((7,), np.int32), places, going, np.array((0.3,)), np.zeros((1, 4, 4)))
        share = trust.judge(tracks, 0.1 * k)
        trust.expect(tracks, 0.1 * k, frames, answers)
    return share, trust


@pytest.mark.parametrize(("done", "expected"), [(1.0, 1.0), (2.0, 1.0), (0.5, 0.5), (0.0, 0.0), (-1.0, 0.0)])
def test_trust_is_the_share_that_people_do_of_what_was_expected(done, expected):
    assert trust_after(done)[0] == pytest.approx(expected, abs=0.05)


def test_nothing_is_judged_before_its_time_has_come():
    assert trust_after(0.0, steps=10)[0] == 1.0


def test_a_new_episode_begins_with_full_trust():
    _, trust = trust_after(0.0)
    trust.reset()
    assert trust.judge(testing.people(0.0), 0.0) == 1.0


def test_who_is_no_longer_tracked_is_not_judged():
    share, trust = trust_after(1.0)
    assert trust.judge(testing.people(0.0), 6.0 + RULES.lag) == pytest.approx(share)


def test_it_keeps_the_contract_of_predictors(make):
    rng = np.random.default_rng(1)
    ways = 0.1 * rng.normal(size=(HYPOTHESES, len(TIMES), 2))
    path = make(answers_of(rng.normal(size=3), ways))
    testing.check("predictor", LearnedPredictor(str(path), RULES), testing.robot())


def test_tracks_that_are_no_numbers_spoil_no_other_one(make):
    predictor = LearnedPredictor(str(make(answers_of((1.0, 0.0, 0.0)))), RULES)
    people = testing.people(0.0)
    view = testing.observation(body=testing.robot(), tracks=people)
    predictor.reset(None)
    expected = predictor.predict(view).at(TIMES)
    spoilt = deepcopy(people)
    positions = spoilt.positions.copy()
    positions[0] = np.nan
    strange = testing.observation(body=testing.robot(), tracks=dataclasses.replace(spoilt, positions=positions))
    predictor.reset(None)
    said = predictor.predict(strange)
    np.testing.assert_allclose(said.at(TIMES)[1:], expected[1:])
    assert np.isfinite(said.alternatives[:, 1:]).all()


def test_onnxruntime_opens_nothing_before_a_predictor_is_built():
    code = "import sys, arena_prediction, arena_prediction.predictor; print('onnxruntime' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_a_card_is_read_as_it_was_written(make):
    path = make(training={"seed": 3}).with_suffix(".json")
    card = read_card(path)
    assert (card.times, card.hypotheses, card.layout, card.license) == (TIMES, HYPOTHESES, LAYOUT, "MIT")
    assert card.training == {"seed": 3}


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"layout": "arena-prediction-features-0"}, "layout is 'arena-prediction-features-0'; allowed: "),
        ({"hypotheses": 0}, "hypotheses is 0; allowed: 1 to "),
        ({"hypotheses": 2}, f"reads {[SIZE]} and writes {[ANSWERS]} numbers; allowed: "),
        ({"times": (0.5, 0.4, 2.0)}, "times is [0.5, 0.4, 2.0]; allowed: "),
        ({"times": (0.0, 0.4, 2.0)}, "times is [0.0, 0.4, 2.0]; allowed: "),
        ({"times": ()}, "times is []; allowed: "),
        ({"widths": (1.0,)}, "widths is [1.0]; allowed: 3 numbers above 0"),
        ({"widths": (1.0, -1.0, 1.0)}, "widths is [1.0, -1.0, 1.0]; allowed: "),
        ({"sha256": "0" * 64}, "its card says 000000000000…; allowed: the file the card was made for"),
    ],
)
def test_a_card_that_does_not_fit_is_refused_in_one_line(make, changes, said):
    path = make(**changes)
    with pytest.raises(InputFileError) as error:
        LearnedPredictor(str(path), RULES)
    assert said in str(error.value)
    assert str(path.parent) in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "allowed: "),
        ("[]", "format is None; allowed: 'arena-predictor' version 1"),
        ('{"format": "arena-policy", "version": 1}', "format is 'arena-policy'; allowed: 'arena-predictor' version 1"),
        ('{"format": "arena-predictor", "version": 1}', "layout is missing; allowed: "),
    ],
)
def test_another_file_in_place_of_the_card_is_refused(make, text, said):
    path = make()
    path.with_suffix(".json").write_text(text)
    with pytest.raises(InputFileError) as error:
        LearnedPredictor(str(path), RULES)
    assert said in str(error.value)
    assert "mine.json" in str(error.value)


@pytest.mark.parametrize("value", ["three", 2.5, True, None])
def test_a_card_whose_hypotheses_are_no_whole_number_is_refused(make, value):
    path = make().with_suffix(".json")
    path.write_text(json.dumps({**json.loads(path.read_text()), "hypotheses": value}))
    with pytest.raises(InputFileError, match=r"mine\.json: is no predictor's card \(hypotheses is .*no whole number"):
        read_card(path)


@pytest.mark.parametrize("missing", ["mine.onnx", "mine.json"])
def test_a_file_that_is_missing_is_named(make, missing):
    path = make()
    path.with_name(missing).unlink()
    with pytest.raises(InputFileError, match=missing):
        LearnedPredictor(str(path), RULES)


def test_a_network_of_other_numbers_is_refused(make):
    with pytest.raises(InputFileError, match=rf"reads \[7\].*allowed: \[{SIZE}\]"):
        LearnedPredictor(str(make(inputs=7)), RULES)


def test_a_file_that_is_no_network_is_refused(make):
    path = make()
    path.write_bytes(b"nothing")
    card = dataclasses.replace(read_card(path.with_suffix(".json")), sha256=content_sha256(b"nothing"))
    write_card(path.with_suffix(".json"), card)
    with pytest.raises(InputFileError, match="no ONNX model that runs"):
        LearnedPredictor(str(path), RULES)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_network_that_answers_with_no_number_is_named(make, value):
    answers = answers_of()
    answers[4] = value
    predictor = LearnedPredictor(str(make(answers)), RULES)
    predictor.reset(None)
    view = testing.observation(body=testing.robot(), tracks=testing.people(0.0))
    with pytest.raises(InputFileError, match=r"mine\.onnx: answers with values that are not finite; allowed: "):
        predictor.predict(view)
