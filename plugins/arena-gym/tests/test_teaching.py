"""A policy that imitates takes one of a teacher's ways, not the mean of them."""

from __future__ import annotations

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the extra arena-gym[train]")


def test_where_a_teacher_goes_two_ways_the_policy_takes_the_usual_one():
    from arena_gym.training.settings import Teacher
    from arena_gym.training.teaching import imitate

    class Line(torch.nn.Linear):
        """Actions that are linear in what is seen."""

        means = torch.nn.Linear.forward

    torch.manual_seed(0)
    actor = Line(1, 1)
    settings = Teacher(planner="teb", rounds=1, decisions=100, epochs=200, minibatch=50, learning_rate=0.01)
    seen, shown = np.ones((100, 1), np.float32), np.where(np.arange(100) < 70, -0.8, 0.8).astype(np.float32)[:, None]
    optimizer = torch.optim.Adam(actor.parameters(), lr=settings.learning_rate)
    off = imitate(actor, optimizer, [(seen, shown)], settings, 1.0, np.random.default_rng(0))
    assert float(actor.means(torch.ones(1, 1)).detach()) == pytest.approx(-0.8, abs=0.05)
    assert off == pytest.approx(0.3 * 1.6, abs=0.03)
