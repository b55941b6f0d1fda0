"""Pictures that come piece by piece: by packets, or by the bytes of a file."""

from __future__ import annotations

import threading
from typing import Any

from numpy.typing import DTypeLike, NDArray

from gscl._binding import ffi, lib
from gscl._decode import decode
from gscl._errors import check
from gscl._packets import Buffer
from gscl._progress import ProgressCallback


class Decoder:
    """Takes a picture as it comes, by packets or by the bytes of a file, and draws what is there at any time.

        decoder = gscl.Decoder()
        while not done:
            if decoder.add(socket.recv(1400)):
                show(decoder.image())

    Several threads may use one decoder.
    """

    def __init__(self, *, bare: bool = False) -> None:
        """bare: whether the file was encoded with `bare`, which its bytes do not tell."""
        settings = ffi.new("gscl_decode_settings *")
        lib.gscl_decode_settings_init(settings, ffi.sizeof("gscl_decode_settings"))
        settings.bare = bare
        decoder = ffi.new("gscl_decoder **")
        check(lib.gscl_decoder_create(decoder, settings))
        self._decoder = ffi.gc(decoder[0], lambda pointer: lib.gscl_decoder_free(ffi.new("gscl_decoder **", pointer)))
        self._bare = bare
        self._lock = threading.Lock()
        self._packets: list[bytes] = []  # that have come, each once
        self._file = bytearray()

    def add(self, packet: Buffer) -> bool:
        """Adds a packet, and returns whether it is new.  What is no packet of this picture changes nothing, and raises a
        subclass of FileError: OtherPictureError, or DamagedError and others for what is no packet at all."""
        content = ffi.from_buffer("uint8_t[]", packet)
        with self._lock:
            check(lib.gscl_decoder_add_packet(self._decoder, content, len(content)))
            is_new = bool(self._state().received > len(self._packets))
            if is_new:
                self._packets.append(bytes(packet))
            return is_new

    def add_bytes(self, data: Buffer) -> None:
        """Adds the next bytes of a file.  They are looked at when the picture is drawn.  Raises InvalidArgumentError for a
        decoder that has packets."""
        content = ffi.from_buffer("uint8_t[]", data)
        with self._lock:
            check(lib.gscl_decoder_add_bytes(self._decoder, content, len(content)))
            self._file += data

    def image(
        self,
        *,
        size: tuple[int, int] | None = None,
        crop: tuple[int, int, int, int] | None = None,
        dtype: DTypeLike | None = None,
        out: NDArray[Any] | None = None,
        premultiplied: bool = False,
        max_pixels: int | None = None,
        max_work: int | None = None,
        progress: ProgressCallback | None = None,
        device: str | None = None,
        threads: int = 0,
    ) -> NDArray[Any]:
        """Draws what has come, with the arguments, the result and the errors of `decode`; TruncatedError before there is
        anything to draw."""
        with self._lock:
            source = list(self._packets) or bytes(self._file)
        if not source:
            check(lib.GSCL_ERROR_TRUNCATED)
        return decode(
            source,
            size=size,
            crop=crop,
            dtype=dtype,
            out=out,
            premultiplied=premultiplied,
            partial=True,
            bare=self._bare,
            max_pixels=max_pixels,
            max_work=max_work,
            progress=progress,
            device=device,
            threads=threads,
        )

    @property
    def size(self) -> tuple[int, int] | None:
        """Encoded width and height in pixels; None before a packet with splats or the header of a file has come."""
        with self._lock:
            state = self._state()
        return (state.width, state.height) if state.width else None

    @property
    def splats(self) -> int:
        """How many splats can be drawn."""
        with self._lock:
            return int(self._state().splats)

    @property
    def packets(self) -> int:
        """How many packets with splats the picture has; 0 for a file, and before one of them has come."""
        with self._lock:
            return int(self._state().packets)

    @property
    def drawn(self) -> int:
        """How many of `packets` can be drawn; with repair packets it may be more than have come."""
        with self._lock:
            return int(self._state().drawn)

    @property
    def received(self) -> int:
        """How many packets have come, repair packets included, each counted once."""
        with self._lock:
            return int(self._state().received)

    def _state(self) -> Any:
        """All zero before there is anything to draw.  Raises a subclass of FileError for a file that is none."""
        state = ffi.new("gscl_decoder_state *", {"struct_size": ffi.sizeof("gscl_decoder_state")})
        result = lib.gscl_decoder_inspect(self._decoder, state)
        if result != lib.GSCL_ERROR_TRUNCATED:
            check(result)
        return state
