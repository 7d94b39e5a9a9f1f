"""The picture of a chessboard corner: two edges through a point, blurred.

A sharp corner is ``sign(d1) sign(d2)`` with d the distances from the two edges. Blurred by a Gaussian
it is ``E[sign(d1 + e1) sign(d2 + e2)]`` with e bivariate normal: with the distances h, k in
units of the blur and r the correlation of the blur across the two edges

    S(h, k) = erf(h/√2) erf(k/√2) + (2/π) ∫₀^asin(r) exp(-(h² - 2hk sin t + k²) / (2 cos² t)) dt

(Plackett 1954; Drezner and Wesolowsky 1990 for the form of the integral). S is even under
reflection in the corner, so what the model gets wrong evenly (shape of the blur, tone
curve, r) does not move the corner; what it must have are the odd things: uneven light and bent edges.
"""

import numpy as np

from vision_robot.types import Array, Float

__all__ = ["blurred_saddle"]

# Gauss-Legendre nodes and weights on [0, 1].
NODES = ((0.1127016654, 5 / 18), (0.5, 8 / 18), (0.8872983346, 5 / 18))

PIXEL_KURTOSIS = 1 / 1440

Field = Float[Array, "n m"]


def blurred_saddle(
    h: Field,
    k: Field,
    sharpness: tuple[Float[Array, "n 2"], Float[Array, "n 2"]],
    correlation: Float[Array, "n"],
) -> tuple[Field, Field, Field]:
    """Values in [-1, 1] of blurred saddles, and their derivatives in h and k.

    `h`, `k`: distances from the edges over the blur across them; `sharpness`: normals of the
    edges over that blur [1/px], for the shape of the pixel; `correlation` r of the blur across the two.
    """
    E1, D1 = _edge(h, sharpness[0])
    E2, D2 = _edge(k, sharpness[1])
    S, Sh, Sk = E1 * E2, D1 * E2, E1 * D2
    r = correlation.astype(h.dtype)[:, None]
    product, squares = h * k, h * h + k * k
    near = np.flatnonzero((squares - 2 * np.abs(r * product) < 9 * (1 - r * r)) & (np.abs(r) > 1e-3))
    hn, kn, product, squares = (np.take(field, near) for field in (h, k, product, squares))
    squares *= np.float32(0.5)
    angle = np.arcsin(correlation).astype(h.dtype)[near // h.shape[1]]
    # One sum over the nodes, then one scatter: the derivatives are moments of the same bumps.
    value, straight, crossed = (np.zeros_like(hn) for _ in range(3))
    for node, weight in NODES:
        sine = np.sin(angle * np.float32(node))
        inverse = 1 / (1 - sine * sine)
        bump = np.exp((sine * product - squares) * inverse)
        bump *= np.float32(weight * 2 / np.pi)
        value += bump
        bump *= inverse
        straight += bump
        bump *= sine
        crossed += bump
    S.reshape(-1)[near] += angle * value
    Sh.reshape(-1)[near] += angle * (kn * crossed - hn * straight)
    Sk.reshape(-1)[near] += angle * (hn * crossed - kn * straight)
    return S, Sh, Sk


def _edge(h: Field, normal: Float[Array, "n 2"]) -> tuple[Field, Field]:
    """Blurred step from -1 to 1 and its derivative, the square pixel's own shape included.

    The error function from the exponential (Abramowitz and Stegun 7.1.26, error 2e-7). Where a pixel's
    own extent is a good part of the blur, its fourth cumulant, ``-(a⁴ + b⁴)/120`` for the normal (a, b),
    flattens the step: first term of the Edgeworth series.
    """
    density = np.exp(np.float32(-0.5) * h * h)
    x = np.abs(h)
    t = 1 / (1 + np.float32(0.3275911 / np.sqrt(2)) * x)
    poly = np.float32(1.061405429) * t
    for c in (-1.453152027, 1.421413741, -0.284496736, 0.254829592):
        poly += np.float32(c)
        poly *= t
    poly *= density
    step = np.copysign(1 - poly, h)
    density *= np.float32(1 / np.sqrt(2 * np.pi))
    flat = np.minimum((normal**4).sum(axis=1) * PIXEL_KURTOSIS, 0.1).astype(h.dtype)
    if flat.max() > 1e-3:
        h2 = h * h
        bend = flat[:, None] * density
        step += bend * h * (h2 - 3)
        return step, 2 * density - bend * (h2 * h2 - 6 * h2 + 3)
    return step, 2 * density
