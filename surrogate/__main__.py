"""`surrogate`, `python -m surrogate`: the command, with a quiet end while it still loads."""

import atexit
import gc

#: Objects made before cycles are looked for. Modules, runs and tables hold hundreds of thousands
#: and hardly a cycle; looking at the usual times took a sixth of a command's time.
OBJECTS = 100_000


def main() -> None:
    """Load the command and run it; 130 when it is interrupted before it could start."""
    gc.set_threshold(OBJECTS, 50, 100)
    gc.disable()  # modules hold no garbage; `verbs` looks for it again once they are loaded
    atexit.register(gc.freeze)  # nor is it looked for at the end, for half a second
    try:
        from surrogate.cli.verbs import main as command
    except KeyboardInterrupt:
        raise SystemExit(130) from None
    command()


if __name__ == "__main__":
    main()
