"""rospy leaves sockets to be collected, also after the last test: that is no fault of ours."""

import pytest


def pytest_configure(config: pytest.Config) -> None:
    if config.option.markexpr == "ros1":
        config.addinivalue_line("filterwarnings", "ignore::pytest.PytestUnraisableExceptionWarning")
