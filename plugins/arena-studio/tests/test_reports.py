"""Reports and their replays are shown apart from the studio, by addresses that
vouch for one folder and nothing else.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from arena_studio.signed_addresses import SignedAddresses

TOKEN = "a-token-of-tests"
REPORTS = ("reports/first", "reports/größer & more")


@pytest.fixture
def reported(folder: Path) -> Path:
    """Write two reports with a replay each, and a secret beside them."""
    for name in REPORTS:
        (folder / name / "replays").mkdir(parents=True)
        (folder / name / "index.html").write_text("<a href='replays/e-1.html'>1</a>")
        (folder / name / "replays" / "e-1.html").write_text("a replay")
        (folder / name / "notes.html").write_text("a secret")
    return folder


def stranger_of(client: TestClient) -> TestClient:
    """Return who has no cookie, as a page in a sandbox."""
    return TestClient(client.app, base_url="http://127.0.0.1:8000", follow_redirects=False)


@pytest.mark.parametrize("name", REPORTS)
def test_report_and_its_replays_open_without_a_cookie(client: TestClient, reported: Path, name: str) -> None:
    lead = client.get(f"/report/{name}", follow_redirects=False)
    assert lead.status_code == 303
    page = stranger_of(client).get(lead.headers["location"])
    assert (page.status_code, page.text) == (200, "<a href='replays/e-1.html'>1</a>")
    replay = stranger_of(client).get(f"{lead.headers['location']}replays/e-1.html")
    assert (replay.status_code, replay.text) == (200, "a replay")
    for answer in (page, replay):
        policy = answer.headers["content-security-policy"]
        assert "sandbox allow-scripts" in policy
        assert "allow-same-origin" not in policy
        assert "connect-src" not in policy
        assert "set-cookie" not in answer.headers


def test_signature_opens_one_report_and_nothing_else(client: TestClient, reported: Path) -> None:
    address = SignedAddresses(TOKEN).address(REPORTS[0])
    signature = address.split("/")[2]
    other = stranger_of(client)
    beside = (
        "notes.html",
        "replays/../notes.html",
        "replays/..%2fnotes.html",
        "../first/notes.html",
        "replays/replays/e-1.html",
    )
    for path in (
        *(address + name for name in beside),
        f"/shown/{signature}/reports/",
        f"/shown/{signature}/{REPORTS[1]}/",
        "/api/project",
    ):
        assert other.get(path).status_code in (403, 404), path
    for path in ("/shown//", "/shown/", f"/shown/{'0' * 32}/reports/first/", f"/shown/{signature[:-1]}/reports/first/"):
        assert other.get(path).status_code == 403, path
    assert other.post(address).status_code == 403
    assert client.get(f"/shown/{'0' * 32}/reports/first/").status_code == 403


def test_signed_address_is_of_this_studio_and_of_this_machine(client: TestClient, reported: Path) -> None:
    other = stranger_of(client)
    assert other.get(SignedAddresses("another token").address(REPORTS[0])).status_code == 403
    for headers in ({"Host": "evil.example"}, {"Origin": "null"}, {"Origin": "http://evil.example"}):
        assert other.get(SignedAddresses(TOKEN).address(REPORTS[0]), headers=headers).status_code == 403


def test_signature_tells_nothing_of_the_token() -> None:
    signatures = {SignedAddresses(TOKEN).address(name).split("/")[2] for name in REPORTS}
    assert len(signatures) == len(REPORTS)
    assert not any(TOKEN in one for one in signatures)


def test_what_is_no_report_is_told(client: TestClient, reported: Path) -> None:
    assert client.get("/report/reports").status_code == 404
    assert client.get("/report/..%2f..%2fetc").status_code in (400, 404)
    (reported / "reports" / "first" / "index.html").unlink()
    assert stranger_of(client).get(SignedAddresses(TOKEN).address(REPORTS[0])).status_code == 404
    outside = reported.parent / "outside.html"
    outside.write_text("a secret")
    (reported / "reports" / "first" / "replays" / "link.html").symlink_to(outside)
    assert stranger_of(client).get(f"{SignedAddresses(TOKEN).address(REPORTS[0])}replays/link.html").status_code == 400
