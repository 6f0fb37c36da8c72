"""Trained networks: ONNX files of one input and one output, run by onnxruntime."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena_core import InputFileError
from arena_core.files import LIMITS, read_bytes


class Network:
    """A network that runs, reading and writing arrays of its own: onnxruntime's general call
    would make new ones, and copy.
    """

    def __init__(self, session: Any) -> None:
        self._session = session
        self._input, self._output = session.get_inputs()[0], session.get_outputs()[0]
        self._bind_arrays(1)

    def run(self, numbers: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return new answers (N, A) to numbers (N, D)."""
        if len(numbers) != len(self._read):
            self._bind_arrays(len(numbers))
        self._read[:] = numbers
        self._session.run_with_iobinding(self._binding)
        return self._written.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> Network:
        """Return this one: nothing of it outlasts a call."""
        return self

    def _bind_arrays(self, rows: int) -> None:
        from onnxruntime import OrtValue

        self._read, self._written = (np.zeros((rows, end.shape[-1]), np.float32) for end in (self._input, self._output))
        self._binding = self._session.io_binding()
        self._binding.bind_ortvalue_input(self._input.name, OrtValue.ortvalue_from_numpy(self._read))
        self._binding.bind_ortvalue_output(self._output.name, OrtValue.ortvalue_from_numpy(self._written))


def network_content(path: Path) -> bytes:
    """Return what a file holds; raise InputFileError where it cannot be read or is too large for a network of ours."""
    return read_bytes(path, LIMITS.network_bytes, "an ONNX file with its card beside it")


def open_network(path: Path, content: bytes, inputs: int, outputs: int) -> Network:
    """Open the network; raise InputFileError where it is none, or reads or writes other numbers than the card says."""
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 4
    try:
        session = onnxruntime.InferenceSession(content, options, providers=["CPUExecutionProvider"])
        shapes = [[i.shape[-1] for i in session.get_inputs()], [o.shape[-1] for o in session.get_outputs()]]
        types = {value.type for value in (*session.get_inputs(), *session.get_outputs())}
    except Exception as error:  # onnxruntime's own kinds, for a damaged or foreign file
        raise InputFileError(
            f"{path}: is no ONNX model that runs ({' '.join(str(error).split())[:120]}); allowed: "
            "one that `arena train` wrote"
        ) from None
    if shapes != [[inputs], [outputs]] or types != {"tensor(float)"}:
        raise InputFileError(
            f"{path}: reads {shapes[0]} and writes {shapes[1]} numbers; allowed: "
            f"{[inputs]} and {[outputs]} as in its card, float32"
        )
    return Network(session)
