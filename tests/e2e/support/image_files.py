"""Readers of the two picture formats the daemon writes, small and strict.

They check structure, not only a magic number: PNG chunk CRCs and the size of the inflated
rows, EXR offsets and every scan line chunk. Only what the daemon writes is understood.
"""

import struct
import zlib
from dataclasses import dataclass

import numpy as np

_EXR_CODECS = {0: ("none", 1), 2: ("zips", 1), 3: ("zip", 16)}
_EXR_TYPES = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}


@dataclass
class Picture:
    """Pixels in rows from the top, shape (height, width, channels); metadata by name."""

    width: int
    height: int
    channels: list
    pixels: np.ndarray
    metadata: dict


def read_png(data: bytes) -> Picture:
    assert data[:8] == b"\x89PNG\r\n\x1a\n", "not a PNG"
    position, header, packed, ended = 8, None, b"", False
    while position < len(data):
        length, kind = struct.unpack(">I4s", data[position : position + 8])
        body = data[position + 8 : position + 8 + length]
        (crc,) = struct.unpack(">I", data[position + 8 + length : position + 12 + length])
        assert zlib.crc32(kind + body) == crc, f"bad CRC in {kind!r}"
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        elif kind == b"IEND":
            ended = True
        position += 12 + length
    assert header and ended, "truncated PNG"
    width, height, depth, color, _, _, interlace = header
    assert (depth, interlace) == (8, 0) and color in (2, 6), f"unexpected PNG kind {header}"
    count = 3 if color == 2 else 4
    pixels = _unfilter_png(zlib.decompress(packed), width, height, count)
    return Picture(width, height, list("RGBA")[:count], pixels, {})


def _unfilter_png(raw: bytes, width: int, height: int, count: int) -> np.ndarray:
    stride = width * count
    assert len(raw) == height * (stride + 1), "PNG rows have the wrong length"
    rows = np.frombuffer(raw, np.uint8).reshape(height, stride + 1)
    result = np.zeros((height, stride), np.uint8)
    above = np.zeros(stride, np.uint8)
    for y in range(height):
        result[y] = above = _unfilter_row(int(rows[y, 0]), rows[y, 1:], above, count)
    return result.reshape(height, width, count)


def _unfilter_row(kind: int, row: np.ndarray, above: np.ndarray, count: int) -> np.ndarray:
    if kind == 0:
        return row.copy()
    if kind == 2:
        return row + above
    out, line, up = bytearray(len(row)), row.tobytes(), above.tobytes()
    for i, value in enumerate(line):
        left = out[i - count] if i >= count else 0
        corner = up[i - count] if i >= count else 0
        if kind == 1:
            guess = left
        elif kind == 3:
            guess = (left + up[i]) // 2
        else:
            guess = _paeth(left, up[i], corner)
        out[i] = (value + guess) & 255
    return np.frombuffer(bytes(out), np.uint8)


def _paeth(left: int, up: int, corner: int) -> int:
    estimate = left + up - corner
    distances = (abs(estimate - left), abs(estimate - up), abs(estimate - corner))
    return (left, up, corner)[distances.index(min(distances))]


def read_exr(data: bytes, every: bool = False) -> Picture:
    """R, G and B where they are there, unless every channel is asked for."""
    assert data[:4] == b"\x76\x2f\x31\x01", "not an EXR"
    assert struct.unpack("<I", data[4:8])[0] == 2, "only single-part scan line EXR is expected"
    attributes, position = _exr_attributes(data)
    channels = _exr_channels(attributes["channels"][1])
    codec, lines = _EXR_CODECS[attributes["compression"][1][0]]
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"][1])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    chunks = (height + lines - 1) // lines
    offsets = struct.unpack(f"<{chunks}Q", data[position : position + 8 * chunks])
    pixels = np.zeros((height, width, len(channels)), np.float64)
    for offset in offsets:
        y, size = struct.unpack("<iI", data[offset : offset + 8])
        body = data[offset + 8 : offset + 8 + size]
        assert len(body) == size, "truncated EXR chunk"
        _exr_chunk(pixels, y - y0, min(lines, height - (y - y0)), body, codec, channels)
    names = [name for name, _ in channels]
    order = [names.index(c) for c in "RGB" if c in names] if "R" in names and not every else range(len(names))
    metadata = {name: _exr_value(*value) for name, value in attributes.items()}
    return Picture(width, height, [names[i] for i in order], pixels[:, :, list(order)], metadata)


def _exr_attributes(data: bytes):
    attributes, position = {}, 8
    while data[position] != 0:
        end = data.index(b"\0", position)
        name = data[position:end].decode()
        end_of_type = data.index(b"\0", end + 1)
        kind = data[end + 1 : end_of_type].decode()
        (size,) = struct.unpack("<I", data[end_of_type + 1 : end_of_type + 5])
        attributes[name] = (kind, data[end_of_type + 5 : end_of_type + 5 + size])
        position = end_of_type + 5 + size
    return attributes, position + 1


def _exr_channels(body: bytes):
    channels, position = [], 0
    while body[position] != 0:
        end = body.index(b"\0", position)
        (kind,) = struct.unpack("<i", body[end + 1 : end + 5])
        channels.append((body[position:end].decode(), _EXR_TYPES[kind]))
        position = end + 17
    return channels


def _exr_chunk(pixels, first, count, body, codec, channels):
    width = pixels.shape[1]
    expected = count * width * sum(kind.itemsize for _, kind in channels)
    raw = body if codec == "none" or len(body) == expected else _exr_inflate(body)
    assert len(raw) == expected, "EXR chunk inflates to the wrong length"
    position = 0
    for row in range(first, first + count):
        for index, (_, kind) in enumerate(channels):
            line = np.frombuffer(raw, kind, width, position)
            pixels[row, :, index] = line
            position += width * kind.itemsize


def _exr_inflate(body: bytes) -> bytes:
    """Undoes OpenEXR's ZIP: deflate over differences of the even bytes, then the odd ones."""
    deltas = np.frombuffer(zlib.decompress(body), np.uint8).astype(np.int64)
    deltas[1:] -= 128
    split = np.cumsum(deltas).astype(np.uint8)
    result = np.empty_like(split)
    half = (len(split) + 1) // 2
    result[0::2], result[1::2] = split[:half], split[half:]
    return result.tobytes()


def _exr_value(kind: str, body: bytes):
    if kind == "string":
        return body.decode()
    if kind in ("int", "float", "double"):
        return struct.unpack({"int": "<i", "float": "<f", "double": "<d"}[kind], body)[0]
    return body
