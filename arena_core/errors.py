"""Errors, named after the event; the command line prints each as one line."""


class ArenaError(Exception):
    """Root of every error that a user can cause or mend; ``exit_status`` is what ``arena`` then returns."""

    exit_status = 2


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


class RunFolderError(ArenaError):
    """The run's folder cannot be read or written; the message names the file and the reason."""


class RunStopped(ArenaError):
    """A run could not go on (disk full, worker lost); finished episodes are kept."""

    exit_status = 1


class ContractViolation(ArenaError):
    """A component breaks its contract; raised by the checks of ``arena_core.testing``."""
