import pytest

from arena_core import ConfigurationError
from arena_core.commands import align_columns, is_key_value, key_value, read_words
from arena_core.parameters import Positive, PositiveInt

USAGE = "arena draw FILE [out=DIR] [size=1.0] [world.KEY=VALUE]"


def sorted_words(*words, **settings):
    return read_words(USAGE, words, **{"names": 1, "keys": ("out", "size"), "overrides": ("world",), **settings})


def test_words_are_names_own_keys_and_overrides():
    words = sorted_words("a.yaml", "out=b=c", "world.width=3", "+world.plan=x", "~world.seed")
    assert words.names == ("a.yaml",)
    assert words.keys == {"out": "b=c"}
    assert words.overrides == ("world.width=3", "+world.plan=x", "~world.seed")


def test_own_keys_may_be_options():
    assert sorted_words("a.yaml", "--out", "b", "--size=2").keys == {"out": "b", "size": "2"}
    with pytest.raises(ConfigurationError, match="arguments are a --out; allowed: arena draw FILE"):
        sorted_words("a", "--out")


def test_own_values_are_converted_and_checked_as_those_of_a_configuration():
    words = sorted_words("a.yaml", "size=2e-1")
    assert words.value("size", Positive, 1.0) == 0.2
    assert words.value("size", str, "") == "2e-1"
    assert words.value("out", str, "here") == "here"
    assert read_words(USAGE, ["size=false"], keys=["size"]).value("size", bool, True) is False
    for text, said in (
        ("0", "size is 0; allowed: > 0"),
        ("big", "size is 'big'; allowed: a number"),
        ("inf", "size is inf; allowed"),
    ):
        with pytest.raises(ConfigurationError, match=said):
            sorted_words("a.yaml", f"size={text}").value("size", Positive, 1.0)
    with pytest.raises(ConfigurationError, match=r"size is 0\.2; allowed: a whole number"):
        words.value("size", PositiveInt, 1)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "arguments are none; allowed: arena draw FILE"),
        (("a", "b"), "arguments are a b; allowed: arena draw FILE"),
        (("--fast",), "arguments are --fast; allowed: arena draw FILE"),
        (("a", "out="), "out is empty; allowed: arena draw FILE"),
        (("a", "out=b", "out=c"), "out is given twice; allowed: each key once"),
        (("a", "sise=1"), r"there is no key sise; did you mean size\? allowed: arena draw FILE"),
        (("a", "robot=jackal"), "there is no key robot; allowed: arena draw FILE"),
    ],
)
def test_a_wrong_word_is_named_with_what_is_allowed(words, said):
    with pytest.raises(ConfigurationError, match=said):
        sorted_words(*words)


def test_what_has_to_be_there_is_said():
    with pytest.raises(ConfigurationError, match="out is missing; allowed: arena draw FILE"):
        sorted_words("a").required("out")
    assert sorted_words("a", "out=b").required("out") == "b"


def test_every_override_is_taken_where_a_command_takes_all():
    assert sorted_words("a", "robot=jackal", "episodes=1", overrides=None).overrides == ("robot=jackal", "episodes=1")
    assert sorted_words("a", "b", "c", names=None).names == ("a", "b", "c")


def test_a_word_is_split_at_its_first_equals_sign_without_marks():
    assert key_value("++planner.gain=a=b") == ("planner.gain", "a=b")
    assert key_value("~planner") == ("planner", "")
    assert [word for word in ("a", "a=", "~a", "-m") if is_key_value(word)] == ["a=", "~a"]


def test_columns_are_as_wide_as_their_widest_cell():
    assert align_columns([("name", "n", "text"), ("a", "10", "b"), ("a longer one",)], right=[1]) == [
        "name   n  text",
        "a     10  b",
        "a longer one",
    ]
    assert align_columns([]) == []
