"""The `vr` command: one thin file per command over the library."""
