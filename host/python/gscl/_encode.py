"""Encoding."""

from __future__ import annotations

import builtins
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, Union, overload

from gscl._binding import ffi, lib
from gscl._devices import context_on
from gscl._errors import ConflictError, InvalidArgumentError, assign, check, set_target
from gscl._images import Picture, Source, load, to_struct
from gscl._names import BLENDS, BLOCKS, LOSSES, PRESETS, PROFILES, TUNES
from gscl._names import Blend, Effect, Loss, Preset, Profile, Tune
from gscl._names import bits_of, effects_of, number_of, word_of
from gscl._packets import split
from gscl._progress import ProgressCallback, call, interruptible
from gscl._records import Record, Reported


@dataclass(frozen=True, eq=False, repr=False)
class EffectDecision(Record):
    """The encoder's decision on an effect."""

    effect: str
    on: bool
    reason: str
    """"requested", "content", "profile", "trial" or "passes"."""
    gain_db: float
    """For "trial": PSNR with the effect less PSNR without it; else NaN."""


@dataclass(frozen=True, eq=False, repr=False)
class Stage(Record):
    """Time of one stage of an encode."""

    name: str
    count: int
    seconds: float


@dataclass(frozen=True, eq=False, repr=False)
class TracePoint(Record):
    """State of the fit at one moment of an encode."""

    stage: str
    steps: int
    splats: int
    seconds: float
    psnr: float


@dataclass(frozen=True, eq=False, repr=False)
class EncodeReport(Record):
    """Results of an encode."""

    bytes: int
    """Of the file; of packets their sum, without what a list adds."""
    splats: int
    psnr: float
    """dB of the decoded file against the picture."""
    ssimulacra2: float
    """SSIMULACRA 2 of the decoded file against the picture, where it is the target; else NaN."""
    seconds: float
    trials: int
    """Complete fits until the target was met."""
    blend: str
    tune: str
    effects: tuple[EffectDecision, ...] = field(repr=False)
    stages: tuple[Stage, ...] = field(repr=False)
    trace: tuple[TracePoint, ...] = field(repr=False)
    """Empty unless the argument `trace` asks for it."""


class Encoded(Reported[EncodeReport]):
    """What encode returns: the bytes of the file, with a report."""


class EncodedPackets(Encoded):
    """What encode returns with the argument `packets`: the bytes of a list of packets, as a .gsclp file has it, with a
    report."""

    @property
    def packets(self) -> list[bytes]:
        """The packets, to send one by one."""
        return split(self)


Metadata = Union[bytes, bool, None]
"""Bytes to store; True for those that the picture came with; None or False for none."""


@overload
def encode(
    picture: Picture,
    *,
    preset: Preset | None = None,
    bytes: int | None = None,
    bpp: float | None = None,
    psnr: float | None = None,
    ssimulacra2: float | None = None,
    quality: float | None = None,
    splats: int | None = None,
    effort: int | None = None,
    tune: Tune = "auto",
    profile: Profile = "default",
    blend: Blend = "auto",
    loss: Loss = "auto",
    codebook_size: int = 0,
    effects_on: Iterable[Effect] = (),
    effects_off: Iterable[Effect] = (),
    step_factor: float = 0.0,
    seed: int = 1,
    premultiplied: bool = False,
    progressive: bool = False,
    bare: bool = False,
    packets: None = None,
    icc_profile: Metadata = None,
    exif: Metadata = None,
    xmp: Metadata = None,
    cicp: tuple[int, int] | None = None,
    trace: bool = False,
    progress: ProgressCallback | None = None,
    device: str | None = None,
    threads: int = 0,
) -> Encoded: ...


@overload
def encode(
    picture: Picture,
    *,
    packets: int,
    packet_count: int = 0,
    packet_loss: float = 0.0,
    packet_identity: int = 0,
    preset: Preset | None = None,
    bytes: int | None = None,
    bpp: float | None = None,
    effort: int | None = None,
    tune: Tune = "auto",
    blend: Blend = "auto",
    loss: Loss = "auto",
    effects_on: Iterable[Effect] = (),
    effects_off: Iterable[Effect] = (),
    step_factor: float = 0.0,
    seed: int = 1,
    premultiplied: bool = False,
    trace: bool = False,
    progress: ProgressCallback | None = None,
    device: str | None = None,
    threads: int = 0,
) -> EncodedPackets: ...


