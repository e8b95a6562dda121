# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""pymavlink behind one door, and the message that its dialects lack: target_relative.xml."""

import struct
from collections.abc import Sequence
from functools import cache
from typing import Any, ClassVar

from fairlead.io.errors import InputError

FRAME_LOCAL_NED, FRAME_BODY_FRD = 1, 12
"""MAV_FRAME of LANDING_TARGET."""
OBSERVED_BODY_FRD, OBSERVED_OFFSET_NED = 1, 2
"""TARGET_OBS_FRAME of TARGET_RELATIVE."""
VISION_FIDUCIAL = 2
"""LANDING_TARGET_TYPE."""
COMPONENT = 191
"""MAV_COMP_ID_ONBOARD_COMPUTER."""


@cache
def mavlink() -> Any:
    """The dialect `common` of MAVLink 2. Raises InputError without the extra `mavlink`."""
    try:
        from pymavlink.dialects.v20 import common
    except ImportError as error:
        raise InputError("--mavlink", "needs the extra: pip install 'fairlead[mavlink]'") from error
    return common


@cache
def target_relative() -> Any:
    """The class of TARGET_RELATIVE; its bytes are those that mavgen's class of target_relative.xml makes."""
    base: Any = mavlink().MAVLink_message

    class TargetRelative(base):
        id = 511
        msgname = "TARGET_RELATIVE"
        fieldnames: ClassVar = [
            *("timestamp", "id", "frame", "x", "y", "z", "pos_std", "yaw_std", "q_target", "q_sensor", "type")
        ]
        orders: ClassVar = [0, 8, 9, 1, 2, 3, 4, 5, 6, 7, 10]
        lengths: ClassVar = [1, 1, 1, 1, 3, 1, 4, 4, 1, 1, 1]
        crc_extra = 28
        unpacker = struct.Struct("<Qfff3ff4f4fBBB")

        def __init__(self, *values: Any) -> None:
            super().__init__(511, self.msgname)
            self._fieldnames = self.fieldnames
            for name, value in zip(self.fieldnames, values, strict=True):
                setattr(self, name, value)

        def pack(self, mav: Any, force_mavlink1: bool = False) -> bytes:  # noqa: FBT001, FBT002
            payload = self.unpacker.pack(
                self.timestamp, self.x, self.y, self.z, *self.pos_std, self.yaw_std, *self.q_target, *self.q_sensor,
                self.id, self.frame, self.type
            )  # fmt: skip
            return self._pack(mav, self.crc_extra, payload, force_mavlink1=force_mavlink1)

    return TargetRelative


def messages_in(data: bytes) -> tuple[list[bytes], bytes]:
    """Whole frames of MAVLink 1 and 2 in these bytes, and what may be the beginning of the next one."""
    frames: list[bytes] = []
    place = 0
    while place < len(data):
        if data[place] not in (0xFD, 0xFE):
            place += 1
            continue
        size = _frame_size(data[place : place + 3])
        if size is None or place + size > len(data):
            return frames, data[place:]
        frames.append(data[place : place + size])
        place += size
    return frames, b""


def _frame_size(head: Sequence[int]) -> int | None:
    if len(head) < 3:
        return None
    if head[0] == 0xFE:
        return 8 + head[1]
    return 12 + head[1] + (13 if head[2] & 1 else 0)
