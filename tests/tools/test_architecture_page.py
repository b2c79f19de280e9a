"""docs/architecture.md lists the rooms of src as tools/check_layers.py has them."""

import re
from pathlib import Path

import check_layers

PAGE = Path(check_layers.__file__).parent.parent / "docs" / "architecture.md"


def test_rooms_are_those_of_the_layer_check() -> None:
    rooms = PAGE.read_text(encoding="utf-8").split("## Rooms")[1].split("\n## ")[0]
    listed = re.findall(r"^\| `([a-z_/]+)` \|", rooms, flags=re.MULTILINE)
    assert tuple(listed) == check_layers.ROOMS
