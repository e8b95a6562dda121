# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Messages of ROS recordings: .mcap files by `mcap`, other bags by `rosbags`, both without ROS."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fairlead.io.errors import InputError


@dataclass(frozen=True, kw_only=True, eq=False)
class Message:
    """One decoded message."""

    topic: str
    log_ns: int
    """When it was recorded."""
    content: Any
    """Fields as ROS names them."""


@dataclass(frozen=True, kw_only=True)
class Topic:
    """What comes under one name."""

    kind: str
    """sensor_msgs/msg/Image, ..."""
    count: int
    """Number of messages; 0 where the recording does not say."""


def topics(path: Path) -> dict[str, Topic]:
    """What a recording holds, by name. Raises InputError: not a recording, or its reader is not installed."""
    return _mcap_topics(_mcap_files(path)) if _mcap_files(path) else _bag_topics(path)


def messages(path: Path, wanted: Collection[str]) -> Iterator[Message]:
    """The messages of some topics in the order of the file.

    Raises InputError where the recording is damaged or cut short, after every message before that.
    """
    files = _mcap_files(path)
    if not files:
        yield from _bag_messages(path, wanted)
    for file in files:
        yield from _mcap_messages(file, wanted)


def _mcap_files(path: Path) -> list[Path]:
    if not path.is_dir():
        return [path] if path.suffix.lower() == ".mcap" else []
    return sorted(path.glob("*.mcap"), key=lambda file: (len(file.name), file.name))


def _mcap_topics(files: list[Path]) -> dict[str, Topic]:
    found: dict[str, Topic] = {}
    for file in files:
        for topic in _file_topics(file):
            count = found[topic[0]].count if topic[0] in found else 0
            found[topic[0]] = Topic(kind=topic[1], count=count + topic[2])
    return found


def _file_topics(file: Path) -> Iterator[tuple[str, str, int]]:
    """Topic, kind and count from the summary at the end; without one, from the records up to where it breaks off."""
    summary = _summary(file)
    if summary is not None and summary.statistics is not None:
        counts = summary.statistics.channel_message_counts
        for number, channel in summary.channels.items():
            yield channel.topic, _kind(summary.schemas.get(channel.schema_id)), counts.get(number, 0)
        return
    seen: dict[str, str] = {}
    try:
        with file.open("rb") as stream:
            for schema, channel, _ in _mcap_reader(stream).iter_messages(log_time_order=False):
                seen.setdefault(channel.topic, _kind(schema))
    except InputError:
        raise
    except Exception as error:  # mcap raises what its parsers, lz4 and zstd raise
        if not seen:
            raise InputError(file, f"no readable MCAP: {_said(error)}") from error
    for topic, kind in seen.items():
        yield topic, kind, 0


def _kind(schema: Any) -> str:
    return "" if schema is None else str(schema.name)


def _summary(file: Path) -> Any:
    try:
        from mcap.reader import SeekingReader
    except ImportError as error:
        raise _not_installed(file) from error
    try:
        with file.open("rb") as stream:
            return SeekingReader(stream).get_summary()
    except Exception:  # mcap raises what its parsers, lz4 and zstd raise; there is another way
        return None


def _mcap_reader(stream: Any) -> Any:
    try:
        from mcap.reader import NonSeekingReader
        from mcap_ros2.decoder import DecoderFactory
    except ImportError as error:
        raise _not_installed(stream.name) from error
    return NonSeekingReader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])


def _mcap_messages(file: Path, wanted: Collection[str]) -> Iterator[Message]:
    count = 0
    try:
        with file.open("rb") as stream:
            reader = _mcap_reader(stream)
            for _, channel, record, content in reader.iter_decoded_messages(list(wanted), log_time_order=False):
                count += 1
                yield Message(topic=channel.topic, log_ns=record.log_time, content=content)
    except InputError:
        raise
    except Exception as error:  # as above
        raise InputError(file, f"damaged after {count} messages: {_said(error)}") from error


def _open_bag(path: Path) -> Any:
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise _not_installed(path) from error
    folder = path if path.is_dir() or path.suffix == ".bag" else path.parent
    if folder.is_dir() and not (folder / "metadata.yaml").is_file():
        raise InputError(path, "expected metadata.yaml beside it, as a ROS 2 bag has")
    return AnyReader([folder], default_typestore=get_typestore(Stores.ROS2_HUMBLE))


def _bag_topics(path: Path) -> dict[str, Topic]:
    try:
        with _open_bag(path) as reader:
            return {
                name: Topic(kind=str(topic.msgtype), count=int(topic.msgcount)) for name, topic in reader.topics.items()
            }
    except InputError:
        raise
    except Exception as error:  # rosbags raises what its parsers and sqlite raise
        raise InputError(path, f"no readable bag: {_said(error)}") from error


def _bag_messages(path: Path, wanted: Collection[str]) -> Iterator[Message]:
    count = 0
    try:
        with _open_bag(path) as reader:
            connections = [each for each in reader.connections if each.topic in wanted]
            for connection, log_ns, raw in reader.messages(connections=connections):
                content = reader.deserialize(raw, connection.msgtype)
                count += 1
                yield Message(topic=connection.topic, log_ns=log_ns, content=content)
    except InputError:
        raise
    except Exception as error:  # as above
        raise InputError(path, f"damaged after {count} messages: {_said(error)}") from error


def _not_installed(path: object) -> InputError:
    return InputError(str(path), "reading bags needs the extra: pip install 'fairlead[ros]'")


def _said(error: Exception) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0] or type(error).__name__
