"""The semantics of the language. Pure: no random source, no input or output, no clock, no mutable module
state.
"""
