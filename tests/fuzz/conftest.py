"""The longer share of fuzzing: ``make fuzz`` sets how many inputs each reader gets."""

import os

from hypothesis import HealthCheck, settings

EXAMPLES = int(os.environ.get("FUZZ_EXAMPLES", "25"))

settings.register_profile(
    "fuzz",
    derandomize=EXAMPLES <= 100,
    database=None,
    deadline=None,
    max_examples=EXAMPLES,
    suppress_health_check=list(HealthCheck),
)
