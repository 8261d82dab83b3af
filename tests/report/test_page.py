"""The report is one sound HTML file that needs nothing else and begins with the verdict."""

import json
import re
from base64 import b64encode
from dataclasses import replace
from functools import cache
from hashlib import sha256
from html.parser import HTMLParser

import pytest
from gallery import SOLUTIONS, flight, rail, unsolved

from skyknot.errors import UserError
from skyknot.report import kinds_of, write_report
from skyknot.report.certificate_table import checks_list, margin
from skyknot.report.page import report_page, verdict
from skyknot.report.problem_card import number, within
from skyknot.verification import Certificate, Check

VOID = {"meta", "br", "img", "link", "input", "hr"}


class Outline(HTMLParser):
    """Collects tags, text and faults of nesting."""

    def __init__(self):
        super().__init__()
        self.open, self.faults, self.text, self.tags, self.ids = [], [], [], [], []

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        self.ids += [value for key, value in attrs if key == "id"]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        self.ids += [value for key, value in attrs if key == "id"]

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.faults.append(tag)

    def handle_data(self, data):
        self.text.append(data)


def outlined(html):
    outline = Outline()
    outline.feed(html)
    outline.close()
    return outline


@cache
def page_of(name):
    """Return the page of a solution, drawn once."""
    solution = SOLUTIONS[name]()
    return report_page(solution, solution.verify() if solution.problem else None)


@pytest.fixture(scope="module")
def page():
    return page_of("flight")


@pytest.mark.parametrize("name", ["flight", "rail", "unsolved", "from a file"])
def test_the_page_is_sound_and_asks_for_nothing_from_outside(name):
    html = page_of(name)
    outline = outlined(html)
    assert outline.faults == []
    assert outline.open == []
    assert "://" not in re.sub(r"<script>.*?</script>", "", html, flags=re.DOTALL)
    assert not [tag for tag, _ in outline.tags if tag in ("link", "iframe", "object")]
    loads = [a for _, attrs in outline.tags for a in attrs if a in ("src", "srcset", "background")]
    assert loads == []
    assert len(html) < 6_000_000


def test_only_the_scripts_named_by_their_hash_may_run(page):
    (policy,) = re.findall(r'Content-Security-Policy" content="([^"]*)"', page)
    scripts = re.findall(r"<script>(.*?)</script>", page, flags=re.DOTALL)
    digests = [b64encode(sha256(script.encode()).digest()).decode() for script in scripts]
    assert len(scripts) == 2
    assert policy.startswith("default-src 'none'; ")
    assert policy.endswith("; script-src " + " ".join(f"'sha256-{d}'" for d in digests))


def test_a_page_without_a_flight_has_no_script(page):
    assert "<script" in page
    html = page_of("rail")
    assert "<script" not in html
    assert "script-src" not in html


def test_the_licence_of_three_js_travels_with_the_page(page):
    assert "three.js authors" in page
    assert "The above copyright notice and this permission notice" in page


def test_names_inside_pictures_are_unique_on_the_page(page):
    ids = outlined(page).ids
    assert len(ids) == len(set(ids))
    used = set(re.findall(r'(?:url\(|href=")#([^)"]+)', page))
    assert used <= set(ids)


def test_the_verdict_comes_first(page):
    text = " ".join(part.strip() for part in outlined(page).text if part.strip())
    _, sentence = verdict(flight(), flight().verify())
    assert text.index(sentence) < text.index("The problem") < text.index("The certificate")


def test_every_check_stands_in_the_page_with_how_it_was_measured(page):
    text = " ".join(outlined(page).text)
    for check in flight().verify().checks.values():
        assert check.name in text
        assert check.how in text


def test_every_figure_is_a_drawing_with_a_caption(page):
    pictures = [attrs for tag, attrs in outlined(page).tags if tag == "svg"]
    assert len(pictures) == len(kinds_of(flight())) - 1
    assert all(attrs.get("role") == "img" and attrs.get("aria-label") for attrs in pictures)
    assert page.count("<figcaption>") == len(pictures)


def test_the_problem_card_says_what_was_asked(page):
    text = " ".join(outlined(page).text)
    assert flight().problem.vehicle.title in text
    assert "north 8 m, east 6 m, altitude 5 m" in text
    assert "clear of hall, mast, balloon, tree; inside fence; band −0.5 … 7 m; inside lane" in text
    assert "12 segments of 0.5 s" in text


