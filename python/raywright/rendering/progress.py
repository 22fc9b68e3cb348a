"""A progress bar on stderr with the error of the picture."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Report = Callable[[float, int, float, bool], None]


@contextmanager
def bar(
    samples: int | None, error: float | None, seconds: float | None, rate: float = 1.0
) -> Iterator[Report]:
    """Show a bar while a render runs; give the function to call after each pass.

    It takes seconds, samples, the error, and whether that is trusted. The bar follows whichever limit is
    nearest. Error falls as one over the samples to the power of a rate, so the share of the work that is done
    is the wanted error over the present one, to the inverse power.
    """
    from tqdm import tqdm

    form = "{desc}: {percentage:3.0f}%|{bar}| {postfix[0]}"
    with tqdm(total=1.0, desc="render", bar_format=form, postfix=[""], file=sys.stderr) as shown:

        def report(spent: float, done: int, estimate: float, trusted: bool) -> None:
            shares = [0.0]
            if samples is not None:
                shares.append(done / samples)
            if seconds is not None:
                shares.append(spent / seconds)
            if error is not None and estimate > 0 and trusted:
                shares.append((error / estimate) ** (1 / rate))
            told = "?" if math.isnan(estimate) else f"{estimate:.3g}{'' if trusted else ' (not trusted)'}"
            shown.postfix[0] = f"{done} samples, relMSE {told}, {spent:.1f} s"
            shown.update(max(0.0, min(1.0, max(shares)) - shown.n))

        yield report
        # The render is done, whichever limit ended it.
        shown.update(1.0 - shown.n)
