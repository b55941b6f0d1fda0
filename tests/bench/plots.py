"""matplotlib as the plots beside the scripts need it: text stays text, and the same figures give the same file."""
import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams["svg.fonttype"] = "none"
matplotlib.rcParams["svg.hashsalt"] = "gscl"
import matplotlib.pyplot as pyplot  # noqa: E402


def save(figure, path):
    figure.savefig(path, metadata={"Date": None} if str(path).endswith(".svg") else None)
