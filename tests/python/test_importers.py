"""Fields of other programs and of tables: gscl.fields."""

import io
import math
import os
import pickle
import subprocess
import sys
import types

import numpy
import pytest

import gscl
import other_renderers
from conftest import make_picture

SIZE = (112, 80)
COUNT = 120
GSCL = os.environ.get("GSCL", "")


def rows(*ranges):
    return numpy.stack([RANDOM.uniform(least, most, COUNT) for least, most in ranges], -1)


def colours(spread=0.12):
    return RANDOM.normal(0.12, spread, (COUNT, 3))


RANDOM = numpy.random.default_rng(0)
ONES = numpy.ones((COUNT, 1))
PLACES = numpy.arctanh(rows((-0.99, 0.99), (-0.99, 0.99)))
CHOLESKY = {"_xyz": PLACES, "_cholesky": rows((3, 7), (-3, 3), (3, 7)), "_features_dc": colours(), "_opacity": ONES}
TURNED = {"_xyz": PLACES, "_scaling": rows((1, 8), (1, 8)), "_rotation": rows((-4, 4)), "_features_dc": colours(), "_opacity": ONES}
VARIANCES = rows((4, 50), (-0.9, 0.9), (4, 50))
VARIANCES[:, 1] *= numpy.sqrt(VARIANCES[:, 0] * VARIANCES[:, 2])
PLUS = {
    "gs": {"_xyz": rows((0, SIZE[0]), (0, SIZE[1])), "_cov2d": VARIANCES - (2, 0, 2), "_features_dc": colours(), "_opacity": ONES},
    "slv_bound": numpy.tile([2.0, 0, 2], (COUNT, 1)),
}
IMAGE_GS = {"state_dict": {"xy": rows((0, 1), (0, 1)), "scale": 1 / rows((3, 8), (3, 8)), "rot": rows((-2, 2))}}
IMAGE_GS["state_dict"]["feat"] = 0.1 + 0.5 * IMAGE_GS["state_dict"]["xy"][:, [0, 1, 0]] + colours()
WEAK = {"state_dict": {**IMAGE_GS["state_dict"], "feat": colours(0.05)}}
FIELDS = {
    "GaussianImage, Cholesky": (CHOLESKY, gscl.fields.load_gaussianimage, other_renderers.gaussianimage, {}),
    "GaussianImage, RS": (TURNED, gscl.fields.load_gaussianimage, other_renderers.gaussianimage, {}),
    "GaussianImage++": (PLUS, gscl.fields.load_gaussianimage_plus, other_renderers.gaussianimage_plus, {}),
    "Image-GS": (IMAGE_GS, gscl.fields.load_image_gs, other_renderers.image_gs, {}),
    "Image-GS, a sum": (WEAK, gscl.fields.load_image_gs, other_renderers.image_gs, {"topk_norm": False}),
}


def difference(a, b):
    """PSNR of pictures in 0..1, dB."""
    return -10 * math.log10(numpy.mean((a - b) ** 2))


@pytest.mark.parametrize("name", FIELDS)
def test_fields_are_drawn_as_their_programs_draw_them(name):
    checkpoint, load, draw, options = FIELDS[name]
    packed = gscl.pack(load(checkpoint, size=SIZE, **options))
    assert packed.report.changed <= 1 and packed.report.outside == 0
    assert difference(gscl.decode(packed, dtype=float), draw(checkpoint, SIZE, **options)) > 40


def test_colours_of_gaussianimage_plus_may_be_normalized():
    colour = numpy.log(0.1 + rows((0, 0.1), (0, 0.1), (0, 0.1)))  # of which the sigmoid is about 0.1
    checkpoint = {**PLUS, "gs": {**PLUS["gs"], "_features_dc": colour}}
    packed = gscl.pack(gscl.fields.load_gaussianimage_plus(checkpoint, size=SIZE, color_norm=True))
    drawn = other_renderers.gaussianimage_plus(checkpoint, SIZE, color_norm=True)
    assert difference(gscl.decode(packed, dtype=float), drawn) > 40


