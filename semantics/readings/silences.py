"""Readings where the formal rules are silent."""

from __future__ import annotations

from .reading import Reading

SILENCES = tuple(Reading(id=i,kind="silence",question="",places=(),alternatives=a,code=(),profiles=p) for i,a,p in (
 ("optional-unknown",{"extend":"","ignore":""},{"scenic-2.1":"ignore"}),
))
