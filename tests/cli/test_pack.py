"""gscl pack: splats of other programs as a gscl file."""
import csv
import io
import math
import struct

from images import psnr, read_png, scene
from tool import ToolTest, main


class Pack(ToolTest):
    def table(self):
        return list(csv.DictReader(io.StringIO(self.gscl("export", "in.gscl", "-o", "-", "--csv").decode())))

    def write_table(self, name, columns, rows):
        self.write(name, "\n".join([",".join(columns)] + [",".join(str(value) for value in row) for row in rows]).encode())

    def pack(self, name, *arguments):
        return self.gscl_json("pack", name, "-o", "out.gscl", "--json", "--device", "host", *arguments)

    def test_exported_splats_are_the_same_file(self):
        for blend, channels in (("normalized", 3), ("sum", 1), ("alpha", 4)):
            self.encode(scene(60, 40, channels), "--blend", blend, "--bytes", 300)
            self.gscl("export", "in.gscl", "-o", "in.ply")
            for name in ("in.ply", "in.gscl"):
                report = self.pack(name)
                self.assertEqual(self.path("out.gscl").read_bytes(), self.path("in.gscl").read_bytes())
                self.assertEqual((report["changed"], report["outside"], report["divided"]), (0, 0, 0))

    def test_targets(self):
        self.encode(scene(60, 40), "--bytes", 400)
        self.assertLessEqual(self.pack("in.gscl", "--bytes", 250)["bytes"], 250)
        self.assertLessEqual(self.pack("in.gscl", "--bpp", 0.9)["bytes"], 0.9 * 60 * 40 / 8)
        with_passes, without = self.pack("in.gscl", "--psnr", 30), self.pack("in.gscl", "--psnr", 30, "--no-passes")
        self.assertGreaterEqual(min(with_passes["psnr"], without["psnr"]), 30)
        self.assertLess(with_passes["bytes"], without["bytes"])

    def test_reference(self):
        """PSNR against an image, and splats that move towards it."""
        image = scene(60, 40)
        self.encode(image, "--bytes", 400)
        reference = ("--bytes", 260, "--reference", self.write_png("image.png", image))
        still, moved = self.pack("in.gscl", *reference), self.pack("in.gscl", *reference, "--refine", 4)
        self.assertAlmostEqual(still["field_psnr"], psnr(image, self.decode()), places=0)
        self.assertGreater(moved["psnr"], still["psnr"])

    def test_shapes(self):
        """Covariances and Cholesky factors draw what axes and angles do."""
        self.encode(scene(60, 40), "--bytes", 400, "--effects=-texture")
        rows = [{name: float(value) for name, value in row.items()} for row in self.table()]
        covariances, factors = [], []
        for row in rows:
            c, s = math.cos(row["theta"]), math.sin(row["theta"])
            a, b = row["sigma1"] ** 2, row["sigma2"] ** 2
            xx, xy, yy = c * c * a + s * s * b, c * s * (a - b), s * s * a + c * c * b
            other = [row[name] for name in ("x", "y", "red", "green", "blue")]
            covariances.append(other + [xx, xy, yy])
            factors.append(other + [math.sqrt(xx), xy / math.sqrt(xx), math.sqrt(yy - xy * xy / xx)])
        columns = ["x", "y", "red", "green", "blue"]
        self.write_table("a.csv", columns + ["cov_xx", "cov_xy", "cov_yy"], covariances)
        self.write_table("b.csv", columns + ["l11", "l21", "l22"], factors)
        for name in ("a.csv", "b.csv"):
            self.pack(name, "--size", "60x40", "--blend", "normalized")
            drawn = [read_png(self.gscl("decode", file, "-o", "-", "--device", "host")) for file in ("in.gscl", "out.gscl")]
            self.assertGreater(psnr(*drawn), 36)

    def test_binary_ply(self):
        head = ("ply\nformat binary_little_endian 1.0\ncomment gscl width=20 height=10 blend=sum background=0.5,0.25,0.125,1\n"
                "element vertex 2\nproperty double x\nproperty float y\nproperty float z\nproperty float sigma1\n"
                "property float sigma2\nproperty float red\nproperty float green\nproperty float blue\nend_header\n")
        rows = [(5.5, 5, 0, 2, 3, 0.5, 0.25, 0), (15.5, 4, 0, 1, 3, -0.25, 0, 0.25)]
        self.write("in.ply", head.encode() + b"".join(struct.pack("<d7f", *row) for row in rows))
        self.assertGreater(self.pack("in.ply")["psnr"], 40)
        self.assertEqual(self.gscl_json("info", "out.gscl")["blend"], "sum")
        self.write("cut.ply", self.path("in.ply").read_bytes()[:-1])
        self.refused("cut.ply", "is incomplete: 2 splats take 36 bytes each", "pack", "cut.ply", "-o", "x.gscl")

    def test_errors(self):
        columns = "x,y,sigma1,sigma2,grey"
        tables = {"has no line with the names": "", "has no columns x and y": "sigma1,sigma2,grey\n1,1,1\n",
                  "has no shape": "x,y,grey\n1,1,1\n", "has no colour": "x,y,sigma1,sigma2\n1,1,1,1\n",
                  "line 3: 'two' is no number": f"{columns}\n1,1,1,1,1\n1,two,1,1,1\n",
                  "line 2: has 4 values; there are 5 columns": f"{columns}\n1,1,1,1\n",
                  "the column x is there twice": "x,x,y\n", "splat 1: sigma1 is -1; it must be 1e-06 to 1e\\+06": f"{columns}\n1,1,1,1,1\n1,1,-1,1,1\n",
                  "splat 0: y is nan": f"{columns}\n1,nan,1,1,1\n",
                  "splat 1: \\(1, 2, 1\\) is no covariance": "x,y,cov_xx,cov_xy,cov_yy,grey\n1,1,1,0,1,1\n1,1,1,2,1,1\n"}
        pack = ("pack", "in.csv", "-o", "x.gscl", "--size", "8x8", "--blend", "sum")
        for message, text in tables.items():
            self.write("in.csv", text.encode())
            self.refused("in.csv", message, *pack)
            self.assertFalse(self.path("x.gscl").exists())
        self.write("in.csv", f"{columns}\n1,1,1,1,1\n".encode())
        self.refused("in.csv", "does not say the size of its picture; add --size", "pack", "in.csv", "-o", "x.gscl")
        self.refused("in.csv", "does not say how its splats are blended", "pack", "in.csv", "-o", "x.gscl", "--size", "8x8")
        self.refused("pack", "-o is missing", "pack", "in.csv", code=2)
        self.refused("pack", "exclude each other", *pack, "--bytes", 9, "--psnr", 30, code=2)
        self.refused("pack", "--background cannot be 'red'", *pack, "--background", "red", code=2)
        self.write("in.ply", b"ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int x\nend_header\n")
        self.refused("in.ply", "line 4: 'property list uchar int x' is not understood", "pack", "in.ply", "-o", "x.gscl")


if __name__ == "__main__":
    main()
