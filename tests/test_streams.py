from hypothesis import given
from hypothesis import strategies as st

from arena_core import random_generator, stream_key

KEY = 2846907950199389129
NUMBERS = [710, 456, 298, 757]

names = st.text("abcdefgh/0123456789", max_size=12)
keys = st.tuples(st.integers(0, 2**31), names, names)


@given(one=keys, other=keys)
def test_streams_are_equal_only_where_seed_scenario_and_name_are(one, other):
    assert (stream_key(*one) == stream_key(*other)) == (one == other)


def test_the_parts_of_a_key_do_not_run_into_each_other():
    assert (
        len(
            {
                int(stream_key(1, "2", "3")),
                int(stream_key(12, "", "3")),
                int(stream_key(1, "23", "")),
                int(stream_key(1, "", "23")),
            }
        )
        == 4
    )


def test_keys_and_numbers_stay_what_they_were():
    """Records of older runs can be repeated only as long as this holds."""
    assert int(stream_key(0, "random/0", "localizer")) == KEY
    assert random_generator(0, "random/0", "localizer").integers(0, 1000, 4).tolist() == NUMBERS


def test_a_generator_begins_anew_each_time():
    assert random_generator(3, "a", "b").random(3).tolist() == random_generator(3, "a", "b").random(3).tolist()