def encode(
    picture: Picture,
    *,
    preset: Preset | None = None,
    bytes: int | None = None,
    bpp: float | None = None,
    psnr: float | None = None,
    ssimulacra2: float | None = None,
    quality: float | None = None,
    splats: int | None = None,
    effort: int | None = None,
    tune: Tune = "auto",
    profile: Profile = "default",
    blend: Blend = "auto",
    loss: Loss = "auto",
    codebook_size: int = 0,
    effects_on: Iterable[Effect] = (),
    effects_off: Iterable[Effect] = (),
    step_factor: float = 0.0,
    seed: int = 1,
    premultiplied: bool = False,
    progressive: bool = False,
    bare: bool = False,
    packets: int | None = None,
    packet_count: int = 0,
    packet_loss: float = 0.0,
    packet_identity: int = 0,
    icc_profile: Metadata = None,
    exif: Metadata = None,
    xmp: Metadata = None,
    cicp: tuple[int, int] | None = None,
    trace: bool = False,
    progress: ProgressCallback | None = None,
    device: str | None = None,
    threads: int = 0,
) -> Encoded | EncodedPackets:
    """Encodes a picture, and returns the bytes of a gscl file with a report: `encoded.report.psnr`.

    picture: a path to a file that Pillow reads; such a file that is open in binary mode, read from its start, or from where it
        stands if it cannot seek; an image of Pillow; or an array of shape (height, width) or (height, width, channels): grey,
        grey and alpha, RGB or RGBA, of uint8, uint16 or floating point (0..1), gamma-encoded.  Files and images are turned
        upright and converted to sRGB by their profile.
    preset: a target and an effort by what the file is for: "tiny", a placeholder of at most 250 bytes (effort 3); "preview",
        0.06 bits per pixel, or 256 bytes if that is more (effort 3); "small", the defaults; "good", a quality of 50.  An
        `effort` beside it counts.
    bytes, bpp, psnr, ssimulacra2, quality, splats: the target, at most one, and without `preset`: bytes or bits per pixel of
        the whole file, never exceeded; dB, exceeded by at most 0.3; SSIMULACRA 2 from -100 to 100, mostly exceeded by less than 1, for pictures with
        sides of at least 8 pixels; quality as of JPEG, 0 to 100, which is a SSIMULACRA 2 (the best file where it cannot be
        reached); number of splats.  Without one: 0.125 bits per pixel, or 256 bytes if that is more.
    effort: 0 (fastest) to 9 (best).  Without it: 5, or that of `preset`.
    tune: what is maximised: "psnr", "ssim" (MS-SSIM) or "visual" (what people see).  "auto" is "psnr" for files below 600
        bytes unless `ssimulacra2` or `quality` is the target, where `psnr` is the target, and for pictures with transparent parts or
        above 16 megapixels, else "visual".
    profile, blend, loss, codebook_size, effects_on, effects_off, step_factor, seed: gscl_encode_settings in gscl/gscl.h
        explains them.
    premultiplied: whether colours of the picture are multiplied by alpha.
    progressive: whether to write layers, so that the first part of the file draws a better picture.
    bare: whether to write the picture alone, without magic bytes, version, metadata and check.
    packets: writes packets of at most so many bytes, 40 to 1400, in place of a file: parts of the picture of which each draws by
        itself.  Targets are `bytes` or `bpp` of all of them together, or their number.
    packet_count: 1 to 256 packets; 0 for as many as the target needs.
    packet_loss: share of packets that are expected to be lost, 0 to 0.9: some become repair packets, of which each replaces any
        other that is lost.
    packet_identity: number of the picture in its packets, 1 to 255 without 199; 0 for one that follows from the picture.
    icc_profile, exif, xmp: metadata to store: bytes, or True for those of the picture.  With a profile, colours are not
        converted.
    cicp: code points of primaries and transfer function (ITU-T H.273) to store.  Colours are not converted.
    trace: whether the report has the convergence trace.
    progress: called several times a second; returns False to cancel, which raises CancelledError.
    device: "host", this processor; "P.D" or a part of the name of an OpenCL device; None for the default: a GPU, else the first
        accelerator, else "host".
    threads: of the device "host"; 0 for as many as the process may run, which encodes that run at the same time share.  The
        file does not depend on it.

    Raises a subclass of gscl.Error; for files that Pillow does not open, OSError.  The interpreter's lock is released
    while the library works.  An interrupt (Ctrl-C) in the main thread stops the encode with KeyboardInterrupt.
    """
    settings = ffi.new("gscl_encode_settings *")
    lib.gscl_encode_settings_init(settings, ffi.sizeof("gscl_encode_settings"))
    targets = {
        lib.GSCL_TARGET_BYTES: ("bytes", bytes),
        lib.GSCL_TARGET_BPP: ("bpp", bpp),
        lib.GSCL_TARGET_PSNR: ("psnr", psnr),
        lib.GSCL_TARGET_SSIMULACRA2: ("ssimulacra2", ssimulacra2),
        lib.GSCL_TARGET_QUALITY: ("quality", quality),
        lib.GSCL_TARGET_SPLATS: ("splats", splats),
    }
    set_target(settings, targets)
    if preset is not None:
        _set_preset(settings, preset, targets.values())
    settings.tune = number_of("tune", TUNES, tune)
    settings.profile = number_of("profile", PROFILES, profile)
    settings.blend = number_of("blend", BLENDS, blend)
    settings.loss = number_of("loss", LOSSES, loss)
    settings.effects_on = bits_of("effects_on", effects_on)
    settings.effects_off = bits_of("effects_off", effects_off)
    settings.step_factor = step_factor
    settings.packet_loss = packet_loss
    settings.progressive, settings.bare, settings.trace = progressive, bare, trace
    numbers = {"codebook_size": codebook_size, "seed": seed}
    if effort is not None:
        numbers["effort"] = effort
    numbers |= {"packet_count": packet_count, "packet_identity": packet_identity}
    for name, value in numbers.items():
        assign(settings, name, value)
    if packets is not None:
        _set_packet_size(settings, packets)

    given = cicp is not None or isinstance(icc_profile, builtins.bytes)
    source = load(picture, "given" if given else "own" if icc_profile else "none")
    if icc_profile is True and cicp is None:
        cicp = source.metadata.get("cicp")
    blocks = _blocks(source, {"icc_profile": icc_profile, "exif": exif, "xmp": xmp}, cicp)
    settings.blocks = blocks[0][0] if blocks else ffi.NULL
    image, owner = to_struct(source.samples)
    image.premultiplied = premultiplied

    def work(progress: ProgressCallback | None) -> Encoded:
        with context_on(device, threads) as context:
            encoded = _run(context, image, settings, progress)
        _keep(owner, blocks)  # which the library read until here
        return encoded

    encoded = interruptible(work, progress)
    return encoded if packets is None else EncodedPackets(encoded, encoded.report)


