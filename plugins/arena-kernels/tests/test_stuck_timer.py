from arena_kernels.stuck_timer import GIVEN_BACK, STIRRED, StuckTimer


def test_who_stays_within_the_circle_stands_and_who_leaves_it_gets_time_back():
    stood = StuckTimer(9.0)
    assert [stood.update(0.0, 0.9 * STIRRED * (k % 2), 10.0 + k) for k in range(6)] == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    assert stood.update(1.1 * STIRRED, 0.0, 16.0) == 6.0 - GIVEN_BACK
    assert stood.update(1.1 * STIRRED, 0.0, 100.0) == 9.0
    stood.clear()
    assert stood.update(0.0, 0.0, 200.0) == 0.0
