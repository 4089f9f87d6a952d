"""Members of classes of the program: what they are to an instance, to the class itself, and to `super()`."""

from __future__ import annotations

from ..kernel.allowed import is_user_made
from ..kernel.config import State
from ..kernel.host import HostException, raw
from ..kernel.scenic_classes import Above, ScenicClass
from ..kernel.values import Function, Instance, Method, Native, plain


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
"""The `__init__` of a class that has none of the program: what there is to do is done when the instance is made."""


def attribute_above(above: Above, name: str, state: State) -> object:
    """`super().name`: that of the first class behind the one of the method that has it."""
    subject = above.subject
    is_class = isinstance(subject, (type, ScenicClass))
    for class_ in above.classes:
        members = class_.methods if isinstance(class_, ScenicClass) else vars(class_) if is_user_made(class_) else {}
        if name in members:
            inner = plain(subject)
            own = inner.class_ if isinstance(inner, Instance) else inner if is_class else type(inner)
            return member_of(members[name], None if is_class else subject, own, state)
    if name == "__init__":
        return NOTHING_TO_DO
    raise HostException(AttributeError(f"super() has no attribute {name}"))
