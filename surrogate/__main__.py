"""`python -m surrogate`: the command."""

from surrogate.cli import main

if __name__ == "__main__":
    main()
