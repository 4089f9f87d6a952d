"""Changes in place by `step`, and their undoing: so a configuration can be stepped again, whatever was
stepped since.

Python's functions close over variables and its lists are shared, so scopes and containers of a program are
updated in place. Each change is noted first. The states of a run form a tree of versions: the current one is
what stands in memory, and every other knows what leads back to it from the next version on the way to the
current one (the rerooting of Baker, "Shallow binding makes functional arrays fast", 1991). Going on costs one
note per change; a version that no configuration holds any more is forgotten, and a run that is driven to its
end forgets where it began.
"""

# pyright: reportUnknownVariableType=false, reportUnknownArgumentType=false, reportUnknownMemberType=false
# What a program keeps in its containers has no type of ours.

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Container, Iterator, Mapping
from types import BuiltinFunctionType, FunctionType, GetSetDescriptorType, MemberDescriptorType, MethodDescriptorType, MethodType
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from .errors import RunError
from .sets import Set

if TYPE_CHECKING:
    from .budget import Budget

MISSING = object()


class Note(Protocol):
    """How something was before it was changed."""

    def undo(self) -> Note:
        """Change it back; how it was before that."""
        ...


class DrivenOn(RuntimeError):
    """A configuration is stepped whose run was driven on, and forgot it."""


class Version:
    """A version of what a run changes in place. `undo` leads back to it from the `newer` one; it is empty while the version stands in memory.

    Where many runs begin with one configuration of this version, `beginning`, `steps` led to it, which took `work` of the budget.
    """

    __slots__ = ("beginning", "newer", "steps", "undo", "versions", "work")

    def __init__(self, versions: Versions) -> None:
        self.versions = versions
        self.newer: Version | None = None
        self.undo: list[Note] = []
        self.beginning: object = None
        self.steps = self.work = 0

    @property
    def within_reach(self) -> bool:
        """Whether it can be gone back to: the run was not driven on from a later version."""
        found: Version | None = self
        while found is not None and found is not self.versions.current:
            found = found.newer
        return found is not None

    def begun_anew(self) -> Version:
        """Return the version as it stands in memory with nothing behind it: older configurations, and those
        that went on from it, cannot be stepped again.
        """
        if self.undo:
            self.versions.go_to(self)
        return self.versions.begin_anew()


class Versions:
    """The versions of one run, and the one that stands in memory."""

    __slots__ = ("busy", "current", "given")

    def __init__(self) -> None:
        self.current = Version(self)
        self.busy: tuple[Container[int], ...] = ()
        """The numbers (`id`) of containers that Python is looking through while it asks a method of the program."""
        self.given: object = None
        """The draw that the plain arguments of a running host call depend on, where control flow may depend on none."""

    def note(self, note: Note) -> None:
        """Something is about to change."""
        self.current.undo.append(note)

    def settled(self) -> Version:
        """The version with what changed since the last one."""
        current = self.current
        if current.undo:
            current.newer = self.current = Version(self)
        return self.current

    def begin_anew(self) -> Version:
        """The version that stands in memory, with nothing behind it: older configurations are forgotten, and what it takes to step them again."""
        left = self.settled()
        self.current = Version(self)
        left.undo = [Forgotten()]
        return self.current

    def go_to(self, version: Version) -> None:
        """Change everything back, or forth again, to the given version."""
        self.settled()
        path: list[Version] = []
        found: Version | None = version
        while found is not self.current:
            if found is None:
                raise DrivenOn("this configuration was driven on: it cannot be stepped again")
            path.append(found)
            found = found.newer
        self.busy = (EVERYTHING,)
        try:
            for older in reversed(path):
                newer = self.current
                newer.undo = [note.undo() for note in reversed(older.undo)]
                newer.newer, older.newer, older.undo = older, None, []
                self.current = older
        finally:
            self.busy = ()


def notes_since(version: Version) -> Iterator[Any]:
    """Yield what was noted from the version on, which led to the one that stands in memory."""
    found: Version | None = version
    while found is not None:
        yield from found.undo
        found = found.newer


class Everything:
    """The numbers of all containers."""

    def __contains__(self, number: object) -> bool:
        return True


EVERYTHING = Everything()


class Forgotten(NamedTuple):
    """The marker of a version to which nothing can go back."""

    def undo(self) -> Forgotten:
        """Never asked for: nothing leads here."""
        return self


class Entry(NamedTuple):
    """An entry of a dictionary: a variable, an attribute, or what a program assigns to under a key of Python's own."""

    subject: dict[Any, object]
    key: object
    before: object

    def undo(self) -> Entry:
        """Put back what stood there, if something did."""
        now = Entry(self.subject, self.key, self.subject.get(self.key, MISSING))
        if self.before is not MISSING:
            dict.__setitem__(self.subject, self.key, self.before)
        elif now.before is not MISSING:
            dict.__delitem__(self.subject, self.key)
        return now


class Item(NamedTuple):
    """An element of a list."""

    subject: list[object]
    position: int
    before: object

    def undo(self) -> Item:
        """Put back what stood there."""
        now = Item(self.subject, self.position, list.__getitem__(self.subject, self.position))
        list.__setitem__(self.subject, self.position, self.before)
        return now


class Tail(NamedTuple):
    """The end of a list from an index on."""

    subject: list[object]
    position: int
    before: list[object]

    def undo(self) -> Tail:
        """Put back the elements that stood there."""
        now = Tail(self.subject, self.position, list.__getitem__(self.subject, slice(self.position, None)))
        list.__setitem__(self.subject, slice(self.position, None), self.before)
        return now


