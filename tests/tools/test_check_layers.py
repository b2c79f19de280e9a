"""The layer check finds each kind of fault in a small made-up tree, and none in a right one."""

from pathlib import Path

import check_layers
import pytest


def plant(root: Path, files: dict[str, str]) -> Path:
    """A tree with a list in each folder; `files` are paths under src and their text."""
    for room in check_layers.ROOMS:
        (root / "src" / room).mkdir(parents=True, exist_ok=True)
    for top in check_layers.FOLDERS:
        folder = root / "src" / top
        names = [n.split("/", 1)[1] for n in files if n.startswith(top + "/")]
        listed = "".join(f"  {n}\n" for n in names if not n.endswith(".in"))
        (folder / "sources.cmake").write_text(f"set(sources\n{listed})\n")
    for name, text in files.items():
        (root / "src" / name).write_text(text)
    return root


def module(name: str, *used: str) -> str:
    lines = [f"  use {u}, only: thing" for u in used]
    return "\n".join([f"module {name}", *lines, "  implicit none", f"end module {name}", ""])


RIGHT = {
    "base/kinds.f90": module("kinds"),
    "base/build_info.f90.in": module("build_info"),
    "model/mesh/dam.f90": module("dam", "kinds", "build_info", "hdf5"),
    "diagnosis/step.f90": module("step", "dam").replace("use dam", "use, non_intrinsic :: dam"),
    "diagnosis/step_impl.f90": "submodule (step) step_impl\n  use dam, only: x\nend submodule\n",
    "app/main.f90": "program keyway\n  use step, only: x\n  used = 1\nend program keyway\n",
}


def test_right_tree_has_no_faults(tmp_path):
    assert check_layers.check(plant(tmp_path, RIGHT)) == []


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        (
            {"base/kinds.f90": module("kinds", "dam")},
            "src/base/kinds.f90:2: room 'base' uses 'dam' of the higher room 'model/mesh'",
        ),
        (
            {
                "model/mesh/dam.f90": module("dam", "sets"),
                "model/mesh/sets.f90": module("sets", "dam"),
            },
            "modules use each other: dam -> sets -> dam",
        ),
        ({"model/mesh/dam.f90": module("dam", "spillway")}, "there is no module 'spillway'"),
        (
            {"model/mesh/dam.f90": module("wall")},
            "src/model/mesh/dam.f90: holds 'wall'; file and module must have the same name",
        ),
        ({"roof/tiles.f90": module("tiles")}, "src/roof/tiles.f90: 'roof' is no room"),
    ],
)
def test_fault_in_a_source_is_found(tmp_path, changes, fault):
    if any(name.startswith("roof/") for name in changes):
        (tmp_path / "src/roof").mkdir(parents=True)
    faults = check_layers.check(plant(tmp_path, RIGHT | changes))
    assert any(fault in found for found in faults), faults


def test_lists_and_files_agree(tmp_path):
    root = plant(tmp_path, RIGHT)
    (root / "src/model/mesh/lost.f90").write_text(module("lost"))
    (root / "src/loads/sources.cmake").write_text("set(sources\n  gone.f90\n  # old.f90\n)\n")
    assert check_layers.check(root) == [
        "src/model/sources.cmake: 'mesh/lost.f90' is not listed",
        "src/loads/sources.cmake: 'gone.f90' is listed but does not exist",
    ]


def test_exit_code(tmp_path, capsys):
    root = plant(tmp_path, RIGHT)
    assert check_layers.main([str(root)]) == 0
    (root / "src/model/mesh/dam.f90").write_text(module("dam", "spillway"))
    assert check_layers.main([str(root)]) == 1
    assert "spillway" in capsys.readouterr().out
