"""One program here and in another implementation: whether it means the same, and which reading explains a difference."""
