"""Consistent overhead byte stuffing: any bytes written without a zero, so that zero ends a frame.

Cheshire and Baker, "Consistent overhead byte stuffing", IEEE/ACM Transactions on Networking 7(2), 1999.
Costs one byte, and one more in every 254.
"""

__all__ = ["MALFORMED", "cobs_decode", "cobs_encode"]

LONGEST = 254
"""Bytes that one code byte can stand before; 0xFF means so many and no zero after them."""

MALFORMED = None
"""What `cobs_decode` answers with where the bytes are no encoding of anything."""


def cobs_encode(data: bytes) -> bytes:
    """`data` as bytes none of which is zero."""
    out = bytearray()
    blocks = data.split(b"\0")
    for i, block in enumerate(blocks):
        start = 0
        while len(block) - start >= LONGEST:
            out.append(LONGEST + 1)
            out += block[start : start + LONGEST]
            start += LONGEST
        # A full block at the very end needs no code after it: there is no zero to stand for.
        if start < len(block) or start == 0 or i + 1 < len(blocks):
            out.append(len(block) - start + 1)
            out += block[start:]
    return bytes(out)


def cobs_decode(stuffed: bytes) -> bytes | None:
    """What was encoded; `MALFORMED` (None) where a zero is inside or the last block is short."""
    out = bytearray()
    i = 0
    while i < len(stuffed):
        code = stuffed[i]
        block = stuffed[i + 1 : i + code]
        if code == 0 or len(block) != code - 1 or 0 in block:
            return MALFORMED
        out += block
        i += code
        if code <= LONGEST and i < len(stuffed):
            out.append(0)
    return bytes(out) if stuffed else MALFORMED
