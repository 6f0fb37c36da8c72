"""Reading foreign files within limits, and writing files whole: beside their place, then renamed."""

from arena_core.base.addresses import local_path
from arena_core.base.arrays import read_array, read_arrays
from arena_core.base.cells import csv_text, escape_formula
from arena_core.base.confinement import reading_within
from arena_core.base.files import check_inside, is_file, read_bytes, read_json, read_table, read_text, read_yaml
from arena_core.base.limits import LIMITS
from arena_core.base.whole_files import write_bytes_whole, write_text_whole, write_whole
from arena_core.config.option_folders import option_files
from arena_core.config.presets import options_of

__all__ = [
    "LIMITS",
    "check_inside",
    "csv_text",
    "escape_formula",
    "is_file",
    "local_path",
    "option_files",
    "options_of",
    "read_array",
    "read_arrays",
    "read_bytes",
    "read_json",
    "read_table",
    "read_text",
    "read_yaml",
    "reading_within",
    "write_bytes_whole",
    "write_text_whole",
    "write_whole",
]
