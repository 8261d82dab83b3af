"""Claim: a film shows the whole flight, frame by frame, in files that others play."""

import io
import re
import stat
import subprocess
from itertools import pairwise

import imageio_ffmpeg
import matplotlib as mpl
import numpy as np
import pytest
from gallery import flight, flown_along, rail
from matplotlib.animation import FFMpegWriter
from PIL import Image, ImageChops

from skyknot.errors import UserError
from skyknot.report import animation
from skyknot.report.animation import LONGEST, PER_SECOND, STILL_AT_END, animated, best_film
from skyknot.report.reading import Reading
from skyknot.report.scene import Scene


@pytest.fixture
def short(monkeypatch):
    """Make films of four tenths of a second."""
    monkeypatch.setattr(animation, "LONGEST", 0.4)
    monkeypatch.setattr(animation, "STILL_AT_END", 0.2)


@pytest.fixture
def ffmpeg():
    with mpl.rc_context({"animation.ffmpeg_path": imageio_ffmpeg.get_ffmpeg_exe()}):
        yield


def frames_of(content):
    image = Image.open(io.BytesIO(content))
    frames, lasts = [], []
    for i in range(image.n_frames):
        image.seek(i)
        frames.append(image.convert("RGB"))
        lasts.append(image.info["duration"])
    return frames, lasts


def changed(one, other):
    return ImageChops.difference(one, other).getbbox() is not None


def test_a_gif_shows_the_flight_from_start_to_end(short):
    told = []
    frames, lasts = frames_of(animated(flight(), "gif", lambda i, n: told.append((i, n))))
    count = round(0.4 * PER_SECOND["gif"])
    assert told == [(i + 1, count + 3) for i in range(count + 3)]
    assert len(frames) == count  # the last stands still
    assert all(changed(a, b) for a, b in pairwise(frames))
    assert lasts[-1] == pytest.approx(1000 * (1 / PER_SECOND["gif"] + 0.2), rel=0.15)


def test_only_craft_path_and_words_move(short):
    frames, _ = frames_of(animated(flight(), "gif"))
    pixels = np.stack([np.asarray(frame) for frame in frames]).astype(int)
    still = np.all(pixels == pixels[0], axis=(0, 3))
    assert 0.85 < still.mean() < 0.999
    assert tuple(pixels[0, -1, 0]) == (255, 255, 255)  # paper is white
    assert np.any(pixels[-1] != 255, axis=2).mean() > 0.1


def test_the_craft_moves_along_the_path():
    film = animation._Film(Scene(Reading(flight())))
    camera = film.scene.stage.camera
    for time in (0.0, 2.5, 6.0):
        film.show(time, 1.0)
        place = camera.project(film.scene.place(flight().trajectory.state(time)))
        hull = film.hull.get_paths()[0].vertices
        np.testing.assert_allclose(hull[:-1].mean(axis=0), place, atol=1e-6)
        done = [*film.front.get_segments(), *film.behind.get_segments()]
        assert len(done) >= np.sum(film.scene.times < time) - 1


def test_long_flights_are_shown_faster_and_say_so():
    craft = flown_along([(0, 0, 0), (100, 50, -300), (12e3, 9e3, -300)], "nasa_six_passenger", 600)
    film = animation._Film(Scene(Reading(craft)))
    moments = film.moments(15)
    assert len(moments) == 15 * (LONGEST + STILL_AT_END)
    assert (moments[0][0], moments[-1][0]) == (0.0, 600.0)
    film.show(*moments[40])
    assert re.search(r"50 times as fast$", film.words.get_text())


def test_an_mp4_is_one_that_ffmpeg_reads(short, ffmpeg, tmp_path):
    path = flight().animate(tmp_path / "film.mp4")
    words = [imageio_ffmpeg.get_ffmpeg_exe(), "-i", str(path), "-f", "rawvideo"]
    read = subprocess.run([*words, "-pix_fmt", "gray", "-"], capture_output=True, check=True)
    facts = read.stderr.decode()
    width, height = map(int, re.search(r"h264.* (\d+)x(\d+)[, ]", facts).groups())
    assert (width % 2, height % 2) == (0, 0)
    assert f"{PER_SECOND['mp4']} fps" in facts
    frames = np.frombuffer(read.stdout, np.uint8).reshape(-1, height, width)
    assert len(frames) == round(0.6 * PER_SECOND["mp4"])
    assert np.mean(frames[0] != frames[-1]) > 0.001


def test_mp4_is_best_where_there_is_ffmpeg(ffmpeg, monkeypatch):
    assert best_film() == "mp4"
    monkeypatch.setattr(FFMpegWriter, "isAvailable", classmethod(lambda cls: False))
    assert best_film() == "gif"


def test_mp4_without_ffmpeg_is_refused(monkeypatch):
    monkeypatch.setattr(FFMpegWriter, "isAvailable", classmethod(lambda cls: False))
    with pytest.raises(UserError, match="no ffmpeg") as caught:
        animated(flight(), "mp4")
    assert "Choose gif" in caught.value.do


def test_an_ffmpeg_that_fails_is_quoted(short, tmp_path):
    broken = tmp_path / "ffmpeg"
    broken.write_text("#!/bin/sh\necho 'Unknown encoder libx264' >&2\nexit 1\n", encoding="utf-8")
    broken.chmod(broken.stat().st_mode | stat.S_IXUSR)
    with (
        mpl.rc_context({"animation.ffmpeg_path": str(broken)}),
        pytest.raises(UserError, match="could not make the film") as caught,
    ):
        animated(flight(), "mp4")
    assert "Unknown encoder libx264" in caught.value.found


@pytest.mark.parametrize(
    ("solution", "file_format", "what"),
    [(rail, "gif", "no flight to animate"), (flight, "avi", "cannot be made in this format")],
)
def test_what_cannot_be_filmed_is_refused(solution, file_format, what):
    with pytest.raises(UserError, match=what):
        animated(solution(), file_format)
