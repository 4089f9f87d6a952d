"""Editor support by the Language Server Protocol: diagnostics, hover, completion and definitions while a
program is being typed.

The process that speaks to the editor only reads the words of programs; whatever parses or runs them is a
process of its own (`worker`).
"""
