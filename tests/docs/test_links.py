"""Links of the documentation lead somewhere in the repository, headings included."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from urllib.parse import unquote

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted(
    file.relative_to(ROOT).as_posix()
    for file in [
        *ROOT.glob("*.md"),
        *ROOT.glob("docs/**/*.md"),
        *ROOT.glob("scenarios/*.md"),
        *ROOT.glob("benchmarks/**/*.md"),
    ]
)
LINK = re.compile(r'(?:\]\(|<img src="|href=")([^)"\s]+)[^)"]*[)"]')
CODE = re.compile(r"^(```|~~~).*?^\1|`[^`\n]+`", re.MULTILINE | re.DOTALL)


def prose(page: Path) -> str:
    return CODE.sub("", page.read_text(encoding="utf-8"))


@cache
def headings(page: Path) -> set[str]:
    """Anchors as GitHub and the site make them: lower case, blanks to hyphens, no other signs."""
    found = []
    inside = False
    for line in page.read_text(encoding="utf-8").splitlines():
        inside ^= line.startswith("```")
        if not inside and (title := re.match(r"#+ (.*)", line)):
            text = re.sub(r"\[(.*?)\]\(.*?\)", r"\1", title[1]).replace("`", "")
            found.append(re.sub(r"[^\w\- ]", "", text.lower()).strip().replace(" ", "-"))
    return set(found)


def astray(page: str) -> list[str]:
    lost = []
    for link in LINK.findall(prose(ROOT / page)):
        if re.match(r"[a-z]+:", link):
            continue
        path, _, anchor = unquote(link).partition("#")
        file = (ROOT / page).parent / path if path else ROOT / page
        if not file.exists() or (anchor and anchor not in headings(file)):
            lost.append(link)
    return lost


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_somewhere(page: str):
    assert astray(page) == []


def test_a_link_astray_is_noticed(tmp_path: Path):
    page = tmp_path / "page.md"
    page.write_text('# One\n[a](page.md#one) [b](page.md#two) [c](other.md) `[d](e.md)` <img src="f.png">\n')
    assert astray(str(page)) == ["page.md#two", "other.md", "f.png"]
