"""Waiting for what must come, and times that are promised: on machines where others work, too."""

import time

from support.daemon import SLOW

PATIENCE = 120.0


def eventually(condition, told=lambda: "", patience=PATIENCE):
    """Looks until the condition holds, which is then given back; fails when patience is over."""
    deadline = time.monotonic() + patience * SLOW
    while not (found := condition()):
        assert time.monotonic() < deadline, told()
        time.sleep(0.01)
    return found


def least_of_turns(turn, promised, turns=20):
    """The least of the times that `turn()` gives, asked again until one keeps the promise.

    Others on a machine only ever add to a time. What is slow by itself is slow in every turn.
    """
    least = float("inf")
    for _ in range(turns):
        least = min(least, turn())
        if least <= promised:
            break
    return least