class Content(NamedTuple):
    """All that a container holds, in its order."""

    subject: object
    before: Any

    def undo(self) -> Content:
        """Fill it with what it held."""
        now = Content(self.subject, content_of(self.subject))
        match self.subject:
            case list() as items:
                list.__setitem__(items, slice(None), self.before)
            case deque() as items:
                deque.clear(items)
                deque.extend(items, self.before)
            case Set() as items:
                Set.renewed(items, dict(self.before))
            case dict() as items:
                dict.clear(items)
                dict.update(items, self.before)
            case _:
                raise AssertionError(type(self.subject))
        return now


class Slot(NamedTuple):
    """An attribute of something whose attributes stand in no dictionary of its own: a class, an exception, an object of ours."""

    subject: object
    name: str
    before: object

    def undo(self) -> Slot:
        """Assign what it was, or delete it."""
        now = Slot(self.subject, self.name, own(self.subject, self.name))
        if self.before is now.before:  # the assignment was refused
            return now
        if self.before is not MISSING:
            setattr(self.subject, self.name, self.before)
        elif now.before is not MISSING:
            delattr(self.subject, self.name)
        return now


def own(subject: object, name: str) -> object:
    """The attribute of a class itself, not of one above it; of anything else just the attribute; MISSING if there is none."""
    return vars(subject).get(name, MISSING) if isinstance(subject, type) else getattr(subject, name, MISSING)


def content_of(container: object) -> Any:
    """A copy of what a container holds, with a subclass's own ways of looking at it left out."""
    match container:
        case list():
            return list.copy(container)
        case deque():
            return [*deque.__iter__(container)]
        case Set():
            return dict(container.order)
        case dict():
            return dict.copy(container)
        case _:
            raise AssertionError(type(container))


CHANGEABLE = (list, dict, Set, deque)
SIMPLE = (str, int, float, bool, type(None))
"""Types of keys that are looked up by Python alone, but for keys of the program that have the same hash."""

STORED: Mapping[str, Collection[int]] = {
    "append": {0}, "appendleft": {0}, "extend": {0}, "extendleft": {0}, "insert": {1}, "setdefault": {1}, "update": {0},
    "add": (), "clear": (), "difference_update": (), "discard": (), "intersection_update": (), "move_to_end": (), "pop": (), "popitem": (),
    "popleft": (), "remove": (), "reverse": (), "rotate": (), "sort": (), "subtract": (), "symmetric_difference_update": (),
}  # fmt: skip
"""Methods that change a container: which arguments become elements, which keep their randomness. All others are keys, indices, counts."""


COPIED = 2
"""What an element costs that is copied for a note."""


def check_idle(budget: Budget, container: object) -> None:
    """Refuse to change a container that Python is just looking through: its C code may go on with what is removed. Raises `RunError`."""
    if budget.versions.busy and any(id(container) in numbers for numbers in budget.versions.busy):
        raise RunError(
            "a method that says how a value is compared, hashed or written may not change the container that Python is looking through",
            rule="E-Call-Host",
        )


def note_container(budget: Budget, container: object) -> None:
    """Whatever the container holds may change."""
    if isinstance(container, CHANGEABLE):
        check_idle(budget, container)
        content = content_of(container)
        budget.spend(COPIED * len(content))
        budget.versions.note(Content(container, content))


def note_end(budget: Budget, container: list[Any]) -> None:
    """The last element of the list may be removed, or one may come after it."""
    check_idle(budget, container)
    end = max(0, list.__len__(container) - 1)
    budget.versions.note(Tail(container, end, list.__getitem__(container, slice(end, None))))


def note_item(budget: Budget, container: object, key: object) -> None:
    """`container[key]` may change, or come to be."""
    versions = budget.versions
    check_idle(budget, container)
    if type(container) is list and type(key) is int and -len(container) <= key < len(container):
        versions.note(Item(container, key, container[key]))
    elif isinstance(container, dict) and type(key) in SIMPLE:
        versions.note(Entry(container, key, dict.get(container, key, MISSING)))
    else:
        note_container(budget, container)


def note_attribute(budget: Budget, subject: object, name: str) -> None:
    """`subject.name` may change, or come to be."""
    attributes = getattr(subject, "__dict__", None)
    if type(attributes) is dict and not isinstance(getattr(type(subject), name, None), (MemberDescriptorType, GetSetDescriptorType)):
        budget.versions.note(Entry(attributes, name, attributes.get(name, MISSING)))
    else:
        budget.versions.note(Slot(subject, name, own(subject, name)))


def changes_its_owner(function: object) -> bool:
    """Whether this is a method that changes the container which it belongs to."""
    owner = getattr(function, "__self__", None) if isinstance(function, (BuiltinFunctionType, MethodType)) else None
    return isinstance(owner, CHANGEABLE) and getattr(function, "__name__", "") in STORED


def note_call(budget: Budget, function: object, arguments: Collection[object]) -> None:
    """A function of Python is about to be called: if it is a method that changes a container, note what that holds."""
    kind = type(function)
    if kind is BuiltinFunctionType or kind is MethodType:
        owner = function.__self__  # type: ignore[attr-defined]
    elif (kind is MethodDescriptorType or kind is FunctionType) and arguments:
        owner = next(iter(arguments))
    else:
        return
    if isinstance(owner, CHANGEABLE) and (name := getattr(function, "__name__", "")) in STORED:
        if isinstance(owner, list) and (name == "append" or (name == "pop" and not arguments)):
            note_end(budget, owner)
        elif name == "setdefault" and arguments:
            note_item(budget, owner, next(iter(arguments)))
        else:
            note_container(budget, owner)
