"""Networks as files: the same answers, nothing of where they were made, large ones in 16 bits."""

from __future__ import annotations

import copy

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")
onnx = pytest.importorskip("onnx", reason="training needs the extra arena-gym[train]")

from arena_gym.training.export import HALVED_BEYOND, network_to_onnx, round_weights  # noqa: E402
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
