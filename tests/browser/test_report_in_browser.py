"""Claim: the report opens from disk, shows everything, moves, and asks nobody for anything."""

from __future__ import annotations

import io

import numpy as np
import pytest
from matplotlib.image import imread, imsave

from skyknot.report.replay import WITHOUT

MISSIONS = ("city_hop", "vertiport_hop")
STRIP = 4000  # rows
PHONE = {"width": 390, "height": 844, "is_mobile": True, "has_touch": True}


@pytest.fixture(scope="module", params=MISSIONS)
def name(request):
    return request.param


@pytest.fixture(scope="module")
def desktop(name, reports, visit):
    return visit(reports(name).path)


@pytest.fixture(scope="module")
def phone(name, reports, visit):
    return visit(reports(name).path, color_scheme="dark", **PHONE)


@pytest.fixture(scope="module")
def whole(name, desktop, screens):
    """The whole page as an image, kept under build/."""
    image = whole_page(desktop.page, 1280)
    imsave(screens / f"{name}_1280_whole.png", image)
    return image


def whole_page(page, width):
    """Return a page from top to bottom; in strips, for Chromium repeats itself after 8192 rows."""
    page.evaluate("window.scrollTo(0, 0)")
    height = page.evaluate("document.documentElement.scrollHeight")
    strips = []
    for top in range(0, height, STRIP):
        clip = {"x": 0, "y": top, "width": width, "height": min(STRIP, height - top)}
        strips.append(imread(io.BytesIO(page.screenshot(full_page=True, clip=clip)))[:, :, :3])
    return np.concatenate(strips)


def pixels(element):
    return imread(io.BytesIO(element.screenshot()))[:, :, :3]


def cut(image, element):
    """The part of an image of the whole page that an element covers."""
    box = element.bounding_box()
    x, y = round(box["x"]), round(box["y"])
    return image[y : y + round(box["height"]), x : x + round(box["width"])]


def is_drawn(image):
    """Whether more than a hundredth of an image differs from its most frequent colour."""
    shades = (image * 15).round().astype(int) @ [256, 16, 1]
    _, counts = np.unique(shades, return_counts=True)
    return counts.max() < 0.99 * shades.size and len(counts) > 8


def place_of(page):
    return np.array(
        [float(part) for part in page.locator(".replay").get_attribute("data-place").split()]
    )


def scrub_to(page, value):
    part(page, "scrub").evaluate(
        f"e => {{ e.value = {value}; e.dispatchEvent(new Event('input')); }}"
    )


def time_of(page):
    return float(page.locator(".replay").get_attribute("data-time"))


def part(page, name):
    return page.locator(f".replay [data-part={name}]")


def test_nothing_goes_wrong_and_nothing_is_asked_for(name, desktop, reports):
    assert desktop.asked_for == [reports(name).path.as_uri()]
    assert [line for line in desktop.said if line.startswith("error")] == []


def test_the_verdict_stands_in_the_first_screen(name, desktop, phone, screens):
    for seen, width, height in ((desktop, 1280, 860), (phone, 390, 844)):
        page = seen.page
        page.evaluate("window.scrollTo(0, 0)")
        verdict = page.locator(".verdict")
        box = verdict.bounding_box()
        assert verdict.inner_text().startswith("Solved and certified")
        assert box["y"] + box["height"] < height
        page.screenshot(path=screens / f"{name}_{width}_first.png")


def test_every_figure_is_drawn(desktop, whole):
    page = desktop.page
    page.evaluate("window.scrollTo(0, 0)")
    figures = page.locator("figure").all()
    assert len(figures) >= 7
    for figure in figures:
        assert is_drawn(cut(whole, figure.locator("svg"))), figure.locator("h3").inner_text()


def test_the_replay_shows_the_flight(desktop, whole):
    assert desktop.page.locator(".replay").get_attribute("data-state") == "ready"
    assert is_drawn(cut(whole, desktop.page.locator(".replay-view")))


def test_play_moves_the_craft_and_pause_stops_it(desktop):
    page = desktop.page
    scrub_to(page, 0)
    start = place_of(page)
    part(page, "play").click()
    deadline = 600  # polls; the page forbids strings as code, so Playwright's own waiting fails
    while time_of(page) < 1.0 and deadline:
        page.wait_for_timeout(50)
        deadline -= 1
    part(page, "play").click()
    stopped = time_of(page)
    assert np.linalg.norm(place_of(page) - start) > 0.1
    page.wait_for_timeout(150)
    assert time_of(page) == stopped


def test_scrubbing_puts_the_craft_where_the_solution_says(name, desktop, reports, screens):
    page, trajectory = desktop.page, reports(name).solution.trajectory
    before = pixels(page.locator(".replay-view"))
    for value in (1000, 250, 617):
        scrub_to(page, value)
        time = time_of(page)
        assert time == pytest.approx(trajectory.duration * value / 1000, abs=1e-3)
        north, east, down = trajectory.state(time)[:3]
        assert place_of(page) == pytest.approx([east, north, -down], abs=0.02)
    page.locator(".replay").screenshot(path=screens / f"{name}_1280_replay.png")
    after = pixels(page.locator(".replay-view"))
    assert np.mean(np.any(np.abs(after - before) > 0.1, axis=2)) > 1e-3


def test_keys_alone_play_step_and_change_the_view(desktop):
    page = desktop.page
    part(page, "canvas").focus()
    page.keyboard.press("Home")
    assert time_of(page) == 0
    page.keyboard.press("ArrowRight")
    assert time_of(page) > 0
    page.keyboard.press("c")
    assert part(page, "view").input_value() == "follow"
    page.keyboard.press("Space")
    assert part(page, "play").get_attribute("aria-label") == "Pause"
    page.keyboard.press("Space")
    assert part(page, "play").get_attribute("aria-label") == "Play"


def test_the_page_fits_a_phone(name, phone, screens):
    page = phone.page
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert [line for line in phone.said if line.startswith("error")] == []
    imsave(screens / f"{name}_390_whole.png", whole_page(page, 390))


def test_without_webgl_a_sentence_stands_in(reports, visit):
    seen = visit(
        reports("city_hop").path,
        before="HTMLCanvasElement.prototype.getContext = () => null;",
    )
    assert seen.page.get_by_text(WITHOUT).is_visible()
    assert not seen.page.locator(".replay-bar").is_visible()
    assert [line for line in seen.said if line.startswith("error")] == []


def test_without_scripts_a_sentence_stands_in(reports, visit):
    seen = visit(reports("city_hop").path, java_script_enabled=False)
    assert seen.page.get_by_text(WITHOUT).is_visible()