def test_a_fitted_field_is_drawn_as_its_program_draws_it():
    """The colours of some places and shapes that are nearest to a picture."""
    picture = make_picture(*SIZE, dtype=float)
    units = []
    for i in range(COUNT):
        colour = numpy.zeros((COUNT, 3))
        colour[i] = 1
        units.append(other_renderers.gaussianimage({**CHOLESKY, "_features_dc": colour}, SIZE)[:, :, 0].ravel())
    matrix = numpy.array(units).T
    fitted = numpy.linalg.solve(matrix.T @ matrix + 0.5 * numpy.eye(COUNT), matrix.T @ picture.reshape(-1, 3))
    checkpoint = {**CHOLESKY, "_features_dc": fitted}
    own = other_renderers.gaussianimage(checkpoint, SIZE)
    assert difference(own, picture) > 15
    packed = gscl.pack(gscl.fields.load_gaussianimage(checkpoint, size=SIZE), reference=own.astype(numpy.float32))
    assert packed.report.field_psnr > 45  # before its splats have codes, whose errors add up where colours cancel each other
    assert difference(gscl.decode(packed, dtype=float), own) > 35


def test_errors_of_checkpoints():
    def refused(message, load, checkpoint):
        with pytest.raises(gscl.InvalidArgumentError, match=message):
            load(checkpoint, size=SIZE)

    fields = gscl.fields
    refused("has no _xyz: it is not of GaussianImage", fields.load_gaussianimage, IMAGE_GS)
    refused("has no xy: it is not of Image-GS", fields.load_image_gs, {"scale": TURNED["_scaling"], "feat": ONES})
    refused("is of train_quantize.py", fields.load_gaussianimage, {**CHOLESKY, "cholesky_quantizer.scale": ONES})
    refused(r"_cholesky of the checkpoint: shape \(120, 2\)", fields.load_gaussianimage, {**CHOLESKY, "_cholesky": rows((1, 2), (1, 2))})
    textures = {**IMAGE_GS["state_dict"], "feat": numpy.ones((COUNT, 7))}
    refused("feat has 7 columns", fields.load_image_gs, {"state_dict": textures})


