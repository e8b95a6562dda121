# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables 6 to 9 and figures 14 to 16 on real photographs: a pen with tags, a temple on a gantry."""

import hashlib
from pathlib import Path

from fairlead.io.camera import load_camera
from fairlead.io.observations import read_views
from fairlead.io.shipped import shipped_data
from fairlead.io.target import load_target
from fairlead.reproduce import published
from fairlead.reproduce.content import Cell, Column, Picture, Section, Table
from fairlead.reproduce.context import Context
from fairlead.reproduce.detections import LABELS as DETECTORS
from fairlead.reproduce.experiments.shared import NO_REAL_SHIP
from fairlead.reproduce.figures.real import draw_camera_errors
from fairlead.reproduce.methods import EPNP, LABELS
from fairlead.reproduce.pen_network import judge_pen, look
from fairlead.reproduce.photographs import PenErrors, TempleErrors, pen, temple

_PEN = (
    Column(key="corners", title="corners"),
    Column(key="label", title="pen, 16 photographs"),
    Column(key="joint_px", title="reprojection, poses of the method [px rms]"),
    Column(key="all_px", title="each photograph alone on its model [px rms]"),
    Column(key="unseen_px", title="the same, 8 photographs that the model has not seen [px rms]"),
    Column(key="side_mm", title="mean side of the tags [mm]", digits=4),
)
_NETWORKS = (
    Column(key="label", title="pen, 16 photographs"),
    Column(key="photographs", title="found in"),
    Column(key="found", title="corners found [%]", percent=True),
    Column(key="median_px", title="error, median [px]"),
    Column(key="mean_px", title="mean [px]"),
    Column(key="gross", title="beyond 20 px [%]", percent=True, digits=2),
    Column(key="nees", title="NEES"),
    Column(key="posed", title="poses"),
    Column(key="corner_px", title="true corners from model and poses [px rms]"),
    Column(key="corner_unseen_px", title="8 photographs that the model has not seen [px rms]"),
    Column(key="rotation_deg", title="rotation, median [deg]"),
    Column(key="position_percent", title="position, median [% of range]"),
)
_TEMPLE = (
    Column(key="label", title="temple, 16 photographs"),
    Column(key="landmarks_mm", title="landmarks, aligned [mm rms]"),
    Column(key="landmarks_raw_mm", title="raw [mm rms]"),
    Column(key="worse", title="landmarks that got worse [%]", percent=True, digits=2),
    Column(key="position_percent", title="camera position [% of range, rms]"),
    Column(key="position_late_percent", title="second half [% of range, rms]"),
    Column(key="rotation_deg", title="rotation [deg rms]"),
    Column(key="update_ms", title="update, median [ms]"),
)


def real(context: Context) -> Section:
    """What the recordings allow."""
    missing = [NO_REAL_SHIP]
    folder = context.config.real
    rows = _pen_rows("ours", pen(shipped_data("marker_pen")))
    pictures: list[Picture] = []
    if folder is None:
        missing.append("the temple, networks on the pen's photographs, the corners that came with it: expected --real")
    if folder is not None and (folder / "marker_pen").is_dir():
        rows += _pen_rows("given", pen(folder / "marker_pen"))
    tables = [Table(name="real_pen", title="Pen with eight tags", columns=_PEN, rows=rows, note=_PEN_NOTE)]
    if folder is not None and (folder / "marker_pen" / "images").is_dir():
        networks = _pen_networks(folder / "marker_pen")
        if networks:
            tables.append(_network_table(networks, folder / "marker_pen" / "images", context))
        else:
            missing.append("networks on the pen's photographs: no .onnx in data/marker_pen or --real DIR/marker_pen")
    if folder is not None and (folder / "temple_ring").is_dir():
        errors = temple(folder / "temple_ring")
        tables.append(_temple_table(errors))
        caption = (
            "Temple: error of the camera's position in every photograph after the similarity that aligns the model, "
            "per cent of the range; truth from the gantry."
        )
        pictures.append(Picture(name="figure14", caption=caption, figure=draw_camera_errors(errors)))
    return Section(
        name="real",
        title="Tables 6 to 9, figures 14 to 16: real photographs",
        published=published.REAL,
        words=[_WORDS],
        tables=tables,
        pictures=pictures,
        missing=missing,
        facts={"data": "marker_pen (github.com/Jcparkyn/dpoint, MIT), temple_ring (Seitz et al. 2006)"},
    )


