"""What a command of ``arena`` is made of: its words, its messages, aligned tables, the time that is left."""

from arena_core.base.ctrl_c import interrupts
from arena_core.base.errors import describe_error, one_line
from arena_core.base.notices import print_notice
from arena_core.cli.candidates import complete_overrides
from arena_core.cli.words import Words, is_key_value, key_value, read_words
from arena_core.config.output_word import split_out
from arena_core.contracts.running import Command, Listing
from arena_core.runs.jobs.compiling import announce_compiling
from arena_core.runs.pace import Pace
from arena_core.runs.text_columns import align_columns

__all__ = [
    "Command",
    "Listing",
    "Pace",
    "Words",
    "align_columns",
    "announce_compiling",
    "complete_overrides",
    "describe_error",
    "interrupts",
    "is_key_value",
    "key_value",
    "one_line",
    "print_notice",
    "read_words",
    "split_out",
]
