from pathlib import Path

import pytest

from arena_core import InputFileError
from arena_core.files import local_path


def test_a_path_stays_as_it_is():
    assert local_path("folder/site.yaml") == Path("folder/site.yaml")
    assert local_path("/site.yaml") == Path("/site.yaml")


def test_a_file_of_a_package_is_found_without_importing_it(third_party):
    third_party.write("boxes/__init__.py", "raise RuntimeError('imported')")
    third_party.write("boxes/maps/a.txt", "here")
    assert local_path("pkg://boxes/maps/a.txt").read_text() == "here"


@pytest.mark.parametrize(
    ("address", "message"),
    [
        ("pkg://boxes/../secret", "without .."),
        ("pkg://boxes", "is no file of a package"),
        ("pkg://", "is no file of a package"),
        ("pkg:///etc/passwd", "is no file of a package"),
        ("pkg://../etc/passwd", "is no file of a package"),
        ("pkg://no_such_package/a", "package no_such_package is not installed"),
        ("pkg://json.decoder/a", "is no file of a package"),
        ("pkg://this/a", "package this is not installed"),  # a module, no package
    ],
)
def test_a_way_out_or_an_unknown_package_is_one_line(third_party, address, message):
    third_party.write("boxes/__init__.py", "")
    with pytest.raises(InputFileError, match=message) as caught:
        local_path(address)
    assert "\n" not in str(caught.value)