_WORDS = (
    "Photographs that others took. The pen's drawing is wrong and nobody surveyed it: what is measured is how well "
    "one model explains photographs, the ones that refined it and others. The temple's truth are the camera poses of "
    "its gantry; its true landmarks were triangulated with these poses. The told landmarks are 3 % of its size off."
)


_PEN_NOTE = (
    "Corners by our own detector from the 16 photographs, and as given with the recording. Unseen: the model is "
    "refined with the even photographs, then each odd one is solved alone on it. The builder changed the tags' side "
    "from 13.0 to 12.61 mm."
)


_NETWORKS_NOTE = (
    "Networks that were trained on renders of the drawing alone, in rooms that never were, and have seen no "
    "photograph. Truth are the corners that the detector of tags measures; what it does not see counts nowhere. Poses "
    "and models are refined from what the detector of the row found; rotation and position are against those from the "
    "true corners, models aligned."
)


def _pen_networks(folder: Path) -> list[Path]:
    """Those that come along, and those that lie beside the photographs."""
    return sorted(shipped_data("marker_pen").glob("*.onnx")) + sorted(folder.glob("*.onnx"))


def _network_table(networks: list[Path], images: Path, context: Context) -> Table:
    pen_folder = shipped_data("marker_pen")
    target, camera = load_target(pen_folder / "target.toml"), load_camera(pen_folder / "camera.yaml")
    corners = list(read_views(pen_folder / "observations.csv"))
    tags = vars(judge_pen(corners, corners, target, camera))
    rows: list[dict[str, Cell]] = [{"detector": "tags", "label": "tags", **tags}]
    for network in networks:
        output = context.cache / "pen" / f"{network.stem}-{hashlib.sha256(network.read_bytes()).hexdigest()[:12]}"
        views = look(network, images, pen_folder, output, context.progress)
        label = f"{DETECTORS.get(network.stem, network.stem)}, trained on renders"
        rows.append({"detector": network.stem, "label": label, **vars(judge_pen(views, corners, target, camera))})
    return Table(
        name="real_pen_networks", title="Networks on the pen", columns=_NETWORKS, rows=rows, note=_NETWORKS_NOTE
    )


def _pen_rows(corners: str, errors: dict[str, PenErrors]) -> list[dict[str, Cell]]:
    return [
        {
            "corners": corners,
            "method": method,
            "label": "drawing, each photograph alone" if method == EPNP else LABELS[method],
            "joint_px": each.joint_px,
            "all_px": each.all_px,
            "unseen_px": each.unseen_px,
            "side_mm": each.side_mm,
        }
        for method, each in errors.items()
    ]


def _temple_table(errors: dict[str, TempleErrors]) -> Table:
    rows: list[dict[str, Cell]] = []
    for method, each in errors.items():
        row: dict[str, Cell] = {"method": method, "label": LABELS[method], "landmarks_mm": each.landmarks_mm}
        row |= {"landmarks_raw_mm": each.landmarks_raw_mm, "worse": each.worse, "rotation_deg": each.rotation_deg}
        row |= {"position_percent": each.position_percent, "position_late_percent": each.position_late_percent}
        rows.append(row | {"update_ms": each.update_ms})
    note = (
        "Published window: all 16 photographs in one solve, because they are fewer than its window. After alignment, "
        "because raw scale and attitude of a model are its prior's."
    )
    return Table(name="real_temple", title="Temple on a gantry", columns=_TEMPLE, rows=rows, note=note)
