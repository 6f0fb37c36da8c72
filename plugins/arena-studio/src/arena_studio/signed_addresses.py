"""Addresses that need no cookie: of one report's pages, which the browser keeps apart from the
studio and so lets send none.
"""

from __future__ import annotations

import hmac
from dataclasses import dataclass
from hashlib import sha256
from urllib.parse import quote

START = "/shown/"
REPLAYS = "replays"  # the folder of a report that its links lead into
DIGITS = 32  # of a signature


@dataclass(frozen=True, slots=True)
class SignedAddresses:
    """Addresses that the studio's ``token`` vouches for: each of one report, as long as this studio runs.

    ``/shown/SIGNATURE/FOLDER/`` is the report of a folder, ``/shown/SIGNATURE/FOLDER/replays/NAME`` what lies beside
    it. Who knows one learns neither the token nor the signature of another folder.
    """

    token: str

    def address(self, folder: str) -> str:
        """Return the address of the report in a folder of the project."""
        return quote(f"{START}{self._sign_folder(folder)}/{folder}/")

    def allows(self, path: str) -> bool:
        """Return whether a path, as it was asked for, is one of a report that was signed."""
        signature, _, rest = path.removeprefix(START).partition("/")
        folder = _report_folder(rest)
        return (
            path.startswith(START)
            and bool(folder)
            and hmac.compare_digest(signature.encode(), self._sign_folder(folder).encode())
        )

    def _sign_folder(self, folder: str) -> str:
        return hmac.new(self.token.encode(), f"report {folder}".encode(), sha256).hexdigest()[:DIGITS]


def _report_folder(rest: str) -> str:
    """Return the folder whose report is asked for; nothing where a path is of no report."""
    above, _, name = rest.rpartition("/")
    if not name:
        return above
    folder, _, last = above.rpartition("/")
    return folder if last == REPLAYS else ""
