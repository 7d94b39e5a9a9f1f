"""Rigid transforms obey the laws of their group; exp and log undo each other at every angle."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from vision_robot.geometry import SE3, rotation_exp, rotation_log, skew

finite = st.floats(-3, 3, allow_nan=False)
twists = arrays(float, 6, elements=finite)
vectors = arrays(float, 3, elements=finite)


def close(a: SE3, b: SE3, tolerance: float = 1e-12) -> bool:
    return bool(np.abs(a.as_matrix() - b.as_matrix()).max() < tolerance)


@given(twists, twists, twists)
def test_group_laws(a, b, c):
    """Associativity, identity and inverse."""
    A, B, C = SE3.exp(a), SE3.exp(b), SE3.exp(c)
    assert close((A @ B) @ C, A @ (B @ C), 1e-11)
    assert close(A @ SE3.identity(), A)
    assert close(SE3.identity() @ A, A)
    assert close(A @ A.inverse(), SE3.identity())
    assert close((A @ B).inverse(), B.inverse() @ A.inverse(), 1e-11)


@given(twists, twists)
def test_product_applies_right_factor_first_and_matches_matrices(a, b):
    A, B = SE3.exp(a), SE3.exp(b)
    points = np.arange(12.0).reshape(4, 3)
    assert np.allclose((A @ B).apply(points), A.apply(B.apply(points)), atol=1e-11)
    homogeneous = np.column_stack([points, np.ones(4)])
    assert np.allclose(A.apply(points), (homogeneous @ A.as_matrix().T)[:, :3], atol=1e-12)


@given(twists, twists)
def test_adjoint_moves_a_twist_through_a_transform(a, b):
    """self @ exp(t) == exp(Ad t) @ self."""
    A = SE3.exp(a)
    assert close(A @ SE3.exp(b), SE3.exp(A.adjoint() @ b) @ A, 1e-10)


@given(vectors)
def test_rotations_are_orthonormal_and_right_handed(rotvec):
    R = rotation_exp(rotvec)
    assert np.allclose(R @ R.T, np.eye(3), atol=1e-13)
    assert np.isclose(np.linalg.det(R), 1)


@pytest.mark.parametrize(
    "angle",
    [0.0, 1e-300, 1e-12, 1e-9, 1e-8, 1e-5, 9.9e-5, 1.01e-4, 0.1, 2.0, 3.1, np.pi - 1e-7, np.pi - 1e-12],
)
@pytest.mark.parametrize("axis", [(1, 0, 0), (0, -1, 0), (0, 0, 1), (1, 2, -3), (-1, 1e-9, 1e-9)])
def test_exp_and_log_undo_each_other_near_zero_and_near_half_turns(angle, axis):
    rotvec = angle * np.array(axis, dtype=float) / np.linalg.norm(axis)
    back = rotation_log(rotation_exp(rotvec))
    assert np.abs(back - rotvec).max() < 1e-14 + 4e-15 * angle
    twist = np.concatenate([[0.3, -2.0, 0.7], rotvec])
    assert np.abs(SE3.exp(twist).log() - twist).max() < 1e-12


def test_log_of_exact_half_turns_has_length_pi():
    for diagonal in ([1, -1, -1], [-1, 1, -1], [-1, -1, 1]):
        rotvec = rotation_log(np.diag(np.array(diagonal, dtype=float)))
        assert np.isclose(np.linalg.norm(rotvec), np.pi)
        assert np.allclose(rotation_exp(rotvec), np.diag(diagonal), atol=1e-15)


@given(vectors)
def test_log_gives_the_shortest_rotation(rotvec):
    back = rotation_log(rotation_exp(rotvec))
    assert np.linalg.norm(back) <= np.pi + 1e-12
    assert np.allclose(rotation_exp(back), rotation_exp(rotvec), atol=1e-12)


def test_exp_is_the_series_of_the_matrix_exponential():
    """Against the defining power series of a 4 x 4 twist matrix."""
    twist = np.array([0.4, -0.2, 0.9, 0.3, 0.8, -0.5])
    generator = np.zeros((4, 4))
    generator[:3, :3], generator[:3, 3] = skew(twist[3:]), twist[:3]
    series, term = np.eye(4), np.eye(4)
    for i in range(1, 30):
        term = term @ generator / i
        series = series + term
    assert np.allclose(SE3.exp(twist).as_matrix(), series, atol=1e-14)


@given(vectors, vectors)
def test_skew_is_the_cross_product(a, b):
    assert np.allclose(skew(a) @ b, np.cross(a, b), atol=1e-12)


def test_batches_act_element_by_element():
    rng = np.random.default_rng(1)
    many, other = SE3.exp(rng.normal(size=(5, 6))), SE3.exp(rng.normal(size=(5, 6)))
    points = rng.normal(size=(7, 3))
    assert len(many) == 5
    assert many.apply(points).shape == (5, 7, 3)
    product, inverse, logs = many @ other, many.inverse(), many.log()
    for i in range(5):
        assert close(product[i], many[i] @ other[i])
        assert close(inverse[i], many[i].inverse())
        assert np.allclose(logs[i], many[i].log(), atol=1e-13)
        assert np.allclose(many.apply(points)[i], many[i].apply(points))
    assert (many @ SE3.identity()).batch == (5,)


def test_matrix_and_rotation_vector_forms_round_trip():
    pose = SE3.from_rotvec(np.array([0.1, 0.2, -0.3]), np.array([1.0, 2, 3]))
    assert close(SE3.from_matrix(pose.as_matrix()), pose)
    assert np.allclose(pose.rotvec(), [0.1, 0.2, -0.3])


def test_a_single_transform_has_no_index():
    with pytest.raises(IndexError):
        SE3.identity()[0]
