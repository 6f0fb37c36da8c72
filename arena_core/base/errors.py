"""Errors, named after the event; the command line prints each as one line."""

LONGEST_LINE = 1000  # characters of an error's text that are kept


class ArenaError(Exception):
    """Root of every error that a user can cause or mend, on one line;
    ``exit_status`` is what ``arena`` then returns.
    """

    exit_status = 2

    def __str__(self) -> str:
        return one_line(super().__str__())  # it quotes what users wrote: names with line breaks, texts of megabytes


class ConfigurationError(ArenaError):
    """A value of the configuration is not possible; the message names the key and what is allowed."""


class UnknownComponent(ConfigurationError):
    """No installed plugin offers this name; the message lists those that are."""


class DuplicateComponent(ArenaError):
    """Two plugins offer the same name; the message names both."""


class BrokenPlugin(ArenaError):
    """A plugin failed while it was loaded; the message names it and how to switch it off."""


class InputFileError(ArenaError):
    """A file is missing or malformed; the message names the file, the key and what is allowed."""


class ImpossibleScenario(ArenaError):
    """A scenario cannot be run: its start is blocked, its goal unreachable, or its people do not fit."""


class NoPath(ArenaError):
    """The global planner found no path from start to goal."""


class NoValidCommand(ArenaError):
    """The planner found no admissible command; the robot brakes and the event is counted."""


class InvalidCommand(ArenaError):
    """The planner returned something that is no finite Twist; the episode ends with this error."""


class InvalidPredictions(ArenaError):
    """The predictor returned what is no prediction of the tracks; the episode ends with this error."""


class RunFolderError(ArenaError):
    """The run's folder cannot be read or written; the message names the file and the reason."""


class RunStopped(ArenaError):
    """A run could not go on (disk full, worker lost); finished episodes are kept."""

    exit_status = 1


class InvalidCandidates(ArenaError):
    """A planner said that it considered what is no way; the episode ends with an error."""


class ContractViolation(ArenaError):
    """A component breaks its contract; raised by the checks of ``arena_core.testing``."""


def describe_error(error: BaseException) -> str:
    """Return an exception of foreign code as one line that every file and terminal can take."""
    try:
        text = str(error)
    except BaseException as another:  # foreign too
        text = f"its text cannot be had ({type(another).__name__})"
    return one_line(f"{type(error).__name__}: {text}")


def one_line(text: str, longest: int = LONGEST_LINE) -> str:
    """Return a text in one line that any terminal and any file takes: no surrogates, no NUL, no line breaks.

    What is too long loses its middle: a message names the place first, and what is allowed last.
    """
    ends = text if len(text) <= 2 * longest else f"{text[:longest]} {text[-longest:]}"
    shown = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in " ".join(ends.split()))
    tail = longest // 4
    return shown if len(shown) <= longest else f"{shown[: longest - tail - 3]}...{shown[-tail:]}"
