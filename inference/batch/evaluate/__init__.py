"""The graph evaluated on columns: many scenes at a time."""
