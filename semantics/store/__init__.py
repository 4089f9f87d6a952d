"""What the machine changes in place, and how that is taken back; scopes, sets, generators, classes; the errors that a user can meet."""
