"""The parts of the file format (format/FORMAT.md) that forged headers need."""
import struct


def crc24(data):
    crc = 0xB704CE
    for byte in data:
        crc ^= byte << 16
        for _ in range(8):
            crc <<= 1
            if crc & 0x1000000:
                crc ^= 0x1864CFB
    return crc


def varint(value):
    data = b""
    while value >= 0x80:
        data += bytes([value & 0x7F | 0x80])
        value >>= 7
    return data + bytes([value])


def forged(width, height, splats, payload=b"", flags=0, version=1):
    """A file with a valid checksum and any header."""
    header = b"gsc" + struct.pack("<BH", version, flags) + varint(width - 1) + varint(height - 1) + varint(splats)
    return header + crc24(header + payload).to_bytes(3, "big") + payload
