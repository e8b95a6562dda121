# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The document: labels, actions on them, undo and redo. Every change is recorded before it is made."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from fairlead.annotate.labels import Labels, Landmark, Mark, Marks, Origin, Triple

HISTORY = 1000
"""Actions that can be undone."""


@dataclass(frozen=True, kw_only=True)
class LandmarksChange:
    """The list of landmarks, before and after."""

    before: tuple[Landmark, ...]
    after: tuple[Landmark, ...]


@dataclass(frozen=True, kw_only=True)
class MarksChange:
    """The marks of one frame, before and after."""

    frame: int
    before: Marks
    after: Marks


Change = LandmarksChange | MarksChange


@dataclass(frozen=True, kw_only=True)
class Action:
    """What one click or key did."""

    what: str
    """In words, for the page."""
    changes: tuple[Change, ...]

    def reversed(self) -> "Action":
        """What undoes it."""
        undone = tuple(replace(change, before=change.after, after=change.before) for change in reversed(self.changes))
        return Action(what=self.what, changes=undone)


class Document:
    """Labels that are being edited.

    `record` writes an action down before it is made; where it raises OSError nothing has changed. Listeners are called
    after each change, with the action.
    """

    def __init__(self, labels: Labels, record: Callable[[Action], None] | None = None) -> None:
        self._labels = labels
        self._record = record
        self._undo: list[Action] = []
        self._redo: list[Action] = []
        self._listeners: list[Callable[[Action], None]] = []
        self.revision = 0
        """Counts changes."""

    @property
    def labels(self) -> Labels:
        """As they are now."""
        return self._labels

    def listen(self, listener: Callable[[Action], None]) -> Callable[[], None]:
        """Call after each change; returns what stops that."""
        self._listeners.append(listener)
        return lambda: self._listeners.remove(listener) if listener in self._listeners else None

    def _apply(self, action: Action) -> None:
        labels = self._labels
        frames = dict(labels.frames)
        landmarks = labels.landmarks
        for change in action.changes:
            if isinstance(change, LandmarksChange):
                landmarks = change.after
            else:
                frames.pop(change.frame, None)
                if change.after:
                    frames[change.frame] = change.after
        changed = Labels(landmarks=landmarks, frames=frames)
        if self._record is not None:
            self._record(action)
        self._labels = changed
        self.revision += 1
        for listener in tuple(self._listeners):
            listener(action)

    def _do(self, what: str, *changes: Change) -> None:
        real = tuple(change for change in changes if change.before != change.after)
        if not real:
            return
        action = Action(what=what, changes=real)
        self._apply(action)
        self._undo = [*self._undo[1 - HISTORY :], action]
        self._redo.clear()

    def undo(self) -> str | None:
        """Take back the last action; returns what it was, None if there is none."""
        if not self._undo:
            return None
        self._apply(self._undo[-1].reversed())
        self._redo.append(self._undo.pop())
        return self._redo[-1].what

    def redo(self) -> str | None:
        """Do again what was taken back; returns what it was, None if there is none."""
        if not self._redo:
            return None
        self._apply(self._redo[-1])
        self._undo.append(self._redo.pop())
        return self._undo[-1].what

    @property
    def can_undo(self) -> bool:
        """Whether there is an action to take back."""
        return bool(self._undo)

    @property
    def can_redo(self) -> bool:
        """Whether an action was taken back."""
        return bool(self._redo)

    def _set_landmarks(self, what: str, landmarks: tuple[Landmark, ...]) -> None:
        Labels(landmarks=landmarks)
        self._do(what, LandmarksChange(before=self._labels.landmarks, after=landmarks))

    def add_landmark(self, name: str, position_m: Triple, sigma_m: Triple) -> Landmark:
        """A new landmark at the end of the list. Raises ValueError for a name that is taken, or no number."""
        landmark = Landmark(number=self.next_number(), name=name, position_m=position_m, sigma_m=sigma_m)
        self._set_landmarks(f"add {name}", (*self._labels.landmarks, landmark))
        return landmark

    def add_landmarks(self, landmarks: Mapping[str, tuple[Triple, Triple]]) -> None:
        """Several at once (position, sigma [m] by name), as one action. Raises as `add_landmark`."""
        first = self.next_number()
        new = tuple(
            Landmark(number=first + index, name=name, position_m=position_m, sigma_m=sigma_m)
            for index, (name, (position_m, sigma_m)) in enumerate(landmarks.items())
        )
        self._set_landmarks(f"add {len(new)} landmarks", (*self._labels.landmarks, *new))

    def next_number(self) -> int:
        """A number that no landmark has, nor had one whose marks are still there."""
        used = {landmark.number for landmark in self._labels.landmarks}
        for marks in self._labels.frames.values():
            used.update(marks)
        return max(used, default=-1) + 1

    def free_name(self, stem: str = "p") -> str:
        """A name that is not taken: p1, p2, ..."""
        taken = {landmark.name for landmark in self._labels.landmarks}
        return next(name for i in range(1, len(taken) + 2) if (name := f"{stem}{i}") not in taken)

    def _edit(self, what: str, edited: Landmark) -> None:
        changed = tuple(edited if each.number == edited.number else each for each in self._labels.landmarks)
        self._set_landmarks(what, changed)

    def move_landmark(self, number: int, position_m: Triple) -> None:
        """Put a landmark elsewhere. Raises KeyError, ValueError."""
        landmark = self._labels.landmark(number)
        self._edit(f"move {landmark.name}", replace(landmark, position_m=position_m))

    def rename_landmark(self, number: int, name: str) -> None:
        """Give it another name; its marks stay. Raises KeyError, and ValueError for a name that is taken."""
        landmark = self._labels.landmark(number)
        self._edit(f"rename {landmark.name} to {name}", replace(landmark, name=name))

    def set_sigma(self, number: int, sigma_m: Triple) -> None:
        """How well it is known. Raises KeyError, ValueError."""
        landmark = self._labels.landmark(number)
        self._edit(f"sigma of {landmark.name}", replace(landmark, sigma_m=sigma_m))

    def set_all_sigmas(self, sigma_m: float) -> None:
        """The same sigma for all. Raises ValueError."""
        sigmas = (sigma_m, sigma_m, sigma_m)
        self._set_landmarks("sigma of all", tuple(replace(each, sigma_m=sigmas) for each in self._labels.landmarks))

    def delete_landmark(self, number: int) -> None:
        """Take it off the list. Its marks are kept unseen, so that undo brings all of it back. Raises KeyError."""
        landmark = self._labels.landmark(number)
        left = tuple(each for each in self._labels.landmarks if each.number != number)
        self._set_landmarks(f"delete {landmark.name}", left)

    def mark(
        self, frame: int, number: int, u_px: float, v_px: float, *, sigma_px: float = 1.0, origin: Origin = "click"
    ) -> None:
        """Say where a landmark is seen. Raises KeyError, ValueError."""
        mark = Mark(u_px=u_px, v_px=v_px, sigma_px=sigma_px, origin=origin)
        self._put(f"mark {self._labels.landmark(number).name} in frame {frame}", frame, number, mark)

    def hide(self, frame: int, number: int) -> None:
        """Say that a landmark cannot be seen. Raises KeyError."""
        name = self._labels.landmark(number).name
        self._put(f"{name} is hidden in frame {frame}", frame, number, Mark(hidden=True))

    def clear(self, frame: int, number: int) -> None:
        """Take a mark away. Raises KeyError."""
        self._put(f"clear {self._labels.landmark(number).name} in frame {frame}", frame, number, None)

    def _put(self, what: str, frame: int, number: int, mark: Mark | None) -> None:
        before = self._labels.frames.get(frame, {})
        after = {key: value for key, value in before.items() if key != number}
        if mark is not None:
            after[number] = mark
        self._do(what, MarksChange(frame=frame, before=before, after=after))

    def set_marks(self, frame: int, marks: Marks, what: str) -> None:
        """All marks of a frame at once, as one action."""
        before = self._labels.frames.get(frame, {})
        self._do(what, MarksChange(frame=frame, before=before, after=dict(marks)))
