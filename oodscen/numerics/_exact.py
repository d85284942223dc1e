"""Elementary functions in plain arithmetic, with identical bits on every machine.

The last bit of a sine from `math`, NumPy or a processor's vector library differs between machines.
These functions use only `+ - * /`, square roots, comparisons and exact scaling by powers of two, all
of which IEEE 754 defines to the last bit. All motion is computed with them, so that positions do not
depend on the installed libraries.

They give the same bits in plain Python and inside kernels (`oodscen.numerics._kernels`). They
agree with `math` to 1e-12 or better; the polynomials and reductions are those of FDLIBM (Sun
Microsystems, 1993). Arguments must be finite floats.
"""

import math
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from oodscen.numerics._kernels import part

Floats = NDArray[np.float64]
Real = TypeVar("Real", float, Floats)

PI = 3.141592653589793
TAU = 6.283185307179586
HALF_PI = 1.5707963267948966

_HALF_PI_HIGH = 1.57079632673412561417
"""The first 33 bits of pi/2; the next two constants hold the bits after them."""
_HALF_PI_MIDDLE = 6.07710050630396597660e-11
_HALF_PI_LOW = 2.02226624879595063154e-21

_LN2 = 0.6931471805599453
_LN2_HIGH = 6.93147180369123816490e-01
_LN2_LOW = 1.90821492927058770002e-10


@part
def quantised(value: float) -> float:
    """Round to 1e-6, half upwards, and never to minus zero."""
    return math.floor(value * 1e6 + 0.5) / 1e6


@part
def wrapped(angle: float) -> float:
    """Return the equivalent angle in (-pi, pi], to within the last bit or two."""
    if -PI < angle <= PI:
        return angle
    return angle - TAU * math.ceil(angle / TAU - 0.5)


@part
def _sine_series(z: Real) -> Real:
    """Return (sin y / y - 1) / z for z = y * y, |y| <= pi / 4."""
    total = -2.50507602534068634195e-08 + z * 1.58969099521155010221e-10
    total = 2.75573137070700676789e-06 + z * total
    total = -1.98412698298579493134e-04 + z * total
    total = 8.33333333332248946124e-03 + z * total
    return -1.66666666666666324348e-01 + z * total


@part
def _cosine_series(z: Real) -> Real:
    """Return (cos y - 1 + z / 2) / z^2 for z = y * y, |y| <= pi / 4."""
    total = 2.08757232129817482790e-09 + z * -1.13596475577881948265e-11
    total = -2.75573143513906633035e-07 + z * total
    total = 2.48015872894767294178e-05 + z * total
    total = -1.38888888888741095749e-03 + z * total
    return 4.16666666666666019037e-02 + z * total


@part
def sincos(x: float) -> tuple[float, float]:
    """Return the sine and cosine of an angle of up to a million radians."""
    turns = math.floor(x / HALF_PI + 0.5)
    y = ((x - turns * _HALF_PI_HIGH) - turns * _HALF_PI_MIDDLE) - turns * _HALF_PI_LOW
    z = y * y
    sine = y + y * z * _sine_series(z)
    cosine = 1.0 - 0.5 * z + z * z * _cosine_series(z)
    quadrant = turns % 4
    if quadrant == 0:
        return sine, cosine
    if quadrant == 1:
        return cosine, -sine
    if quadrant == 2:
        return -sine, -cosine
    return -cosine, sine


@part
def sin(x: float) -> float:
    """Return the sine of an angle of up to a million radians."""
    return sincos(x)[0]


@part
def cos(x: float) -> float:
    """Return the cosine of an angle of up to a million radians."""
    return sincos(x)[1]


@part
def tan(x: float) -> float:
    """Return the tangent of an angle of up to a million radians."""
    sine, cosine = sincos(x)
    return sine / cosine


@part
def atan(x: float) -> float:
    """Return the arc tangent."""
    size = abs(x)
    if size < 0.4375:
        base, y = 0.0, size
    elif size < 0.6875:
        base, y = 4.63647609000806093515e-01, (2.0 * size - 1.0) / (2.0 + size)
    elif size < 1.1875:
        base, y = 7.85398163397448278999e-01, (size - 1.0) / (size + 1.0)
    elif size < 2.4375:
        base, y = 9.82793723247329054082e-01, (size - 1.5) / (1.0 + 1.5 * size)
    else:
        base, y = HALF_PI, -1.0 / size
    z = y * y
    w = z * z
    odd = 4.97687799461593236017e-02 + w * 1.62858201153657823623e-02
    odd = 6.66107313738753120669e-02 + w * odd
    odd = 9.09088713343650656196e-02 + w * odd
    odd = 1.42857142725034663711e-01 + w * odd
    odd = 3.33333333333329318027e-01 + w * odd
    even = -5.83357013379057348645e-02 + w * -3.65315727442169155270e-02
    even = -7.69187620504482999495e-02 + w * even
    even = -1.11111104054623557880e-01 + w * even
    even = -1.99999999998764832476e-01 + w * even
    angle = base + (y - y * (z * odd + w * even))
    return -angle if x < 0.0 else angle


@part
def atan2(y: float, x: float) -> float:
    """Return the angle of a vector in (-pi, pi]; 0 for the zero vector."""
    if x == 0.0 and y == 0.0:
        return 0.0
    if abs(y) > abs(x):
        return HALF_PI - atan(x / y) if y > 0.0 else -HALF_PI - atan(x / y)
    angle = atan(y / x)
    if x > 0.0:
        return angle
    return angle - PI if y < 0.0 else angle + PI


@part
def asin(x: float) -> float:
    """Return the arc sine of a number in [-1, 1]."""
    return atan2(x, math.sqrt((1.0 - x) * (1.0 + x)))


@part
def hypot(x: float, y: float) -> float:
    """Return the length of a vector whose square neither overflows nor underflows."""
    return math.sqrt(x * x + y * y)


@part
def exp(x: float) -> float:
    """Return e to the power of `x`; infinity above 709, 0 below -700."""
    if x > 709.0:
        return math.inf
    if x < -700.0:
        return 0.0
    power = math.floor(x / _LN2 + 0.5)
    high = x - power * _LN2_HIGH
    low = power * _LN2_LOW
    y = high - low
    z = y * y
    c = -1.65339022054652515390e-06 + z * 4.13813679705723846039e-08
    c = 6.61375632143793436117e-05 + z * c
    c = -2.77777777770155933842e-03 + z * c
    c = 1.66666666666666019037e-01 + z * c
    c = y - z * c
    return math.ldexp(1.0 - ((low - y * c / (2.0 - c)) - high), power)


@part
def log(x: float) -> float:
    """Return the natural logarithm of a positive number."""
    share, power = math.frexp(x)
    if share < 0.7071067811865476:
        share *= 2.0
        power -= 1
    f = share - 1.0
    s = f / (2.0 + f)
    z = s * s
    r = 1.531383769920937332e-01 + z * 1.479819860511658591e-01
    r = 1.818357216161805012e-01 + z * r
    r = 2.222219843214978396e-01 + z * r
    r = 2.857142874366239149e-01 + z * r
    r = 3.999999999940941908e-01 + z * r
    r = 6.666666666666735130e-01 + z * r
    r = z * r
    half = 0.5 * f * f
    return power * _LN2_HIGH - ((half - (s * (half + r) + power * _LN2_LOW)) - f)


@part
def power(base: float, exponent: float) -> float:
    """Return a positive number raised to any power."""
    return exp(exponent * log(base))
