"""Questions of the desk: the same answers as the command's, and wrong questions refused by name."""

import numpy as np
import pytest
import translucid

PLANE = dict(setup="edge", pixel=0.1, surface_albedo=[0.9, 0.6, 0.4])


def rows(answer):
    """The rows of an answer as those of the command, where what is missing is empty."""
    shown = lambda value: "" if isinstance(value, float) and value != value else value
    columns = [column if isinstance(column, list) else column.tolist() for column in answer.values()]
    return [{name: shown(value) for name, value in zip(answer, row)} for row in zip(*columns)]


def test_answers_are_those_of_the_command(command, tmp_path):
    assert rows(translucid.skin(tone="II", what="color")) == command("skin", "--tone", "II", "--what", "color")
    material = translucid.skin(what="material", photons=100)
    assert not material and material.text.startswith("# translucid.skin; lengths are in mm")

    distance = 0.1 * (np.arange(200) + 0.5 - 100)
    light = 0.5001 + 0.5 * np.sign(distance) * (1 - np.exp(-np.abs(distance)))
    picture = tmp_path / "edge.exr"
    translucid.write_exr(picture, np.tile(light[:, None], (20, 1, 3)).astype(np.float32))
    words = "--setup edge --pixel 0.1 --surface-albedo 0.9,0.6,0.4 --mfp 1,0.8,0.6 --format csv".split()
    judged = translucid.judge(picture, **PLANE, mfp=[1, 0.8, 0.6])
    assert rows(judged) == command("judge", picture, *words)
    assert judged.text.startswith("red: ") and judged.files["judgement.svg"].startswith(b"<svg")

    command("oracle", "--only", "totals", "--photons", 1000, "-o", tmp_path / "oracle")
    files = translucid.oracle(only="totals", photons=1000).files
    assert all((tmp_path / "oracle" / name).read_bytes() == data for name, data in files.items()) and len(files) == 3


@pytest.mark.parametrize(
    "ask, found",
    [
        (lambda: translucid.skin(melanin=1.2), r"melanin is 1.2, but must be in \[0, 1\]"),
        (lambda: translucid.skin(melanin_texture="no.png"), "no.png"),
        (lambda: translucid.oracle(photons=10), "photons is 10, but must be at least 1000"),
        (lambda: translucid.judge("no.exr", **PLANE, mfp=1), "no.exr"),
        (lambda: translucid.judge("no.exr", **PLANE, mfp=1, dmfp=1), "mfp and dmfp are given"),
    ],
)
def test_wrong_questions_are_refused_by_name(ask, found):
    with pytest.raises(ValueError, match=found):
        ask()
