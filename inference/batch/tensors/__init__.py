"""The graph evaluated on tensors, by torch: on the processor or a GPU, and with gradients."""
