# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""An .onnx file with its card, checked and run by ONNX Runtime, docs/detect.md section 1."""

import hashlib
import re
from pathlib import Path
from typing import Any

import numpy as np

from fairlead.detect.keypoints import Keypoints
from fairlead.detect.onnx.decode import decode
from fairlead.io.documents import read_text
from fairlead.io.errors import InputError
from fairlead.io.network_card import METADATA_KEY, OUTPUTS, NetworkCard, card_from_json, load_card
from fairlead.opencv import Image

MAX_MODEL_BYTES = 512 * 1024 * 1024
MULTIPLE_PX = 32
"""Sides of an image for a fully convolutional network are multiples of this."""
_SHA256 = re.compile(r"[0-9a-f]{64}")


class Network:
    """A landmark network that was run once on load, so that what it is given later it can take.

    One thread, no spinning; the GPU where the runtime has one, else the processor. Raises InputError: unreadable, cut
    short, damaged, of another sum than its card says, without a card, or other than its card says.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        content = _content(path)
        digest = hashlib.sha256(content).hexdigest()
        _check_sum(path, digest, _sum_beside(path))
        self._session = _session(path, content)
        self.card = _card(path, self._session)
        _check_sum(path, digest, self.card.sha256)
        self._outputs = self._output_names()
        self._check_input()
        self.size = (self.card.input.width, self.card.input.height)
        self._mean = np.array(self.card.input.mean, dtype=np.float32)[:, None, None]
        self._per_std = (1.0 / np.array(self.card.input.std)).astype(np.float32)[:, None, None]
        width, height = self.size
        trials = (
            [self.size, (width + 2 * MULTIPLE_PX, height + MULTIPLE_PX)] if self.card.input.any_size else [self.size]
        )
        for width, height in trials:
            self._check_outputs(self.run(self.blob(np.zeros((height, width, 3), np.uint8))), width, height)

    def look(self, crop: Image) -> Keypoints:
        """The landmarks of a crop (blue, green, red), in its pixels."""
        return decode(self.card, self.run(self.blob(crop)))

    def blob(self, crop: Image) -> np.ndarray:
        """x = (v - mean) / std in the network's order of colours, (1, 3, h, w) float32."""
        ordered = crop[..., ::-1] if self.card.input.color == "RGB" else crop
        planes = ordered.transpose(2, 0, 1).astype(np.float32)
        planes -= self._mean
        planes *= self._per_std
        return np.ascontiguousarray(planes)[None]

    def run(self, blob: np.ndarray) -> list[np.ndarray]:
        """The outputs that the card speaks of, without the batch's dimension."""
        try:
            outputs: list[Any] = self._session.run(self._outputs, {self.card.input.name: blob})
        except Exception as error:  # the runtime's exceptions share no base class of their own
            raise InputError(self.path, f"the network cannot be run: {_reason(error)}") from error
        return [np.asarray(output)[0] if np.ndim(output) else np.asarray(output) for output in outputs]

    def _check_input(self) -> None:
        card, inputs = self.card.input, self._session.get_inputs()
        names = [each.name for each in inputs]
        if names != [card.name]:
            raise InputError(self.path, f"expected one input {card.name!r} as its card says, got {', '.join(names)}")
        shape = [each if isinstance(each, int) else None for each in inputs[0].shape]
        free = None if card.any_size else card.height, None if card.any_size else card.width
        wanted = (1, 3, *free)
        fits = len(shape) == 4 and all(s is None or w is None or s == w for s, w in zip(shape, wanted, strict=True))
        if card.any_size and len(shape) == 4 and shape[2:] != [None, None]:
            fits = False
        if not fits or inputs[0].type != "tensor(float)":
            expected = f"(1, 3, {free[0] or 'any'}, {free[1] or 'any'}) tensor(float)"
            raise InputError(
                self.path, f"input {card.name}: expected {expected}, got {tuple(inputs[0].shape)} {inputs[0].type}"
            )

    def _output_names(self) -> list[str]:
        decoding, outputs = self.card.decoding, self._session.get_outputs()
        there = [each.name for each in outputs]
        if decoding.outputs or OUTPUTS[decoding.kind]:
            wanted = list(decoding.outputs or OUTPUTS[decoding.kind])
        else:
            wanted = [each.name for each in outputs if len(each.shape) == 4]
        if not wanted or not set(wanted) <= set(there) or (decoding.kind == "heatmap" and len(wanted) != 1):
            expected = ", ".join(wanted) or "one with four dimensions"
            raise InputError(
                self.path, f"outputs: expected {expected} for kind {decoding.kind}, got {', '.join(there)}"
            )
        return wanted

    def _check_outputs(self, outputs: list[np.ndarray], width: int, height: int) -> None:
        n, decoding = len(self.card.landmarks), self.card.decoding
        if decoding.kind == "pixels":
            expected = [(n, 2), (n, 3), (n,)]
        elif decoding.kind == "simcc":
            expected = [(n, round(side * decoding.bins_per_px)) for side in (width, height)]
        else:
            expected = [(n, round(height / decoding.stride), round(width / decoding.stride))]
        for name, output, shape in zip(self._outputs, outputs, expected, strict=True):
            if output.shape != shape or output.dtype.kind != "f":
                got = f"{output.dtype} {(1, *output.shape)}"
                raise InputError(self.path, f"output {name}: expected floats {(1, *shape)}, got {got}")


def _content(path: Path) -> bytes:
    try:
        if path.stat().st_size > MAX_MODEL_BYTES:
            raise InputError(path, f"expected a network of at most {MAX_MODEL_BYTES} bytes, got {path.stat().st_size}")
        return path.read_bytes()
    except OSError as error:
        raise InputError(path, f"cannot be read: {error.strerror}") from error


def _sum_beside(path: Path) -> str | None:
    """From `model.onnx.sha256`, in the form of sha256sum."""
    beside = path.with_name(path.name + ".sha256")
    if not beside.is_file():
        return None
    words = read_text(beside, 4096).split()
    if not words or not _SHA256.fullmatch(words[0].lower()):
        raise InputError(beside, "expected a sha256 in hexadecimal")
    return words[0].lower()


def _check_sum(path: Path, digest: str, wanted: str | None) -> None:
    if wanted is not None and digest != wanted:
        raise InputError(path, f"damaged or another file: expected sha256 {wanted[:16]}..., got {digest[:16]}...")


def _session(path: Path, content: bytes) -> Any:
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 4
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    options.add_session_config_entry("session.inter_op.allow_spinning", "0")
    available = onnxruntime.get_available_providers()
    providers = [each for each in ("CUDAExecutionProvider", "CPUExecutionProvider") if each in available]
    try:
        return onnxruntime.InferenceSession(content, options, providers=providers)
    except Exception as error:  # as in `Network.run`
        raise InputError(path, f"expected an ONNX network, the runtime refuses it: {_reason(error)}") from error


def _card(path: Path, session: Any) -> NetworkCard:
    """From the metadata, else from the TOML beside the file."""
    try:
        text = session.get_modelmeta().custom_metadata_map.get(METADATA_KEY)
    except Exception as error:  # text that is not UTF-8
        raise InputError(path, f"its metadata cannot be read: {_reason(error)}") from error
    if text is not None:
        return card_from_json(text, path)
    beside = path.with_suffix(".toml")
    if not beside.is_file():
        raise InputError(path, f"carries no card, and {beside.name} is not beside it (docs/files.md section 14)")
    return load_card(beside)


def _reason(error: Exception) -> str:
    """The runtime's words without its prefix and addresses."""
    return str(error).split(" : ", 2)[-1].split("\n")[0][:160]
