"""A pseudo-terminal with a receiver built from the exported C at its other end."""

import os
import pty
import random
import select
import subprocess
import threading
import tty
from pathlib import Path


class Line:
    """A pseudo-terminal with the receiver at its other end; loses or changes bytes where asked to."""

    def __init__(self, command: list[str], cwd: Path, spoilt: float = 0.0):
        self.master, self.slave = pty.openpty()
        tty.setraw(self.slave)
        self.name = os.ttyname(self.slave)
        self.random, self.spoilt = random.Random(3), spoilt
        self.process = subprocess.Popen(
            command, cwd=cwd, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, bufsize=0
        )
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        pairs = [(self.master, self.process.stdin.fileno()), (self.process.stdout.fileno(), self.master)]
        self.done = False
        self.threads = [threading.Thread(target=self._relay, args=pair, daemon=True) for pair in pairs]
        for thread in self.threads:
            thread.start()

    def _relay(self, source: int, sink: int) -> None:
        while not self.done:
            if not select.select([source], [], [], 0.05)[0]:
                continue
            data = os.read(source, 4096)
            if not data:
                return
            os.write(sink, b"".join(self._through(byte) for byte in data))

    def _through(self, byte: int) -> bytes:
        if self.random.random() >= self.spoilt:
            return bytes([byte])
        return self.random.choice([b"", bytes([byte ^ self.random.randint(1, 255)]), bytes([byte, byte])])

    def end(self) -> list[tuple[int, list[float]]]:
        """Hang up; the movements that the receiver told."""
        self.done = True
        for thread in self.threads:
            thread.join()
        assert self.process.stdin is not None
        self.process.stdin.close()
        assert self.process.stderr is not None
        told = self.process.stderr.read().decode().splitlines()
        self.process.wait(10)
        for stream in (self.process.stdout, self.process.stderr):
            if stream is not None:
                stream.close()
        os.close(self.master)
        os.close(self.slave)
        moves = [line.split()[1:] for line in told if line.startswith("move")]
        return [(int(words[0]), [float(word) for word in words[1:]]) for words in moves]
