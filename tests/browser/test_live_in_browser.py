"""Claim: on the live page the goal is dragged, or typed, and the path follows."""

from __future__ import annotations

import io
import sys
import time

import numpy as np
import pytest
from matplotlib.image import imread

from skyknot import missions
from skyknot.live import Planner
from skyknot.report.camera import east_north_up

pytest.importorskip("viser", reason="needs the extra 'live'")
from skyknot.live.live_page import LivePage

PATIENCE = 60.0
"""Seconds to wait for anything; a busy machine draws slowly without a graphics card."""

VIEW = {"width": 1000, "height": 640}


@pytest.fixture(scope="module")
def live():
    """Return a live page of the city mission, served."""
    page = LivePage(Planner(missions.load("city_hop")), port=8931)
    yield page
    page.close()


@pytest.fixture(scope="module")
def visit(live, chromium):
    """Return the page in the browser, drawn, with what it said and asked for."""
    page = chromium.new_page(viewport=VIEW)
    page.said, page.asked_for = [], []
    page.on("console", lambda m: page.said.append(m.text) if m.type == "error" else None)
    page.on("pageerror", lambda error: page.said.append(str(error)))
    page.on("request", lambda request: page.asked_for.append(request.url))
    page.goto(live.address)
    page.get_by_label("Goal north [m]").wait_for(timeout=1e3 * PATIENCE)
    until(lambda: live._server.get_clients() and pixels(page).std() > 5, "the scene is drawn")
    yield page
    page.close()


def until(holds, what):
    """Wait until something holds."""
    end = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < end, f"never: {what}"
        time.sleep(0.1)


def planned(planner):
    """Return whether what is wanted now has a path."""
    return planner.latest.solved and planner.latest.wish == planner.wish


def pixels(page):
    """Return the scene left of the panel as grey values."""
    shot = page.screenshot(clip={"x": 310, "y": 0, "width": 360, "height": VIEW["height"]})
    return 255 * imread(io.BytesIO(shot), format="png")[..., :3].mean(axis=-1)


def on_screen(live, point):
    """Return the pixel (2,) of a point (3,), east, north, up, by the camera that the page has."""
    camera = next(iter(live._server.get_clients().values())).camera
    w, x, y, z = camera.wxyz
    R = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    right, down, ahead = R.T @ (np.asarray(point) - camera.position)
    focal = 0.5 * camera.image_height / np.tan(0.5 * camera.fov)
    middle = 0.5 * np.array([camera.image_width, camera.image_height])
    return middle + focal * np.array([right, down]) / ahead


def test_a_typed_goal_moves_the_path(live, visit):
    before, planner = pixels(visit), live.planner
    box = visit.get_by_label("Goal north [m]")
    box.fill("112")
    box.press("Enter")
    until(lambda: planner.wish.goal[0] == 112.0, "the goal is taken over")
    until(lambda: planned(planner), "it is planned")
    assert planner.latest.trajectory.states[-1, 0] == pytest.approx(112.0)
    until(lambda: np.mean(np.abs(pixels(visit) - before) > 30) > 1e-3, "the picture changes")
    visit.get_by_text("Re-plans:").wait_for(timeout=1e3 * PATIENCE)


def test_the_goal_is_dragged_and_the_rate_is_measured(live, visit, screens, capsys):
    planner = live.planner
    handle = live._view.handles["goal"]
    until(lambda: planner.latest.thorough, "the page is at rest")
    place = np.array(handle.position)
    begin = on_screen(live, np.add(place, (0.6 * handle.scale, 0.0, 0.0)))
    towards = on_screen(live, np.add(place, (0.3 * handle.scale, 0.0, 0.0)))
    before, path = place.copy(), planner.latest.trajectory.states[-1, :3].copy()
    visit.mouse.move(*begin)
    time.sleep(0.5)
    visit.mouse.down()
    for share in np.linspace(0.05, 1.0, 25):
        visit.mouse.move(*(begin + share * (towards - begin)))
        time.sleep(0.05)
    visit.mouse.up()
    until(lambda: np.linalg.norm(np.subtract(handle.position, before)) > 0.5, "the handle moves")
    goal = east_north_up(np.array(handle.position))
    until(lambda: np.allclose(planner.wish.goal, goal, atol=1e-6), "the wish follows")
    until(lambda: planned(planner), "it is planned")
    end = planner.latest.trajectory.states[-1, :3]
    np.testing.assert_allclose(end, goal, atol=1e-6)
    assert np.linalg.norm(end - path) > 0.5
    visit.screenshot(path=screens / "live_page.png")
    assert planner.rate > 0
    with capsys.disabled():
        sys.stdout.write(
            f"\nlive page, goal dragged: {planner.rate:.1f} re-plans per second on this machine"
            f" as busy as it is, {planner.rate_alone:.1f} per second of processor time\n"
        )


def test_a_goal_inside_a_building_is_told_and_the_certified_path_stays(live, visit):
    planner = live.planner
    for label, value in (("Goal north [m]", "93"), ("Goal east [m]", "77")):
        visit.get_by_label(label).fill(value)
        visit.get_by_label(label).press("Enter")
    visit.get_by_text("the goal lies inside 'twin tower'").wait_for(timeout=1e3 * PATIENCE)
    visit.get_by_text("the last certified plan").wait_for(timeout=1e3 * PATIENCE)
    assert planner.certified is not None
    assert live._view._paths["certified"].visible
    assert not live._view._paths["path"].visible


def test_the_page_needs_no_network_and_reports_no_error(live, visit):
    elsewhere = [
        url
        for url in visit.asked_for
        if not url.startswith((live.address, "data:", "blob:", "ws://127"))
    ]
    assert not elsewhere
    assert not visit.said
