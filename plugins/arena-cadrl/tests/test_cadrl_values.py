"""Value networks and returns: who counts, in which order, and what a state turned out to be worth."""

import numpy as np
import pytest
import torch

from arena_cadrl.parameters import OWN, PERSON
from arena_cadrl.training.networks import make_network
from arena_cadrl.training.returns import lambda_returns
from arena_cadrl.training.rollouts import Explorer
from arena_cadrl.training.settings import ValueSettings

KINDS = {
    "pairs": ValueSettings("pairs", (16, 16), (), (), (), ""),
    "attention": ValueSettings("attention", (16, 8), (8, 8), (8,), (16,), ""),
}
PEOPLE = 4


@pytest.fixture(params=KINDS)
def network(request):
    torch.manual_seed(0)
    return make_network(KINDS[request.param])


def rows(random, there):
    """Return rows (20, D) of a robot and four people, the first ``there`` of whom are there."""
    people = random.uniform(-1.0, 1.0, (20, PEOPLE, PERSON))
    people[:, :, -1] = 1.0
    people[:, there:] = 0.0
    return torch.tensor(
        np.concatenate((random.uniform(-1.0, 1.0, (20, OWN)), people.reshape(20, -1)), axis=1), dtype=torch.float32
    )


def test_order_of_people_does_not_matter(network, random):
    seen = rows(random, PEOPLE)
    people = seen[:, OWN:].reshape(20, PEOPLE, PERSON).flip(1).reshape(20, -1)
    assert torch.allclose(network(seen), network(torch.cat((seen[:, :OWN], people), dim=1)), atol=1e-5)


def test_more_places_for_people_who_are_not_there_change_nothing(network, random):
    seen = rows(random, 2)
    assert torch.allclose(network(seen), network(torch.cat((seen, torch.zeros(20, PERSON)), dim=1)), atol=1e-5)


def test_everyone_who_is_there_can_matter(network, random):
    seen = rows(random, PEOPLE)
    seen.requires_grad_(True)
    network(seen).sum().backward()
    people = seen.grad[:, OWN:].reshape(20, PEOPLE, PERSON)
    assert (people.abs().sum(dim=(0, 2)) > 0.0).all()


def test_pairs_count_by_the_least_of_their_values(random):
    network = make_network(KINDS["pairs"])
    seen = rows(random, PEOPLE)
    alone = [
        network(torch.cat((seen[:, :OWN], seen[:, OWN + k * PERSON : OWN + (k + 1) * PERSON]), dim=1))
        for k in range(PEOPLE)
    ]
    assert torch.allclose(network(seen), torch.stack(alone).amin(dim=0))


def test_attention_without_anyone_is_the_robot_alone(random):
    network = make_network(KINDS["attention"])
    seen = rows(random, 0)
    assert torch.allclose(network(seen), network.head(torch.cat((seen[:, :OWN], torch.zeros(20, 8)), dim=1)))


def flags(steps, worlds=1):
    return np.zeros((steps, worlds), np.bool_)


def test_returns_with_a_full_trace_are_discounted_sums():
    rewards = np.array([[1.0], [2.0], [4.0]])
    found = lambda_returns(rewards, np.zeros((3, 1)), np.array([8.0]), flags(3), flags(3), flags(3), 0.5, 1.0)
    assert found[:, 0].tolist() == [1.0 + 1.0 + 1.0 + 1.0, 2.0 + 2.0 + 2.0, 4.0 + 4.0]


def test_returns_without_a_trace_look_one_step_ahead():
    values = np.array([[3.0], [5.0], [7.0]])
    found = lambda_returns(np.ones((3, 1)), values, np.array([9.0]), flags(3), flags(3), flags(3), 0.5, 0.0)
    assert found[:, 0].tolist() == [3.5, 4.5, 5.5]


def test_an_episode_that_ended_is_worth_nothing_from_there_on():
    ended = flags(3)
    ended[1] = True
    found = lambda_returns(np.ones((3, 1)), np.zeros((3, 1)), np.array([100.0]), ended, flags(3), flags(3), 0.5, 1.0)
    assert found[:, 0].tolist() == [1.5, 1.0, 51.0]


def test_returns_stop_at_a_step_of_chance_and_go_on_from_its_value():
    chance, values = flags(3), np.array([[0.0], [10.0], [0.0]])
    chance[1] = True
    found = lambda_returns(np.array([[1.0], [-99.0], [0.0]]), values, np.zeros(1), flags(3), flags(3), chance, 0.5, 1.0)
    assert found[0, 0] == 1.0 + 0.5 * 10.0


def test_an_episode_cut_for_time_keeps_what_it_was_worth():
    cut, values = flags(2), np.array([[0.0], [6.0]])
    cut[1] = True
    found = lambda_returns(np.ones((2, 1)), values, np.array([100.0]), flags(2), cut, flags(2), 0.5, 1.0)
    assert found[:, 0].tolist() == [4.0, 6.0]


@pytest.mark.parametrize("share", [0.0, 0.2, 1.0])
def test_chance_has_its_share_of_the_time_and_only_what_is_allowed(share):
    explorer, allowed = Explorer(50, 3, np.random.default_rng(0)), np.zeros((50, 6), np.bool_)
    allowed[:, 2:4] = True
    drawn = np.array([explorer.draw_actions(share, allowed) for _ in range(400)])
    assert set(np.unique(drawn)) <= {-1, 2, 3}
    assert abs((drawn >= 0).mean() - share) < 0.02
