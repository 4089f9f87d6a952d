"""What the language means. Pure: no random source, no input or output, no clock, no mutable module state."""
