"""Members of classes of the program: what they are to an instance, to the class itself, and to `super()`."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from ..kernel.allowed import is_given, is_record, is_user_made, may_ask
from ..kernel.config import State
from ..kernel.host import HostException, raw
from ..kernel.scenic_classes import Above, ScenicClass
from ..kernel.scopes import MISSING
from ..kernel.values import Bound, Function, Instance, Method, Native, plain
from .library import method_of


def member_of(found: object, subject: object | None, class_: object, state: State) -> object:
    """A member of a class, of one of its instances or (`subject` is None) of the class itself: methods know of what they are."""
    match found:
        case staticmethod(__func__=function):
            return function
        case classmethod(__func__=Function() as function):
            return Method(function, class_, function.door)
        case property() if subject is not None:
            return raw(state.settings.door, state, found.__get__, subject, Instance)
        case Function() if subject is not None:
            return Method(found, subject, found.door)
    return found


NOTHING_TO_DO = Native("__init__", lambda *arguments, **keywords: None)
"""The `__init__` of a Scenic class: what there is to do is done when the instance is made."""


def attribute_above(above: Above, name: str, state: State) -> object:
    """`super().name`: that of the first class behind the one of the method that has it."""
    subject = above.subject
    is_class = isinstance(subject, (type, ScenicClass))
    for class_ in above.classes:
        if isinstance(class_, type) and is_user_made(class_) and not is_given(class_, name):
            continue
        if isinstance(class_, type) and is_record(class_) and not is_class:
            return raw(state.settings.door, state, of_subject, vars(class_)[name], subject)
        members = class_.methods if isinstance(class_, ScenicClass) else vars(class_) if is_user_made(class_) else {}
        if name in members:
            inner = plain(subject)
            own = inner.class_ if isinstance(inner, Instance) else inner if is_class else type(inner)
            return member_of(members[name], None if is_class else subject, own, state)
        if isinstance(class_, type) and is_user_made(subject) and not is_class and not is_user_made(class_) and may_ask(class_, name):
            return method_of_python(class_, name, subject, state)
    if name == "__init__":
        return NOTHING_TO_DO
    raise HostException(AttributeError(f"super() has no attribute {name}"))


def method_of_python(class_: type, name: str, subject: object, state: State) -> object:
    """`super().name` where it is of a Python class below which the class of the program stands."""
    ours = method_of(class_, name, state.settings.door.budget)
    if isinstance(ours, Bound):  # which takes the subject first
        return replace(ours, subject=(subject,))
    found: Any = next((vars(c)[name] for c in class_.__mro__ if name in vars(c)), MISSING)
    if found is MISSING:
        raise HostException(AttributeError(f"super() has no attribute {name}"))
    return raw(state.settings.door, state, of_subject, found, subject)


def of_subject(found: Any, subject: object) -> object:
    """What stands in a class, as its instance sees it."""
    return found.__get__(subject, type(subject)) if hasattr(found, "__get__") else found
