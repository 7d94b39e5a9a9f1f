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

SHARP = 1.4
"""Above this sharpness [1/px], that is for blurs below 0.7 px, the pixel's square shape counts."""

NARROWEST = 0.04
"""Least width of a box and of the Gaussian beside it [px]: what is narrower leaves the sum as it is."""

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
    near = np.flatnonzero((np.maximum(np.abs(h), np.abs(k)) < 2.9) & (np.abs(r) > 1e-3))
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

    Where the blur is wide, a Gaussian stands for all of it. Where the pixel's own extent is a good part
    of it, that part is taken as what it is: an integral over a square.
    """
    density = np.exp(np.float32(-0.5) * h * h)
    step = np.copysign(1 - _tail(np.abs(h), density), h)
    density *= np.float32(2 / np.sqrt(2 * np.pi))
    sharpness = np.linalg.norm(normal, axis=1)
    sharp = np.flatnonzero((sharpness > SHARP)[:, None] & (np.abs(h) < 4.5))
    if len(sharp):
        row = sharp // h.shape[1]
        value, slope = _edge_over_pixels(np.take(h, sharp) / sharpness[row], normal[row], sharpness[row])
        step.reshape(-1)[sharp] = value
        density.reshape(-1)[sharp] = slope / sharpness[row]
    return step, density


def _edge_over_pixels(
    distance: Float[Array, "k"], normal: Float[Array, "k 2"], sharpness: Float[Array, "k"]
) -> tuple[Float[Array, "k"], Float[Array, "k"]]:
    """Mean over a unit square of a Gaussian-blurred step, and its slope [1/px].

    Across the edge, the square is two boxes of widths |normal_u| and |normal_v|; averaging over both takes
    second differences of the step's second integral. The Gaussian is what the whole blur leaves for it.
    """
    along = np.abs(normal) / sharpness[:, None]
    a, b = np.maximum(along, NARROWEST).T
    sigma = np.sqrt(np.maximum(1 / sharpness**2 - 1 / 12, NARROWEST**2))
    value, slope = np.zeros_like(distance), np.zeros_like(distance)
    for sign_a, sign_b in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        d = distance + (sign_a * a + sign_b * b) / 2
        x = d / sigma
        density = np.exp(-0.5 * x * x)
        step = np.copysign(1 - _tail(np.abs(x), density), x)
        density *= sigma * np.sqrt(2 / np.pi)
        value += sign_a * sign_b * ((d * d + sigma * sigma) * step + d * density) / 2
        slope += sign_a * sign_b * (d * step + density)
    return value / (a * b), slope / (a * b)


def _tail(x: Array, density: Array) -> Array:
    """``erfc(x / √2)`` for x ≥ 0, from ``exp(-x²/2)``: Abramowitz and Stegun 7.1.26, error 2e-7."""
    one = x.dtype.type
    t = 1 / (1 + one(0.3275911 / np.sqrt(2)) * x)
    poly = one(1.061405429) * t
    for c in (-1.453152027, 1.421413741, -0.284496736, 0.254829592):
        poly += one(c)
        poly *= t
    return poly * density
