import os
import subprocess
import sys

import pytest

import arena_core
from arena_core.cli.main import main

ELSEWHERE = ("numba", "torch", "casadi", "pandas", "matplotlib", "scipy", "shapely", "seaborn", "hydra")

LOUD = """
    from arena_core import hookimpl
    from arena_core.commands import Command
    from arena_core.base.errors import ArenaError, RunStopped

    class Loud(Command):
        help = "says what it is told"
        kept = "what was said is said"

        def run(self, arguments):
            match arguments:
                case ["fail"]:
                    raise ArenaError("no such thing; allowed: things")
                case ["stop"]:
                    raise RunStopped("the disk is full")
                case ["interrupt"]:
                    raise KeyboardInterrupt
            return len(arguments)

    @hookimpl
    def register_commands(register):
        register("loud", Loud)
"""


@pytest.fixture
def loud(third_party):
    third_party.package("loud", LOUD)


def arena_process(*words, **settings):
    return subprocess.run(
        [sys.executable, "-m", "arena_core.cli.main", *words], capture_output=True, text=True, timeout=600, **settings
    )


@pytest.mark.parametrize(
    ("words", "status", "line"),
    [
        ((), 0, None),
        (("one",), 1, None),
        (("fail",), 2, "arena: no such thing; allowed: things"),
        (("stop",), 1, "arena: the disk is full"),
        (("interrupt",), 130, "arena: interrupted; what was said is said"),
    ],
)
def test_the_exit_status_says_how_it_went_and_an_error_is_one_line(loud, arena, words, status, line):
    answer = arena("loud", *words)
    assert (answer.status, answer.errors) == (status, [line] if line else [])


def test_a_process_returns_the_status_and_prints_no_traceback(loud, third_party):
    answer = arena_process("loud", "fail", env=third_party.environment)
    assert (answer.returncode, answer.stdout, answer.stderr) == (2, "", "arena: no such thing; allowed: things\n")


@pytest.mark.parametrize("words", [(), ("-h",), ("--help",)])
def test_help_names_every_command_with_its_help(loud, arena, words):
    answer = arena(*words)
    assert answer.status == 0
    assert "  loud       says what it is told\n" in answer.out
    assert all(f"  {name}" in answer.out for name in ("run", "evaluate", "list", "check", "new"))


def test_the_version_is_said(arena):
    assert arena("--version").out == f"arena {arena_core.__version__}\n"


def test_a_broken_plugin_is_one_line(third_party, arena):
    third_party.package("broken", "raise RuntimeError('no device')")
    answer = arena("list")
    assert answer.status == 2
    assert answer.line.startswith("arena: plugin broken cannot be loaded (no device)")


def test_listing_loads_no_heavy_library(tmp_path):
    code = (
        "import sys; from arena_core.cli.main import main; main(['list']); "
        f"print([m for m in {ELSEWHERE} if m in sys.modules])"
    )
    answer = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=600, check=True, cwd=tmp_path
    )
    assert answer.stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize("words", [["list"], ["check", "--help"], ["run", "planner=pure_pursuit", "--cfg", "job"]])
def test_output_that_nobody_reads_is_no_error(tmp_path, words):
    read, write = os.pipe()
    os.close(read)
    command = [sys.executable, "-m", "arena_core.cli.main", *words]
    usual = {key: value for key, value in os.environ.items() if key != "PYTHONUNBUFFERED"}
    answer = subprocess.run(command, stdout=write, stderr=subprocess.PIPE, timeout=600, cwd=tmp_path, env=usual)
    os.close(write)
    assert (answer.returncode, answer.stderr) == (141, b"")


def test_importing_the_public_core_loads_numpy_and_pluggy_alone(tmp_path):
    code = f"import sys, arena_core; print([m for m in {(*ELSEWHERE, 'omegaconf', 'rich')} if m in sys.modules])"
    answer = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=600, check=True, cwd=tmp_path
    )
    assert answer.stdout == "[]\n"


def test_every_public_name_is_there():
    assert all(hasattr(arena_core, name) for name in arena_core.__all__)
    assert sorted(arena_core.__all__) == sorted(set(arena_core.__all__))


def test_arguments_default_to_those_of_the_process(loud, arena, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["arena", "loud", "one", "two"])
    assert main() == 2


@pytest.mark.parametrize(
    ("module", "reason"),
    [("import sys\nsys.exit(0)\n", "SystemExit: 0"), ("raise BaseException('no')\n", "BaseException: no")],
)
def test_a_plugin_that_ends_the_process_at_its_import_is_one_line(third_party, arena, module, reason):
    third_party.package("ending", module)
    answer = arena("list")
    assert (answer.status, answer.line.startswith(f"arena: plugin ending cannot be loaded ({reason})")) == (2, True)


def test_a_component_that_ends_the_process_at_its_import_is_one_line(third_party, arena):
    hook = (
        "from arena_core import hookimpl\n\n@hookimpl\ndef register_commands(register):\n    register('go', "
        "'going.far:Command')\n"
    )
    third_party.package("going", hook)
    third_party.write("going/far.py", "import sys\nsys.exit(5)\n")
    answer = arena("go")
    assert (answer.status, answer.line) == (2, "arena: plugin going: command go cannot be imported (SystemExit: 5)")


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_while_plugins_are_imported_is_one_line(third_party, arena):
    third_party.package(
        "slow", "import os\nimport signal\nimport time\nos.kill(os.getpid(), signal.SIGINT)\ntime.sleep(0.2)\n"
    )
    answer = arena("list")
    assert (answer.status, answer.line) == (130, "arena: interrupted")
