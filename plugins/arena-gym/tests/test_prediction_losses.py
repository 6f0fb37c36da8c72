"""What the learned predictor is fitted by: figures by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from arena_gym.prediction.fitting import epoch_order  # noqa: E402
from arena_gym.prediction.losses import (  # noqa: E402
    negative_log_likelihood,
    total_loss,
    way_errors,
    winner_takes_most,
)
from arena_gym.prediction.network import ForesightNetwork  # noqa: E402
from arena_prediction.features import NEIGHBOUR_SIZE, OWN_SIZE, SIZE  # noqa: E402
from arena_prediction.hypotheses import SCALE_TIME, answer_size  # noqa: E402

TIMES = torch.tensor((0.5, 1.5))


def test_errors_count_by_the_way_that_a_track_covers_meanwhile():
    ways = torch.tensor([[[[0.3, 0.4], [0.0, 1.0]]]])
    errors = way_errors(ways, torch.zeros((1, 2, 2)), TIMES)
    assert errors[0, 0].item() == pytest.approx((0.5 * (0.5 + SCALE_TIME) + 1.0 * (1.5 + SCALE_TIME)) / 2, rel=1e-4)


def test_the_winner_takes_most_and_the_others_share_the_rest():
    loss = winner_takes_most(torch.tensor([[0.2, 1.0, 3.0], [5.0, 0.5, 0.7]]), 0.8)
    assert loss.tolist() == pytest.approx([0.8 * 0.2 + 0.1 * 4.0, 0.8 * 0.5 + 0.1 * 5.7])


def test_a_single_hypothesis_takes_all():
    assert winner_takes_most(torch.tensor([[0.2], [5.0]]), 0.8).tolist() == pytest.approx([0.2, 5.0])


def test_the_likelihood_of_one_hypothesis_is_that_of_a_gaussian():
    answer = torch.zeros((1, 1)), torch.zeros((1, 1, 1, 2)), torch.full((1, 1, 1, 2), math.log(0.5))
    truth = torch.tensor([[[0.3, -0.4]]])
    expected = math.log(2 * math.pi * 0.25) + 0.5 * 0.25 / 0.25
    assert negative_log_likelihood(answer, truth).item() == pytest.approx(expected, rel=1e-5)


def test_hypotheses_that_are_alike_are_as_likely_as_one():
    one = torch.zeros((1, 1)), torch.full((1, 1, 2, 2), 0.1), torch.full((1, 1, 2, 2), -0.5)
    three = torch.tensor([[2.0, 0.0, -1.0]]), one[1].expand(1, 3, 2, 2), one[2].expand(1, 3, 2, 2)
    truth = torch.tensor([[[0.3, -0.4], [0.0, 1.0]]])
    assert negative_log_likelihood(three, truth).item() == pytest.approx(negative_log_likelihood(one, truth).item())


def test_the_likelihood_leaves_the_ways_alone():
    torch.manual_seed(0)
    logits, ways, unsure = torch.randn(4, 3), torch.randn(4, 3, 2, 2, requires_grad=True), torch.randn(4, 3, 2, 2)
    truth = torch.randn(4, 2, 2)
    gradients = []
    for weight in (0.0, 7.0):
        ways.grad = None
        total_loss((logits, ways, unsure), truth, TIMES, 0.9, weight).backward()
        gradients.append(ways.grad.clone())
    assert torch.equal(*gradients)


def test_at_first_a_network_answers_that_all_keep_their_velocity_nearly():
    torch.manual_seed(0)
    network = ForesightNetwork(5, 8, 32, 8)
    answers = network(torch.zeros((2, SIZE)))
    assert answers.shape == (2, answer_size(5, 8))
    _, ways, _ = network.split(answers)
    assert ways.abs().max() < 0.1


def test_it_does_not_matter_in_which_order_neighbours_are_told():
    torch.manual_seed(0)
    network, numbers = ForesightNetwork(3, 4, 32, 8), torch.randn(2, SIZE)
    numbers[:, OWN_SIZE::NEIGHBOUR_SIZE] = 1.0  # all are there
    numbers[:, OWN_SIZE + NEIGHBOUR_SIZE :: NEIGHBOUR_SIZE][:, -1] = 0.0
    others = numbers[:, OWN_SIZE:].reshape(2, -1, NEIGHBOUR_SIZE).flip(1).reshape(2, -1)
    turned = torch.cat((numbers[:, :OWN_SIZE], others), dim=1)
    torch.testing.assert_close(network(turned), network(numbers))


def test_an_epoch_has_all_tracked_samples_and_a_share_of_true_ones():
    true = np.arange(1000) % 4 > 0  # 250 tracked ones
    order = epoch_order(true, 0.5, np.random.default_rng(0))
    assert sorted(order[~true[order]].tolist()) == np.flatnonzero(~true).tolist()
    assert true[order].sum() == 250
    assert len(set(order.tolist())) == len(order)


@pytest.mark.parametrize(("share", "count"), [(0.0, 250), (0.99, 1000), (1.0, 750)])
def test_a_share_that_there_are_too_few_samples_for_takes_all(share, count):
    assert len(epoch_order(np.arange(1000) % 4 > 0, share, np.random.default_rng(0))) == count
