"""`python -m scenic_ref` is the command `scenic-ref`."""

from .cli import main

if __name__ == "__main__":
    main()
