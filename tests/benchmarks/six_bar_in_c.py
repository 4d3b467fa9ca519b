"""The six-bar of `six_bar` in C by hand: point G with velocity and acceleration, plainly and eight poses at a time.

The second uses the vector extensions of gcc, a polynomial for sine and cosine, and fused multiplications, so that it
runs at the speed of the arithmetic units. Both write complex numbers, as NumPy holds them. *everything* is written as
the second: position, velocity and acceleration of four points, and angle, its rate and acceleration of four links.
"""

from __future__ import annotations

import ctypes
import subprocess
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from tests.benchmarks import six_bar

HEAD = r"""
#include <math.h>
#include <string.h>
#define ED %(ED)r
#define DA %(DA)r
#define AB %(AB)r
#define FG %(FG)r
#define DCX %(DCX)r
#define DCY %(DCY)r
#define BX %(BX)r
#define FY (%(FY)r)
"""

# The arithmetic of both, on numbers or vectors T, with the crank's cosine c and sine s.
BODY = r"""
    T dx = ED * c, dy = ED * s;
    T vdx = -w * dy, vdy = w * dx, adx = -w * w * dx, ady = -w * w * dy;
    T lx = BX - dx, ly = -dy;
    T inverse = 1.0 / (lx * lx + ly * ly);
    T foot = 0.5 + (DA * DA - AB * AB) * 0.5 * inverse;
    T h = ROOT(DA * DA * inverse - foot * foot);
    T ax = lx * foot + ly * h, ay = ly * foot - lx * h;
    T rx = ax - lx, ry = ay - ly;
    T det = 1.0 / (ax * ry - ay * rx);
    T w2 = -(vdx * rx + vdy * ry) * det, w3 = -(vdx * ax + vdy * ay) * det;
    T q2 = w2 * w2, q3 = w3 * w3;
    T al2 = -((adx - q2 * ax + q3 * rx) * rx + (ady - q2 * ay + q3 * ry) * ry) * det;
    T ox = ax * (DCX / DA) - ay * (DCY / DA), oy = ax * (DCY / DA) + ay * (DCX / DA);
    T sx = dx + ox, sy = dy + oy - FY;
    T vx = vdx - w2 * oy, vy = vdy + w2 * ox;
    T bx = adx - q2 * ox - al2 * oy, by = ady - q2 * oy + al2 * ox;
    T inv2 = 1.0 / (sx * sx + sy * sy);
    T long_ = FG * ROOT(inv2);
    T w4 = (sx * vy - sy * vx) * inv2;
    T al4 = (sx * by - sy * bx - 2.0 * w4 * (sx * vx + sy * vy)) * inv2;
    T tx = sx * long_, ty = sy * long_, q4 = w4 * w4;
    T g[6] = {tx, ty + FY, -w4 * ty, w4 * tx, -q4 * tx - al4 * ty, al4 * tx - q4 * ty};
"""

PLAIN = (
    r"""
typedef double T;
#define ROOT sqrt
void six_bar(const double *crank, double w, double *place, double *speed, double *acceleration, long n) {
  for (long k = 0; k < n; k++) {
    T c = cos(crank[k]), s = sin(crank[k]);
"""
    + BODY
    + r"""
    place[2 * k] = g[0]; place[2 * k + 1] = g[1];
    speed[2 * k] = g[2]; speed[2 * k + 1] = g[3];
    acceleration[2 * k] = g[4]; acceleration[2 * k + 1] = g[5];
  }
}
"""
)

