"""The store: changes in place and their undoing; scopes, sets, generators, classes; the errors that a user
can meet.
"""
