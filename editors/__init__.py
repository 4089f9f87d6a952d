"""What editors ask about a program while it is being typed: diagnostics, hover, completion, definitions, by the Language Server Protocol.

The process that speaks to the editor only reads the words of programs; whatever parses or runs them is a process of its own (`worker`).
"""
