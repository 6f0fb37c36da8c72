"""Which behaviours bring a robot off what it leans on, one after another."""

from arena_core.loop.ways_out import WaysOut


def tried(ways, opposite=None):
    """Let every behaviour fail, and return them in turn."""
    found = []
    while (way := ways.choose(opposite)) is not None:
        found.append(way)
        ways.fail(way[0], frees=way[1])
    return found


def test_all_that_are_listed_are_tried_then_drive_on_and_at_last_what_leads_straight():
    straight = [("drive_on", True), ("back_up", True)]
    assert tried(WaysOut(["detour", "back_up"])) == [("back_up", False), ("drive_on", False), *straight]
    assert tried(WaysOut(["turn"])) == [("turn", False), ("drive_on", False), ("drive_on", True)]


def test_the_way_opposite_comes_first_unless_it_has_failed():
    ways = WaysOut(["back_up", "turn"])
    assert ways.choose("drive_on") == ("drive_on", True)
    ways.fail("drive_on", frees=False)
    assert ways.choose("drive_on") == ("back_up", False)
    ways.restart()
    assert ways.last is None
    assert ways.choose("drive_on") == ("drive_on", True)


def test_each_lean_begins_with_the_next_of_the_list():
    ways = WaysOut(["back_up", "clear", "turn"])
    assert [ways.choose() for _ in range(3)] == [("back_up", False), ("turn", False), ("back_up", False)]


def test_what_has_failed_as_a_whole_is_tried_again_ever_more_rarely_until_the_robot_gets_away():
    ways = WaysOut(["back_up"])
    assert [ways.begin_again() for _ in range(3)] == [1.0, 2.0, 4.0]
    ways.restart()
    assert ways.begin_again() == 1.0
