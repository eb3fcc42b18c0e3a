"""`surrogate`, `python -m surrogate`: the command, with a quiet end while it still loads."""


def main() -> None:
    """Load the command and run it; 130 when it is interrupted before it could start."""
    try:
        from surrogate.cli.verbs import main as command
    except KeyboardInterrupt:
        raise SystemExit(130) from None
    command()


if __name__ == "__main__":
    main()