def test_how_to_reproduce_gives_versions_and_the_hash_of_the_inputs(page):
    text = " ".join(outlined(page).text)
    assert flight().record.inputs_hash in text
    assert all(f"{k} {v}" in text for k, v in flight().record.versions.items())
    work = text.split("Work done", 1)[1].split("import skyknot", 1)[0]
    assert all(f"{v} {k.replace('_', ' ')}" in work for k, v in flight().record.work.items())
    assert "_" not in work


def test_the_page_follows_light_dark_and_small_screens(page):
    assert "prefers-color-scheme: dark" in page
    assert "width=device-width" in page
    assert "max-width: 640px" in page
    assert "var(--ink)" in page
    assert "#1c2733" not in page.split("</style>")[1]


def test_names_of_users_cannot_become_markup():
    nasty = '<script>alert("x")</script> & $\\frac{1}{2}$'
    solution = replace(rail(), record=replace(rail().record, problem=nasty))
    html = report_page(solution, None, title=nasty)
    assert "<script" not in html
    assert "&lt;script&gt;" in html


def test_the_verdict_tells_apart_certified_uncertified_and_unsolved():
    passing = Certificate("c", {"a": Check("a", 1.0, 2.0, "m", True, "So.", "x at 0 s")})
    failing = Certificate("c", {"a": Check("a", 3.0, 2.0, "m", False, "So.", "x at 0 s")})
    assert verdict(flight(), passing)[0]
    assert verdict(flight(), passing)[1].startswith("Solved and certified: all 1 checks hold")
    assert not verdict(flight(), failing)[0]
    assert verdict(flight(), failing)[1].startswith("Solved, but not certified: 1 of 1 checks fail")
    assert not verdict(unsolved(), passing)[0]
    assert verdict(unsolved(), passing)[1].startswith("Not solved: iteration limit.")
    assert "not been checked" in verdict(flight(), None)[1]


def test_a_certificate_is_made_when_none_is_given(tmp_path):
    path = write_report(rail(), tmp_path / "run")
    assert path == tmp_path / "run" / "report.html"
    assert "Solved and certified" in path.read_text(encoding="utf-8")


def test_a_solution_from_a_file_gets_a_page_without_problem_or_certificate():
    html = page_of("from a file")
    assert "The problem</h2>" not in html
    assert "The certificate</h2>" not in html
    assert "What binds</h2>" not in html
    assert "not been checked" in html


def test_a_page_that_cannot_be_written_is_told(tmp_path):
    (tmp_path / "run").write_text("a file in the way")
    with pytest.raises(UserError, match=r"(?s)cannot be written.*run.*Choose another place"):
        write_report(rail(), tmp_path / "run" / "page.html")


def test_what_is_only_told_has_neither_mark_nor_margin():
    told = Check("saturation", 5.0, 100.0, "%", True, "So.", "T keeps 12 %", information=True)
    html = checks_list(Certificate("c", {"saturation": told}))
    row = html.split("<div>saturation", 1)[1].split("</li>", 1)[0]
    assert "T keeps 12 %" in row
    assert "limit" not in row
    assert "✓" not in html


def test_margins_are_words():
    assert margin(0.0) == "nothing in excess"
    assert margin(1e-5) == "under 0.1 % of the limit"
    assert margin(0.714) == "71 % of the limit"
    assert margin(12.34) == "12.3 times the limit"
    assert margin(float("inf")) == "not finite"


def test_bounds_are_words():
    inf = float("inf")
    assert within("v", -inf, 2.0, "m/s") == "v ≤ 2 m/s"
    assert within("v", -1.5, inf, "") == "v ≥ −1.5"
    assert within("T", 0.0, 24.0, "N") == "T 0 … 24 N"
    assert within("x", 3.0, 3.0, "m") == "x = 3 m"
    assert number(-1e-6) == "−1e−06"


def test_the_certificate_in_the_page_is_the_one_in_the_data():
    certificate = rail().verify()
    data = json.loads(json.dumps(certificate.as_dict()))
    html = page_of("rail")
    told = sum(check.information for check in certificate.checks.values())
    passed = sum(check["passed"] for check in data["checks"].values())
    assert html.count('class="good"><span') == passed - told