def test_pytorch_is_named_where_it_is_missing(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(ImportError, match=r"pip install 'gscl\[torch\]'"):
        gscl.fields.load_gaussianimage(tmp_path / "gaussian_model.pth.tar", size=SIZE)
    with pytest.raises(ImportError, match="gscl.fields.tensors needs PyTorch"):
        gscl.fields.tensors(gscl.fields.load_gaussianimage(CHOLESKY, size=SIZE))


def test_checkpoints_of_pytorch_and_tensors(tmp_path):
    torch = pytest.importorskip("torch")
    path, field = tmp_path / "gaussian_model.pth.tar", gscl.fields.load_gaussianimage(CHOLESKY, size=SIZE)
    torch.save({name: torch.tensor(value) for name, value in CHOLESKY.items()}, path)
    assert numpy.array_equal(gscl.fields.load_gaussianimage(path, size=SIZE).splats, field.splats)
    path.write_bytes(b"other")
    with pytest.raises(gscl.InvalidArgumentError, match="is no checkpoint of tensors and numbers alone"):
        gscl.fields.load_gaussianimage(path, size=SIZE)
    with pytest.raises(FileNotFoundError):
        gscl.fields.load_gaussianimage(tmp_path / "missing", size=SIZE)
    with open(path, "rb") as file, pytest.raises(gscl.InvalidArgumentError, match="^/.*gaussian_model.pth.tar: is no checkpoint"):
        gscl.fields.load_gaussianimage(file, size=SIZE)
    tensors = gscl.fields.tensors(field)
    assert tuple(tensors) == gscl.SPLAT_DTYPE.names and tensors["colour"].shape == (COUNT, 4)
    assert numpy.array_equal(tensors["theta"].numpy(), field.splats["theta"])


def test_checkpoints_are_read_from_open_files(monkeypatch):
    """PyTorch, which need not be there, is replaced by what reads a pickled dictionary of arrays."""
    torch = types.SimpleNamespace(load=lambda file, *, map_location, weights_only: pickle.load(file))
    monkeypatch.setitem(sys.modules, "torch", torch)
    for checkpoint, load, _, options in FIELDS.values():
        field = load(io.BytesIO(pickle.dumps(checkpoint)), size=SIZE, **options)
        assert field == load(checkpoint, size=SIZE, **options)
    with pytest.raises(gscl.InvalidArgumentError, match="^is no checkpoint of tensors and numbers alone"):
        gscl.fields.load_image_gs(io.BytesIO(b"other"), size=SIZE)
    with pytest.raises(gscl.InvalidArgumentError, match="^holds a list: expected a dictionary"):
        gscl.fields.load_image_gs(io.BytesIO(pickle.dumps([1])), size=SIZE)


# ---- Tables ----------------------------------------------------------------------------------------


def some_files():
    for blend, channels in (("normalized", 3), ("sum", 1), ("alpha", 4)):
        yield gscl.encode(make_picture(60, 40, channels), bytes=300, effort=1, blend=blend)


def test_npz_has_all_of_a_field(tmp_path):
    for data in some_files():
        gscl.fields.save_npz(gscl.read_field(data), tmp_path / "field.npz")
        field = gscl.fields.load_npz(tmp_path / "field.npz")
        assert field.splats.tobytes() == gscl.read_field(data).splats.tobytes()
        assert gscl.pack(field) == data


def test_tables_in_open_files():
    """They are read from where they stand; errors name the files that have a name."""
    (data, *_) = some_files()
    field, memory = gscl.read_field(data), io.BytesIO()
    memory.write(b"before")
    gscl.fields.save_npz(field, memory)
    memory.seek(len(b"before"))
    assert gscl.fields.load_npz(memory) == field
    csv = b"# gscl width=60 height=40 blend=sum\nx,y,sigma1,sigma2,grey\n1,2,3,4,0.5\n"
    ply = b"ply\nformat ascii 1.0\nelement vertex 1\n" + b"".join(b"property float %s\n" % name for name in b"x y sigma1 sigma2 grey".split())
    same = gscl.fields.load_csv(io.BytesIO(csv)), gscl.fields.load_ply(io.BytesIO(ply + b"end_header\n1 2 3 4 0.5\n"), size=(60, 40), blend="sum")
    assert same[0] == same[1] and len(same[0].splats) == 1
    named = io.BytesIO(b"other")
    named.name = "place/field"
    for load, message in {
        gscl.fields.load_npz: "is no NPZ file of arrays of numbers",
        gscl.fields.load_csv: "has no column x, y",
        gscl.fields.load_ply: "is no PLY file",
    }.items():
        with pytest.raises(gscl.InvalidArgumentError, match=f"^{message}"):
            load(io.BytesIO(b"other"))
        named.seek(0)
        with pytest.raises(gscl.InvalidArgumentError, match=f"^place/field: {message}"):
            load(named)
    with pytest.raises(gscl.InvalidArgumentError, match="^is no text in UTF-8"):
        gscl.fields.load_csv(io.BytesIO(b"\xff"))
    with pytest.raises(TypeError, match="open it in binary mode"):
        gscl.fields.load_csv(io.StringIO("x"))


@pytest.mark.skipif(not os.access(GSCL, os.X_OK), reason="needs the tool in GSCL")
def test_tables_of_the_tool(tmp_path):
    for data in some_files():
        (tmp_path / "a.gscl").write_bytes(data)
        for name in ("a.ply", "a.csv"):
            subprocess.run([GSCL, "export", "a.gscl", "-o", name], cwd=tmp_path, check=True)
        field = gscl.read_field(data)
        assert gscl.pack(gscl.fields.load_ply(tmp_path / "a.ply")) == data
        table = gscl.fields.load_csv(tmp_path / "a.csv", size=(60, 40), blend=field.blend)
        assert table.splats.tobytes() == field.splats.tobytes()


def test_tables_of_others(tmp_path):
    csv = tmp_path / "a.csv"
    csv.write_text("# gscl width=60 height=40 blend=sum background=0.5\nName,x,Y,l11,l21,l22,grey,weight\na, 3,4.5,2,0.5,3,0.25,2\n\n")
    field = gscl.fields.load_csv(csv)
    expected = gscl.make_splats([[3, 4.5]], [0.25], cholesky=[[2, 0.5, 3]], opacity=2)
    assert numpy.array_equal(field.splats, expected)
    assert (field.width, field.height, field.channels, field.blend, field.background) == (60, 40, 1, "sum", (0.5, 0.5, 0.5, 1))
    assert gscl.fields.load_csv(csv, background=(0, 0, 1)).background == (0, 0, 1, 1)

    names = ("x", "y", "cov_xx", "cov_xy", "cov_yy", "red", "green", "blue")
    values = numpy.array([[3, 4.5, 4, 1, 9.25, 0.1, 0.2, 0.3], [9, 8, 2, 0, 2, 1, 0, 1]])
    covariances = gscl.make_splats(values[:, :2], values[:, 5:], covariance=values[:, 2:5])
    for form, kind in (("binary_little_endian", "<f8"), ("binary_big_endian", ">f8")):
        head = ["ply", f"format {form} 1.0", "element vertex 2", *(f"property double {name}" for name in names), "end_header\n"]
        (tmp_path / "a.ply").write_bytes("\n".join(head).encode() + values.astype(kind).tobytes())
        ply = gscl.fields.load_ply(tmp_path / "a.ply", size=(20, 10), blend="normalized")
        assert numpy.array_equal(ply.splats, covariances) and ply.channels == 3

    numpy.savez(tmp_path / "a.npz", **dict(zip(names, values.T)))
    assert numpy.array_equal(gscl.fields.load_npz(tmp_path / "a.npz", size=(20, 10), blend="alpha").splats, covariances)


@pytest.mark.parametrize(
    "text, message",
    [
        ("", "has no line with the names of its columns"),
        ("x,y,sigma1,red\n", "has no column sigma1 and sigma2 .*, green, blue"),
        ("x,y,sigma1,sigma2,grey\n1,2,3,4\n", "splat 0: 4 values; there are 5 columns"),
        ("x,y,sigma1,sigma2,grey\n1,2,3,4,five\n", "could not convert string to float: 'five'"),
        ("x,y,sigma1,sigma2,grey\n1,2,3,4,5\n", "does not say the size of the picture, or its blend"),
        ("# gscl width=9 height=9\nx,y,sigma1,sigma2,grey\n", "does not say the size of the picture, or its blend"),
        ("# gscl width=wide\n", "width=wide is not what gscl export writes"),
    ],
)
def test_errors_of_tables(text, message, tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(text)
    with pytest.raises(gscl.InvalidArgumentError, match=message):
        gscl.fields.load_csv(path)


def test_errors_of_ply(tmp_path):
    def refused(content, message):
        (tmp_path / "a.ply").write_bytes(content)
        with pytest.raises(gscl.InvalidArgumentError, match=message):
            gscl.fields.load_ply(tmp_path / "a.ply", size=(9, 9), blend="sum")

    refused(b"x,y\n", "is no PLY file")
    refused(b"ply\nformat ascii 1.0\nelement face 1\nend_header\n", "its first element is not vertex")
    head = b"ply\nformat %s 1.0\nelement vertex 2\nproperty float x\nproperty float y\nend_header\n"
    refused(head % b"binary_little_endian" + bytes(15), "is incomplete: 2 splats take 8 bytes each")
    refused(head % b"ascii" + b"1 2\n", "it has fewer than 2 splats")
    refused(head.replace(b"float x", b"list uchar int x") % b"ascii", "is no property of a splat")
