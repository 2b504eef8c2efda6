"""The animation of a cycle: what it shows, and how it is written."""

from dataclasses import replace

import pytest
from click.testing import CliRunner
from PIL import Image

from crackfront.simulate.provenance import provenance
from studies.__main__ import main
from studies.records import write_record
from tests.studies.paper.made import computed, failed, parameters


@pytest.fixture(scope="module")
def shown():
    coarse = {"seed": 1, "error": 0.5, "tile_roll_offs": 10.0, "short_cutoff": 0.3}
    given = parameters("beyond-animation", max_penetration=0.6, step=0.2, **coarse)
    return computed("beyond-animation", given)


def test_the_animation_shows_a_cycle_whose_energies_close(shown):
    assert failed(shown) == []
    wrong = replace(shown, dissipated_energy=shown.dissipated_energy - 0.1, front=shown.front[::-1])
    assert len(failed(wrong)) == 4


def test_drawing_an_animated_figure_writes_its_gif_with_a_frame_for_every_state(shown, tmp_path):
    path = tmp_path / "beyond-animation.nc"
    write_record(path, shown, provenance(), title="animation")
    result = CliRunner().invoke(main, ["paper", "draw", str(path)])
    assert result.exit_code == 0, result.output
    assert {item.suffix for item in tmp_path.iterdir()} == {".nc", ".pdf", ".png", ".gif"}
    with Image.open(path.with_suffix(".gif")) as image:
        assert image.n_frames >= shown.direction.size
    assert path.with_suffix(".gif").stat().st_size < 3_000_000
