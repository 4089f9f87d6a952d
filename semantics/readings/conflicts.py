"""Readings where the paper contradicts itself."""

from __future__ import annotations

from .reading import Reading

CONFLICTS = tuple(Reading(id=i,kind="conflict",question="",places=(),alternatives=a,code=(),profiles=p) for i,a,p in (
 ("soft",{"run":"","scene":""},{"prose":"scene","scenic-2.1":"scene","scenic-3":"scene"}),
 ("require-time",{"statement":"","end":""},{"prose":"end","scenic-2.1":"end","scenic-3":"end"}),
 ("offset-by",{"local":"","global":""},{"formal":"global"}),
 ("point-size",{"zero":"","error":""},{"formal":"error"}),
 ("oriented-offset",{"local":"","global":""},{}),
 ("resample-constant",{"point-mass":"","error":""},{}),
))