def _keep(*owners: Any) -> None:
    """Keeps memory until here."""


def _set_preset(settings: Any, preset: Preset, targets: Iterable[tuple[str, float | None]]) -> None:
    given = [name for name, value in targets if value is not None]
    if given:
        raise ConflictError(f"more than one target: preset, {', '.join(given)}")
    check(lib.gscl_encode_settings_preset(settings, number_of("preset", PRESETS, preset)))


def _set_packet_size(settings: Any, size: int) -> None:
    """The default of the library, 0, is a file."""
    if size < lib.GSCL_MIN_PACKET_SIZE:
        raise InvalidArgumentError(f"packets: {size} bytes: expected at least {lib.GSCL_MIN_PACKET_SIZE}")
    assign(settings, "packet_size", size, "packets")


def _blocks(source: Source, wanted: dict[str, Metadata], cicp: tuple[int, int] | None) -> list[tuple[Any, Any]]:
    """A linked list of blocks to store, from the first to the last, each with the owner of its data."""
    contents = {}
    if cicp is not None:
        try:
            contents[lib.GSCL_BLOCK_COLOUR_SPACE] = bytes(cicp)
        except ValueError:
            raise InvalidArgumentError(f"cicp: {cicp}: expected two numbers in 0..255") from None
    for name, value in wanted.items():
        data = source.metadata.get(name) if value is True else value
        if data:
            contents[BLOCKS[name]] = data.removeprefix(b"Exif\0\0")
    blocks = []
    following = ffi.NULL
    for kind, data in contents.items():
        owner = ffi.from_buffer(data)
        following = ffi.new("gscl_block *", {"next": following, "type": kind, "data": owner, "size": len(data)})
        blocks.append((following, owner))
    return blocks[::-1]


def _run(context: Any, image: Any, settings: Any, progress: ProgressCallback | None) -> Encoded:
    report = ffi.new("gscl_encode_report *", {"struct_size": ffi.sizeof("gscl_encode_report")})
    data, size = ffi.new("uint8_t **"), ffi.new("size_t *")
    try:
        check(call(settings, progress, lambda: lib.gscl_encode(context, image, settings, data, size, report)), context)
        return Encoded(ffi.buffer(data[0], size[0]), _report(report))
    finally:
        lib.gscl_free(data[0])


def _word(text: Any) -> str:
    return str(ffi.string(text).decode())


def _report(report: Any) -> EncodeReport:
    return EncodeReport(
        bytes=report.bytes,
        splats=report.splats,
        psnr=report.psnr,
        ssimulacra2=report.ssimulacra2,
        seconds=report.seconds,
        trials=report.trials,
        blend=word_of(BLENDS, report.blend),
        tune=word_of(TUNES, report.tune),
        effects=tuple(_decision(report.effects[i]) for i in range(report.effect_count)),
        stages=tuple(_stage(report.stages[i]) for i in range(report.stage_count)),
        trace=tuple(_trace_point(report.trace[i]) for i in range(report.trace_count)),
    )


def _decision(row: Any) -> EffectDecision:
    reason = lib.gscl_effect_reason_name(row.reason)
    return EffectDecision(", ".join(effects_of(row.effect)), row.on, _word(reason) if reason else "", row.gain_db)


def _stage(row: Any) -> Stage:
    return Stage(_word(row.name), row.count, row.seconds)


def _trace_point(row: Any) -> TracePoint:
    return TracePoint(_word(row.stage), row.steps, row.splats, row.seconds, row.psnr)
