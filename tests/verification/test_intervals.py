"""Claim: an enclosure holds every value inside the box, and no much more of a narrow one."""

import casadi as ca
import numpy as np
import pytest

from skyknot.verification.intervals import enclosed

OPERATIONS = {
    "sum": lambda x, y: x + 2 * y,
    "difference": lambda x, y: x - y,
    "product": lambda x, y: x * y,
    "quotient": lambda x, y: x / (3 + y),
    "square": lambda x, y: (x - y) ** 2,
    "cube": lambda x, y: (x - y) ** 3,
    "fourth power": lambda x, y: (x + y) ** 4,
    "negative power": lambda x, y: (4 + x) ** -3,
    "broken power": lambda x, y: (4 + x) ** 1.5,
    "power of a symbol": lambda x, y: (4 + x) ** y,
    "inverse": lambda x, y: 1 / (3 + x),
    "root": lambda x, y: ca.sqrt(x**2 + y**2 + 0.01),
    "sine": lambda x, y: ca.sin(3 * x + y),
    "cosine": lambda x, y: ca.cos(4 * x * y),
    "tangent": lambda x, y: ca.tan(0.5 * x),
    "angle": lambda x, y: ca.atan2(y, 3 + x),
    "arc functions": lambda x, y: ca.atan(x) + ca.asin(0.3 * x) + ca.acos(0.3 * y),
    "exponential": lambda x, y: ca.exp(x) - ca.log(4 + y),
    "hyperbolic": lambda x, y: ca.sinh(x) + ca.cosh(x - y) + ca.tanh(y),
    "magnitude": lambda x, y: ca.fabs(x) + ca.sign(y),
    "extremes": lambda x, y: ca.fmax(x, y) - 2 * ca.fmin(x, y) + 1.5,
}


def boxes(width, count=200, seed=7):
    random = np.random.default_rng(seed)
    lower = random.uniform(-2, 2 - width, size=(count, 2))
    return lower, lower + width * random.random((count, 2))


def function_of(name):
    x = ca.SX.sym("x", 2)
    return ca.Function("f", [x], [OPERATIONS[name](x[0], x[1])])


@pytest.mark.parametrize("name", OPERATIONS)
@pytest.mark.parametrize("width", [0.0, 1e-3, 1.0])
def test_every_value_in_the_box_is_enclosed(name, width):
    lower, upper = boxes(width)
    function = function_of(name)
    ((low, high),) = enclosed(function, [lower], [upper])
    random = np.random.default_rng(1)
    for share in [np.zeros((1, 2)), np.ones((1, 2)), *random.random((20, 1, 2))]:
        places = lower + share * (upper - lower)
        values = np.array(function.map(len(places))(places.T).full()[0])
        assert np.all(low[:, 0] <= values)
        assert np.all(values <= high[:, 0])


@pytest.mark.parametrize("name", sorted(set(OPERATIONS) - {"magnitude"}))
def test_a_point_is_enclosed_to_rounding(name):
    lower, _ = boxes(0.0)
    ((low, high),) = enclosed(function_of(name), [lower], [lower])
    assert np.all(high - low <= 1e-12 * (1 + np.abs(low)))


def test_a_pole_inside_the_box_opens_the_enclosure():
    x = ca.SX.sym("x")
    function = ca.Function("f", [x], [1 / x, ca.tan(x)])
    (inverse, tangent) = enclosed(function, [np.array([[-1.0]])], [np.array([[2.0]])])
    assert inverse[0][0, 0] == -np.inf
    assert inverse[1][0, 0] == np.inf
    assert tangent[0][0, 0] == -np.inf


def test_an_unknown_operation_is_named():
    x = ca.SX.sym("x")
    function = ca.Function("f", [x], [ca.if_else(x > 0, 1, 2)])
    with pytest.raises(NotImplementedError, match="operation"):
        enclosed(function, [np.zeros((1, 1))], [np.ones((1, 1))])
