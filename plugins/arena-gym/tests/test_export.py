"""Networks as files: the same answers, nothing of where they were made, large ones in 16 bits."""

from __future__ import annotations

import copy
from types import SimpleNamespace

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")
onnx = pytest.importorskip("onnx", reason="training needs the extra arena-gym[train]")

from arena_gym.training.export import HALVED_BEYOND, Actor, PolicyExport, network_to_onnx, round_weights  # noqa: E402
from arena_gym.training.network import BeamFeatures  # noqa: E402
from arena_gym.training.settings import Convolution  # noqa: E402
from arena_policies.network import open_network  # noqa: E402

SEEN = np.linspace(-1.0, 1.0, 3 * 40, dtype=np.float32).reshape(3, 40)


def _network(hidden: int):
    torch.manual_seed(0)
    return torch.nn.Sequential(torch.nn.Linear(40, hidden), torch.nn.ReLU(), torch.nn.Linear(hidden, 2))


def _answers(network, tmp_path):
    content = network_to_onnx(network, 40, "observation", "action")
    path = tmp_path / "network.onnx"
    path.write_bytes(content)
    with torch.no_grad():
        meant = network(torch.as_tensor(SEEN)).numpy()
    return content, open_network(path, content, 40, 2).run(SEEN), meant


def test_a_file_says_nothing_of_where_it_was_made(tmp_path):
    content, answers, meant = _answers(_network(16), tmp_path)
    np.testing.assert_allclose(answers, meant, atol=1e-6)
    model = onnx.load_from_string(content)
    assert not any(node.metadata_props or node.doc_string for node in model.graph.node)
    assert b".py" not in content


def test_a_large_network_is_kept_in_half_the_room_and_answers_as_its_rounded_self(tmp_path):
    network = _network(HALVED_BEYOND // 40)
    drawn = copy.deepcopy(network)
    round_weights(network)
    content, answers, meant = _answers(network, tmp_path)
    assert len(content) < 2.5 * HALVED_BEYOND
    np.testing.assert_allclose(answers, meant, atol=1e-5)
    with torch.no_grad():
        np.testing.assert_allclose(answers, drawn(torch.as_tensor(SEEN)).numpy(), atol=5e-3)


def test_a_small_network_is_kept_as_it_is():
    network = _network(16)
    before = copy.deepcopy(network.state_dict())
    round_weights(network)
    assert all(torch.equal(weights, before[name]) for name, weights in network.state_dict().items())


def _learner(actions, hidden: int):
    """Return what holds a policy as trainings have it: convolutions over 16 of 24 numbers, then two layers."""
    from gymnasium import spaces
    from stable_baselines3.common.policies import ActorCriticPolicy

    torch.manual_seed(0)
    convolutions = (Convolution(4, 3, 2), Convolution(4, 3, 1))
    reads = {"beams": slice(4, 20), "scans": 1, "convolutions": convolutions, "features": 16}
    net = {"features_extractor_class": BeamFeatures, "features_extractor_kwargs": reads, "net_arch": [hidden, hidden]}
    policy = ActorCriticPolicy(spaces.Box(-1, 1, (24,), np.float32), actions, lambda _: 1e-3, **net)
    return SimpleNamespace(policy=policy)


def _learn(learner, random):
    with torch.no_grad():
        for weights in learner.policy.parameters():
            weights.add_(0.1 * torch.randn(weights.shape, generator=random))


def test_a_policy_that_learned_on_is_the_file_that_tracing_it_anew_gives(monkeypatch):
    from gymnasium import spaces

    learner, random = _learner(spaces.Box(-1, 1, (2,), np.float32), 500), torch.Generator().manual_seed(0)
    export = PolicyExport(learner, 24)
    contents = []
    for _ in range(2):
        _learn(learner, random)
        contents.append(export.content())
    assert contents[1] == PolicyExport(learner, 24).content() != contents[0]
    _learn(learner, random)
    monkeypatch.delattr("torch.onnx.export")
    assert export.content() not in contents, "traced once"


def test_of_weights_that_are_alike_nothing_is_kept(tmp_path):
    from gymnasium import spaces

    learner = _learner(spaces.Discrete(3), 8)
    export = PolicyExport(learner, 24)
    export.content()  # biases are zeros, and two of them have one place
    _learn(learner, torch.Generator().manual_seed(0))
    content, seen = export.content(), SEEN.reshape(5, 24)
    with torch.no_grad():
        meant = Actor(learner.policy)(torch.as_tensor(seen)).numpy()
    np.testing.assert_allclose(open_network(tmp_path / "x.onnx", content, 24, 3).run(seen), meant, atol=1e-5)