LANES = r"""
typedef double T __attribute__((vector_size(64)));
typedef long L __attribute__((vector_size(64)));
typedef double U __attribute__((vector_size(64), aligned(8)));
static inline T ROOT(T x) { T y; for (int k = 0; k < 8; k++) y[k] = sqrt(x[k]); return y; }
static inline void turn(T x, T *c, T *s) {
  T m = x * 0.63661977236758134308 + 6755399441055744.0, k = m - 6755399441055744.0;
  T r = ((x - k * 1.57079632673412561417) - k * 6.07710050630396597660e-11) - k * 2.02226624879595063154e-21;
  T z = r * r;
  T p = r + r * z * (-1.66666666666666324348e-01 + z * (8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04
      + z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)))));
  T q = 1.0 - 0.5 * z + z * z * (4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03
      + z * (2.48015872894767294178e-05 + z * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09
      + z * -1.13596475577881948265e-11)))));
  L n = (L)m, odd = -(n & 1);
  L one = (L)p, two = (L)q;
  *s = (T)(((one & ~odd) | (two & odd)) ^ ((n & 2) << 62));
  *c = (T)(((two & ~odd) | (one & odd)) ^ (((n + 1) & 2) << 62));
}
static inline void put(double *out, T x, T y) {
  *(U *)out = __builtin_shufflevector(x, y, 0, 8, 1, 9, 2, 10, 3, 11);
  *(U *)(out + 8) = __builtin_shufflevector(x, y, 4, 12, 5, 13, 6, 14, 7, 15);
}
"""

VECTORS = (
    LANES
    + r"""
static inline void eight(T x, double w, double *place, double *speed, double *acceleration) {
    T c, s;
    turn(x, &c, &s);
"""
    + BODY
    + r"""
    put(place, g[0], g[1]); put(speed, g[2], g[3]); put(acceleration, g[4], g[5]);
}
void six_bar(const double *crank, double w, double *place, double *speed, double *acceleration, long n) {
  long k = 0;
  for (; k + 8 <= n; k += 8)
    eight(*(const U *)(crank + k), w, place + 2 * k, speed + 2 * k, acceleration + 2 * k);
  if (k < n) {
    double in[8] = {0}, out[3][16];
    memcpy(in, crank + k, (n - k) * sizeof(double));
    eight(*(const U *)in, w, out[0], out[1], out[2]);
    memcpy(place + 2 * k, out[0], (n - k) * 16);
    memcpy(speed + 2 * k, out[1], (n - k) * 16);
    memcpy(acceleration + 2 * k, out[2], (n - k) * 16);
  }
}
"""
)

# The arctangent is that of S. L. Moshier's Cephes library (atan.c): a rational function below 0.66, of (z - 1)/(z + 1)
# above. Angles are made continuous along the motion after.
EVERYTHING = (
    LANES
    + r"""
static inline T choose(L yes, T one, T other) { return (T)(((L)one & yes) | ((L)other & ~yes)); }
static inline T angle(T y, T x) {
  L minus = (L)x < 0, signs = (L)y & (1L << 63);
  T a = (T)((L)x & ~(1L << 63)), b = (T)((L)y & ~(1L << 63));
  L steep = b > a;
  T z = choose(steep, a, b) / choose(steep, b, a);
  L far = z > 0.66;
  T one = z * 0.0 + 1.0;
  z = choose(far, z - 1.0, z) / choose(far, z + 1.0, one);
  T s = z * z;
  T p = s * ((((-8.750608600031904122785e-1 * s - 1.615753718733365076637e1) * s - 7.500855792314704667340e1) * s
      - 1.228866684490136173410e2) * s - 6.485021904942025371773e1)
      / (((((s + 2.485846490142306297962e1) * s + 1.650270098316988542046e2) * s + 4.328810604912902668951e2) * s
      + 4.853903996359136964868e2) * s + 1.945506571482613964425e2);
  T found = z * p + z + choose(far, one * 7.85398163397448309616e-1, one * 0.0);
  found = choose(steep, 1.57079632679489661923 - found, found);
  found = choose(minus, 3.14159265358979323846 - found, found);
  return (T)((L)found ^ signs);
}
static inline void eight(T x, double w, double **out, long k) {
    T c, s;
    turn(x, &c, &s);
"""
    + BODY
    + r"""
    T al3 = -((adx - q2 * ax + q3 * rx) * ax + (ady - q2 * ay + q3 * ry) * ay) * det;
    T one = x * 0.0 + 1.0;
    double **o = out;
    put(*o++ + 2 * k, dx, dy); put(*o++ + 2 * k, vdx, vdy); put(*o++ + 2 * k, adx, ady);
    put(*o++ + 2 * k, dx + ax, dy + ay); put(*o++ + 2 * k, -w3 * ry, w3 * rx);
    put(*o++ + 2 * k, -q3 * rx - al3 * ry, al3 * rx - q3 * ry);
    put(*o++ + 2 * k, sx, sy + FY); put(*o++ + 2 * k, vx, vy); put(*o++ + 2 * k, bx, by);
    for (int i = 0; i < 6; i += 2) put(*o++ + 2 * k, g[i], g[i + 1]);
    T links[12] = {x, w * one, 0.0 * one, angle(ay, ax), w2, al2, angle(ry, rx), w3, al3, angle(sy, sx), w4, al4};
    for (int i = 0; i < 12; i++) *(U *)(*o++ + k) = links[i];
}
void six_bar(const double *crank, double w, double **out, long n) {
  long k = 0;
  for (; k + 8 <= n; k += 8) eight(*(const U *)(crank + k), w, out, k);
  if (k < n) {
    double in[8] = {0}, some[24][16], *rows[24];
    memcpy(in, crank + k, (n - k) * sizeof(double));
    for (int i = 0; i < 24; i++) rows[i] = some[i];
    eight(*(const U *)in, w, rows, 0);
    for (int i = 0; i < 24; i++) memcpy(out[i] + (i < 12 ? 2 * k : k), some[i], (n - k) * (i < 12 ? 16 : 8));
  }
  for (int i = 15; i < 24; i += 3) {
    double turns = 0.0, before = out[i][0];
    for (k = 1; k < n; k++) {
      double now = out[i][k];
      if (fabs(now - before) > 3.14159265358979323846) turns -= now > before ? 1.0 : -1.0;
      before = now;
      if (turns) out[i][k] += turns * 6.28318530717958647692;
    }
  }
}
"""
)

