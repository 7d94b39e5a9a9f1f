"""Where `vr` begins: an interrupt has its one line from the first moment, while everything else is loaded."""

import sys

__all__ = ["main"]


def main() -> None:
    """Entry point of the `vr` script and of `python -m vision_robot_cli`."""
    try:
        from vision_robot_cli.main import main

        main()
    except KeyboardInterrupt:
        print("vr: interrupted", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
