"""A trained policy as an ONNX file."""

from __future__ import annotations

import copy
import logging
import warnings
from typing import Any

import numpy as np
import torch
from gymnasium.spaces import Discrete
from numpy.typing import NDArray
from stable_baselines3 import PPO
from torch import nn

HALVED_BEYOND = 250_000  # [-] weights of a network beyond which its file keeps each in 16 bits
HALVED_FROM = 1_000  # [-] numbers of a tensor from which on it is kept so: biases are not


class Actor(nn.Module):
    """What acts, and all that is exported: the mean of the policy's actions, or what it prefers each member by."""

    def __init__(self, policy: Any) -> None:
        super().__init__()
        self._chooses = isinstance(policy.action_space, Discrete)
        self.features, self.body, self.action = (
            policy.pi_features_extractor,
            policy.mlp_extractor.policy_net,
            policy.action_net,
        )

    def forward(self, observation: torch.Tensor) -> torch.Tensor:
        """Return the actions (N, A), or what each member is preferred by, for observations (N, D)."""
        actions = self.action_means(observation)
        return actions if self._chooses else actions.clamp(-1.0, 1.0)

    def action_means(self, observation: torch.Tensor) -> torch.Tensor:
        """Return the actions (N, A) before they are cut to their ranges."""
        actions: torch.Tensor = self.action(self.body(self.features(observation)))
        return actions

    def act(self, observations: NDArray[np.float32]) -> NDArray[np.floating[Any]]:
        """Return the actions (N, A), or the members chosen (N,), for observations (N, D)."""
        device = next(self.parameters()).device
        with torch.no_grad():
            answers: NDArray[np.floating[Any]] = self(torch.as_tensor(observations, device=device)).cpu().numpy()
        return answers.argmax(axis=1) if self._chooses else answers


class PolicyExport:
    """One learner's policy as ONNX models: what is traced at first serves later ones, which differ in weights alone."""

    def __init__(self, learner: PPO, size: int) -> None:
        self._learner, self._size = learner, size
        self._traced: Any = None

    def content(self) -> bytes:
        """Return what the learner is now: ``observation`` (N, size) to ``action`` (N, A), float32, unless of a switch
        in [-1, 1]. The learner may go on learning.
        """
        actor = copy.deepcopy(Actor(self._learner.policy)).to("cpu").eval()
        round_weights(actor)
        model = None if self._traced is None else _with_weights(self._traced, actor)
        if model is None:
            model = _trace(actor, self._size, "observation", "action")
            self._traced = model if _with_weights(model, actor) == model else None
        return _content(model, actor)


def _with_weights(model: Any, network: nn.Module) -> Any:
    """Return a copy of a traced model with the weights of a network of the same structure; None where a model traced
    again may have another structure: where it does not hold each weight by name, or two are alike, which share a place.
    """
    from onnx import numpy_helper

    weights = {name: part.detach().numpy() for name, part in network.named_parameters()}
    places = {tensor.name: tensor for tensor in model.graph.initializer}
    if len({part.tobytes() for part in weights.values()}) < len(weights) or not weights.keys() <= places.keys():
        return None
    changed = copy.deepcopy(model)
    for tensor in changed.graph.initializer:
        if tensor.name in weights:
            part = numpy_helper.from_array(weights[tensor.name], tensor.name)
            if list(part.dims) != list(tensor.dims):
                return None
            tensor.CopyFrom(part)
    return changed


def round_weights(network: nn.Module) -> None:
    """Give a large network the weights that its file will keep, so that what is tested is what is shipped."""
    if _is_large(network):
        with torch.no_grad():
            for weights in network.parameters():
                if weights.numel() >= HALVED_FROM:
                    weights.copy_(weights.half())


def network_to_onnx(network: nn.Module, size: int, input_name: str, output_name: str) -> bytes:
    """Return a network that reads (N, ``size``) numbers as an ONNX model, which says nothing of
    the machine that it was made on.
    """
    return _content(_trace(network.to("cpu").eval(), size, input_name, output_name), network)


def _trace(network: nn.Module, size: int, input_name: str, output_name: str) -> Any:
    """Return the ONNX model of a network on the CPU, all of its weights in 32 bits."""
    exporter = logging.getLogger("torch.onnx")
    level = exporter.level
    exporter.setLevel(logging.ERROR)  # it notes every optional package that is not installed
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        program = torch.onnx.export(
            network,
            (torch.zeros(2, size),),
            dynamo=True,
            input_names=[input_name],
            output_names=[output_name],
            dynamic_shapes=({0: torch.export.Dim("worlds", min=1)},),
            verbose=False,
        )
    exporter.setLevel(level)
    assert program is not None
    model = program.model_proto
    strip_origin(model)
    return model


def _content(model: Any, network: nn.Module) -> bytes:
    """Return a model as it is kept: the large weights of a large network in 16 bits."""
    if _is_large(network):
        model = copy.deepcopy(model)
        _halve_weights(model)
    return bytes(model.SerializeToString())


def strip_origin(model: Any) -> None:
    """Take from an ONNX model where its nodes came from: folders and lines of the code that made it."""
    graph = model.graph
    for part in (graph, *graph.node, *graph.input, *graph.output, *graph.value_info, *graph.initializer):
        part.ClearField("metadata_props")
        part.ClearField("doc_string")


def _is_large(network: nn.Module) -> bool:
    return sum(weights.numel() for weights in network.parameters()) > HALVED_BEYOND


def _halve_weights(model: Any) -> None:
    """Keep large tensors in 16 bits; onnxruntime widens them once, as it opens the file."""
    from onnx import TensorProto, helper, numpy_helper

    widened = []
    for tensor in model.graph.initializer:
        if tensor.data_type == TensorProto.FLOAT and np.prod(tensor.dims) >= HALVED_FROM:
            name, kept = tensor.name, f"{tensor.name}.half"
            tensor.CopyFrom(numpy_helper.from_array(numpy_helper.to_array(tensor).astype(np.float16), kept))
            widened.append(helper.make_node("Cast", [kept], [name], to=TensorProto.FLOAT))
    nodes = [*widened, *model.graph.node]
    del model.graph.node[:]
    model.graph.node.extend(nodes)