# What *everything* writes, in its order.
RATES = ("position", "velocity", "acceleration"), ("angle", "angular_velocity", "angular_acceleration")
OUTPUTS = [f"{one}.{word}" for many, words in zip((six_bar.POINTS, six_bar.LINKS), RATES, strict=True)
           for one in many for word in words]  # fmt: skip
TEXTS, WHOLE = {"plain": PLAIN, "vectors": VECTORS}, {"everything": EVERYTHING}
Call = Callable[[Any, list[Any]], None]


@cache
def compiled(kind: str) -> Call:
    """A function of crank angles and the arrays that it fills; raises OSError where there is no gcc."""
    numbers = {name: getattr(six_bar, name) for name in ("ED", "DA", "AB", "FG")}
    numbers |= {"DCX": six_bar.DC.real, "DCY": six_bar.DC.imag, "BX": six_bar.B.real, "FY": six_bar.F.imag}
    folder = Path(tempfile.mkdtemp())
    source, library = folder / "six_bar.c", folder / "six_bar.so"
    source.write_text(HEAD % {name: float(value) for name, value in numbers.items()} + (TEXTS | WHOLE)[kind])
    options = [
        "-O3",
        "-march=native",
        "-ffp-contract=fast",
        "-fno-math-errno",
        "-fno-trapping-math",
        "-shared",
        "-fPIC",
    ]
    subprocess.run(["gcc", *options, "-o", library, source, "-lm"], check=True)
    function = ctypes.CDLL(str(library)).six_bar
    pointer = ctypes.c_void_p
    outputs = [pointer] if kind in WHOLE else [pointer] * 3
    function.argtypes, function.restype = [pointer, ctypes.c_double, *outputs, ctypes.c_long], None

    def call(crank: Any, found: list[Any]) -> None:
        if kind in WHOLE:
            places = (pointer * len(found))(*(array.ctypes.data for array in found))
            function(crank.ctypes.data, six_bar.SPEED, places, len(crank))
            return
        function(crank.ctypes.data, six_bar.SPEED, *(array.ctypes.data for array in found), len(crank))

    return call


def asked(kind: str, crank: Any) -> list[Any]:
    """Position, velocity and acceleration of G."""
    found = [np.empty(len(crank), complex) for _ in range(3)]
    compiled(kind)(crank, found)
    return found


def everything(crank: Any) -> list[Any]:
    """All of `OUTPUTS`."""
    found = [np.empty(len(crank), complex) for _ in range(12)] + [np.empty(len(crank)) for _ in range(12)]
    compiled("everything")(crank, found)
    return found
