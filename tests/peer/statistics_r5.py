"""Are two noisy pictures of one scene equal? Both are given as several renders of independent seeds.

Each pixel and channel is tested with Welch's t, turned into a normal deviate (Wallace 1959), at the
level 0.01 corrected for the number of tests (Sidak); so are blocks of 8 x 8 pixels and the means of
the three channels. The pictures are equal where at least 99.75 % of the pixels and the means of all
channels, within 4 standard errors, agree. The blocks find what neither sees: a part of the picture
that is off by less than a pixel's noise.
"""

from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

LEVEL = 0.01
ACCEPTED_PIXELS = 0.9975
MEAN_SIGMAS = 4.0
BLOCK = 8


@dataclass
class Verdict:
    accepted: float        # share of pixels whose channels all pass
    worst_block: float     # largest |z| of a block
    block_limit: float
    mean_z: np.ndarray     # of the channels
    difference: np.ndarray # of the channels' means, ours over theirs less 1
    sigma: np.ndarray      # its standard error

    @property
    def pixels_pass(self) -> bool:
        return self.accepted >= ACCEPTED_PIXELS

    def passes(self) -> bool:
        means = np.abs(self.difference) <= MEAN_SIGMAS * self.sigma
        return bool(self.pixels_pass and means.all())


def deviates(ours, theirs) -> np.ndarray:
    """Normal deviates of ours - theirs; the first axis counts renders."""
    parts = []
    for renders in (ours, theirs):
        n = len(renders)
        parts.append((renders.mean(0), renders.var(0, ddof=1) / n, n))
    (a, va, na), (b, vb, nb) = parts
    total = va + vb
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (a - b) / np.sqrt(total)
        freedom = total**2 / (va**2 / (na - 1) + vb**2 / (nb - 1))
        z = np.sign(t) * np.sqrt(freedom * np.log1p(t**2 / freedom)) * (8 * freedom + 1) / (8 * freedom + 3)
    # Without noise on either side (a flat background) only rounding may part them.
    same = np.abs(a - b) <= 1e-5 * np.maximum(np.abs(a), np.abs(b))
    return np.where(total > 0, np.where(same, 0.0, z), np.where(same, 0.0, np.inf))


def limit(tests: int) -> float:
    return NormalDist().inv_cdf(1 - (1 - (1 - LEVEL) ** (1 / tests)) / 2)


def blocks(renders, size=BLOCK):
    n, h, w, c = renders.shape
    h, w = h // size * size, w // size * size
    return renders[:, :h, :w].reshape(n, h // size, size, w // size, size, c).mean((2, 4))


def compare(ours, theirs, pixel_tolerance=0.0) -> Verdict:
    """Shapes (renders, height, width, 3). `pixel_tolerance`: what single pixels may differ by for a
    stated reason, as a share; blocks and means know none."""
    z = deviates(ours, theirs)
    a, b = ours.mean(0), theirs.mean(0)
    near = np.abs(a - b) <= pixel_tolerance * np.maximum(np.abs(a), np.abs(b))
    z_blocks = deviates(blocks(ours), blocks(theirs))
    means = [renders.mean((1, 2)) for renders in (ours, theirs)]
    scale = np.maximum(means[1].mean(0), 1e-30)
    sigma = np.sqrt(sum(m.var(0, ddof=1) / len(m) for m in means)) / scale
    return Verdict(accepted=float(((np.abs(z) <= limit(z.size)) | near).all(-1).mean()),
                   worst_block=float(np.abs(z_blocks).max()), block_limit=limit(z_blocks.size),
                   mean_z=deviates(*means), difference=means[0].mean(0) / scale - 1, sigma=sigma)
