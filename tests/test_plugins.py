import pytest

from arena_core.config.plugins import DISABLED, config_packages, enabled_entry_points, load_plugins
from arena_core.config.registry import load_registry
from arena_core.hosting import BrokenPlugin

GOOD = """
    from arena_core import hookimpl

    @hookimpl
    def register_planners(register):
        register("good", "good.planner:Good")

    @hookimpl
    def config_package():
        return "good.conf"
"""


def test_an_installed_package_is_a_plugin(third_party):
    third_party.package("good", GOOD)
    component = load_registry().component("planner", "good")
    assert component.distribution() == ("good", "1.2.3")


def test_the_core_comes_through_the_same_door():
    assert "core" in [entry_point.name for entry_point in enabled_entry_points()]
    assert {"serial", "processes"} <= set(load_registry().names("executor"))


def test_configuration_packages_are_found_by_plugin_in_order_of_name(third_party):
    third_party.package("good", GOOD, conf={})
    packages = config_packages(load_plugins())
    assert packages["good"] == "good.conf"
    assert list(packages) == sorted(packages)


def test_a_misspelt_hook_is_an_error_that_names_hook_and_plugin(third_party):
    third_party.package("sloppy", "from arena_core import hookimpl\n\n@hookimpl\ndef register_planer(register): ...\n")
    with pytest.raises(BrokenPlugin, match=r"plugin sloppy .*register_planer.*ARENA_DISABLED_PLUGINS=sloppy"):
        load_plugins()


def test_a_hook_with_an_unknown_argument_is_an_error_that_names_the_plugin(third_party):
    third_party.package(
        "sloppy", "from arena_core import hookimpl\n\n@hookimpl\ndef register_planners(registry): ...\n"
    )
    with pytest.raises(BrokenPlugin, match=r"plugin sloppy .*registry"):
        load_plugins()


@pytest.mark.parametrize(
    ("module", "reason"),
    [
        ("raise RuntimeError('no device')", "no device"),
        ("import no_such_module_at_all", "no_such_module_at_all"),
        ("def broken(:", "invalid syntax"),
        ("raise KeyError", "KeyError"),
    ],
)
def test_a_plugin_that_cannot_be_imported_is_named_with_the_reason_and_the_way_out(third_party, module, reason):
    third_party.package("broken", module)
    with pytest.raises(
        BrokenPlugin, match=rf"plugin broken cannot be loaded .*{reason}.*ARENA_DISABLED_PLUGINS=broken"
    ) as caught:
        load_plugins()
    assert "\n" not in str(caught.value)


def test_a_broken_plugin_can_be_switched_off(third_party, monkeypatch):
    third_party.package("broken", "raise RuntimeError")
    monkeypatch.setenv(DISABLED, "pure_pursuit, broken")
    assert "pure_pursuit" not in load_registry().names("planner")
    assert not {"broken", "pure_pursuit"} & {entry_point.name for entry_point in enabled_entry_points()}


def test_a_plugin_whose_registration_raises_is_named(third_party):
    third_party.package(
        "broken", "from arena_core import hookimpl\n\n@hookimpl\ndef register_planners(register): register(1 / 0)\n"
    )
    with pytest.raises(BrokenPlugin, match=r"plugin broken .*division by zero"):
        load_registry()


@pytest.mark.parametrize("package", ["1 / 0", "'no_such_package.conf'"])
def test_a_plugin_whose_configuration_package_is_not_there_is_named(third_party, package):
    third_party.package(
        "broken", f"from arena_core import hookimpl\n\n@hookimpl\ndef config_package(): return {package}\n"
    )
    with pytest.raises(BrokenPlugin, match="plugin broken "):
        config_packages(load_plugins())
