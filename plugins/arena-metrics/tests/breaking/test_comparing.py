"""How planners do on hard problems, without the share that was searched against them."""

from arena_break.comparing import Drive, comparison_table


def test_a_planners_own_share_counts_for_nothing_and_stands_in_brackets():
    drives = [Drive("a_r", "a_r", False, False, 3.0)] * 4
    drives += [Drive("a_r", "b_r", i < 3, True, 0.0 if i < 3 else 2.0) for i in range(4)]
    drives += [Drive("b_r", "a_r", i < 1, True, 1.0) for i in range(4)]
    drives += [Drive("c_r", share, True, True, 0.0) for share in ("a_r", "b_r") for _ in range(4)]
    head, *rows = comparison_table(drives)
    assert head[1:3] == ["a_r", "b_r"]
    assert rows == [
        ["c_r", "4 of 4", "4 of 4", "8", "1.00", "0.68 – 1.00", "1.00", "0.00", "0.00"],
        ["a_r", "(0 of 4)", "3 of 4", "4", "0.75", "0.30 – 0.95", "1.00", "0.50", "2.00"],
        ["b_r", "1 of 4", "–", "4", "0.25", "0.05 – 0.70", "1.00", "1.00", "1.00"],
    ]


def test_a_planner_that_drove_its_own_share_alone_has_no_figures_and_stands_last():
    drives = [Drive("a_r", "a_r", True, True, 0.0), Drive("b_r", "a_r", False, False, 1.0)]
    _, *rows = comparison_table(drives)
    assert [row[0] for row in rows] == ["b_r", "a_r"]
    assert rows[1][1:] == ["(1 of 1)", "0", "–", "–", "–", "–", "–"]
