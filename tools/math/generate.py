#!/usr/bin/env python3
"""Writes engine/core/math_tables_internal.h: polynomial coefficients and constants of core/math.h.

Every number is derived here, with mpmath at 400 bits: polynomials by the Remez exchange (Remez
1934) with the weight that makes the error of the finished function relative; then each coefficient
is rounded to its type, lowest power first, and the others are fitted again around it, so that the
rounding of one is made good by the rest. Needs mpmath (PyPI); the engine's build does not run this.

    python3 tools/math/generate.py > engine/core/math_tables_internal.h
"""
import struct
import sys

from mpmath import mp, mpf

mp.prec = 400


def round_double(x):
    return mpf(float(x))  # mpmath rounds to nearest, as C reads the literal


def round_float(x):
    return mpf(struct.unpack("f", struct.pack("f", float(x)))[0])


def round_bits(x, bits):
    """Nearest number with `bits` significant bits."""
    mantissa, exponent = mp.frexp(x)
    scale = mpf(2) ** bits
    return mp.nint(mantissa * scale) / scale * mpf(2) ** exponent


def evaluate(coefficients, u):
    total = mpf(0)
    for c in reversed(coefficients):
        total = total * u + c
    return total


class Fit:
    """Weighted minimax fit of a polynomial to g on (0, b]; some low coefficients may be fixed."""

    def __init__(self, g, weight, low, high, points=600):
        self.grid = [low + (high - low) * (1 - mp.cos(mp.pi * (i + mpf(1) / 2) / points)) / 2
                     for i in range(points)]
        self.g = [g(u) for u in self.grid]
        self.w = [weight(u) for u in self.grid]

    def solve(self, fixed, free):
        """Coefficients of u^len(fixed) .. u^(len(fixed)+free-1), by Remez exchange."""
        first = len(fixed)
        target = [g - evaluate(fixed, u) for g, u in zip(self.g, self.grid)]
        n = len(self.grid)
        reference = [int((n - 1) * (1 - float(mp.cos(mp.pi * i / free))) / 2) for i in range(free + 1)]
        best = None
        for _ in range(25):
            a = mp.matrix(free + 1, free + 1)
            b = mp.matrix(free + 1, 1)
            for row, i in enumerate(reference):
                power = self.grid[i] ** first
                for column in range(free):
                    a[row, column] = power
                    power *= self.grid[i]
                a[row, free] = (-1) ** row / self.w[i]
                b[row] = target[i]
            solution = mp.lu_solve(a, b)
            coefficients = [solution[i] for i in range(free)]
            error = [(evaluate([mpf(0)] * first + coefficients, u) - t) * w
                     for u, t, w in zip(self.grid, target, self.w)]
            peak = max(abs(e) for e in error)
            if best is None or peak < best[0]:
                best = (peak, coefficients)
            runs = []  # the extreme of each run of one sign
            for i, e in enumerate(error):
                if runs and (error[runs[-1]] > 0) == (e > 0):
                    if abs(e) > abs(error[runs[-1]]):
                        runs[-1] = i
                else:
                    runs.append(i)
            while len(runs) > free + 1:
                runs.pop(0 if abs(error[runs[0]]) < abs(error[runs[-1]]) else -1)
            if len(runs) < free + 1 or runs == reference:
                break
            reference = runs
        return best

    def rounded(self, count, rounding):
        fixed = []
        while len(fixed) < count:
            _, coefficients = self.solve(fixed, count - len(fixed))
            fixed.append(rounding(coefficients[0]))
        peak = max(abs((evaluate(fixed, u) - g) * w)
                   for u, g, w in zip(self.grid, self.g, self.w))
        return fixed, peak


def literal(value, single):
    return (float(value).hex() if value else "0x0p+0") + ("f" if single else "")


def array(name, values, single=False):
    kind = "float" if single else "double"
    print(f"static const {kind} {name}[{len(values)}] = {{")
    for v in values:
        print(f"    {literal(v, single)},")
    print("};")


def polynomial(comment, name, count, g, weight, low, high, single=False):
    fit = Fit(g, weight, mpf(low), mpf(high))
    coefficients, peak = fit.rounded(count, round_float if single else round_double)
    print(f"// {comment}; relative error of the approximation 2^{float(mp.log(peak, 2)):.1f}")
    array(name, coefficients, single)


def define(name, value, single=False):
    print(f"#define {name} {literal(value, single)}")


def pair(name, value):
    """A value as the unevaluated sum of two doubles."""
    high = round_double(value)
    define(name + "_HI", high)
    define(name + "_LO", round_double(value - high))


def chunks(name, value, bits, single=False):
    """A value as parts of so many bits, the last with all that its type holds."""
    rounding = round_float if single else round_double
    for number, b in enumerate(bits, 1):
        part = rounding(value) if b is None else round_bits(value, b)
        define(f"{name}_{number}", part, single)
        value -= part


def odd(f):
    """g(u) with f(x) = x + x^3 g(x^2), and its weight for relative error."""
    def g(u):
        x = mp.sqrt(u)
        return (f(x) - x) / (x * u)

    def weight(u):
        x = mp.sqrt(u)
        return x * u / f(x)
    return g, weight


def polynomials():
    quarter = mp.pi / 4 * mpf("1.0001")
    tiny = mpf(2) ** -30
    sin_ = odd(mp.sin)
    cos_ = (lambda u: (mp.cos(mp.sqrt(u)) - 1 + u / 2) / u ** 2,
            lambda u: u ** 2 / mp.cos(mp.sqrt(u)))
    asin_, atan_ = odd(mp.asin), odd(mp.atan)
    exp_ = (lambda r: (mp.exp(r) - 1 - r) / r ** 2, lambda r: r ** 2 / mp.exp(r))
    # log(m) with s = (m-1)/(m+1): log(m) = 2 atanh(s) = 2 s + s^3 g(s^2)
    log_ = (lambda u: (2 * mp.atanh(mp.sqrt(u)) / mp.sqrt(u) - 2) / u,
            lambda u: u * mp.sqrt(u) / (2 * mp.atanh(mp.sqrt(u))))
    sinh_ = odd(mp.sinh)
    cosh_ = (lambda u: (mp.cosh(mp.sqrt(u)) - 1 - u / 2) / u ** 2,
             lambda u: u ** 2 / mp.cosh(mp.sqrt(u)))
    log1p_ = (lambda r: (mp.log1p(r) - r + r ** 2 / 2) / r ** 3, lambda r: r ** 3 / mp.log1p(r))
    half_ln2 = mp.log(2) / 2 * mpf("1.001")

    polynomial("sin(x) = x + x^3 p(x^2), |x| <= pi/4", "poly_sin", 6, *sin_, tiny, quarter ** 2)
    polynomial("cos(x) = 1 - x^2/2 + x^4 p(x^2), |x| <= pi/4", "poly_cos", 6, *cos_, tiny,
               quarter ** 2)
    polynomial("asin(x) = x + x^3 p(x^2), |x| <= 1/2", "poly_asin", 13, *asin_, tiny,
               mpf("0.2501"))
    polynomial("atan(x) = x + x^3 p(x^2), |x| <= 7/32", "poly_atan", 8, *atan_, tiny,
               mpf("0.04795"))
    polynomial("exp(x) = 1 + x + x^2 p(x), |x| <= ln(2)/2", "poly_exp", 11, *exp_, -half_ln2,
               half_ln2)
    polynomial("log(1+x) = x - x^2/2 + x^3 p(x), |x| <= 1/150", "poly_log1p", 7, *log1p_,
               mpf(-1) / 150, mpf(1) / 150)
    polynomial("sinh(x) = x + x^3 p(x^2), |x| <= 1", "poly_sinh", 7, *sinh_, tiny, mpf("1.0001"))
    polynomial("cosh(x) = 1 + x^2/2 + x^4 p(x^2), |x| <= 0.6", "poly_cosh", 5, *cosh_, tiny,
               mpf("0.3601"))
    print()
    polynomial("float: sin(x) = x + x^3 p(x^2), |x| <= pi/4", "poly_sinf", 3, *sin_, tiny,
               quarter ** 2, True)
    polynomial("float: cos(x) = 1 - x^2/2 + x^4 p(x^2), |x| <= pi/4", "poly_cosf", 3, *cos_, tiny,
               quarter ** 2, True)
    polynomial("float: asin(x) = x + x^3 p(x^2), |x| <= 1/2", "poly_asinf", 5, *asin_, tiny,
               mpf("0.2501"), True)
    polynomial("float: atan(x) = x + x^3 p(x^2), |x| <= tan(pi/8)", "poly_atanf", 5, *atan_, tiny,
               mp.tan(mp.pi / 8) ** 2 * mpf("1.0001"), True)
    polynomial("float: exp(x) = 1 + x + x^2 p(x), |x| <= ln(2)/2", "poly_expf", 5, *exp_,
               -half_ln2, half_ln2, True)
    polynomial("float: log(m) = 2s + s^3 p(s^2), s = (m-1)/(m+1), m in [sqrt(1/2), sqrt(2)]",
               "poly_logf", 3, *log_, tiny, (3 - 2 * mp.sqrt(2)) ** 2 * mpf("1.0001"), True)


def constants():
    half_pi = mp.pi / 2
    print("// pi/2 in parts whose products with a whole number below 2^20 are exact")
    chunks("HALF_PI", half_pi, [33, 33, 33, None])
    pair("HALF_PI", half_pi)
    pair("PI", mp.pi)
    define("TWO_OVER_PI", round_double(2 / mp.pi))
    print("// ln 2: the first part times a whole number below 2^11 is exact")
    chunks("LN2", mp.log(2), [41, None])
    define("ONE_OVER_LN2", round_double(1 / mp.log(2)))
    pair("LOG2_E", 1 / mp.log(2))
    pair("LOG10_E", 1 / mp.log(10))
    pair("LOG10_2", mp.log(2) / mp.log(10))
    print("// float: pi/2 in parts whose products with a whole number below 2^8 are exact")
    chunks("HALF_PIF", half_pi, [16, 16, 16, None], True)
    define("TWO_OVER_PIF", round_float(2 / mp.pi), True)
    print("// float: pi/4; the first part times 0..4 is exact")
    chunks("QUARTER_PIF", mp.pi / 4, [22, None], True)
    define("TAN_PI_8F", round_float(mp.tan(mp.pi / 8)), True)
    chunks("LN2F", mp.log(2), [15, None], True)
    define("ONE_OVER_LN2F", round_float(1 / mp.log(2)), True)


def log_table():
    """Around i/128: a short reciprocal c near 128/i, and -log(c) as a pair of doubles."""
    print("// [i - 90]: c with at most 11 bits, near 128/i; then -log(c), high and low part")
    print("static const double table_log[92][3] = {")
    for i in range(90, 182):
        c = mp.nint(mpf(128) / i * 1024) / 1024
        value = -mp.log(c)
        high = round_double(value)
        print(f"    {{{literal(c, False)}, {literal(high, False)}, "
              f"{literal(round_double(value - high), False)}}},")
    print("};")


def atan_table():
    print("// [i]: atan(i/16), high and low part")
    print("static const double table_atan[17][2] = {")
    for i in range(17):
        value = mp.atan(mpf(i) / 16)
        high = round_double(value)
        print(f"    {{{literal(high, False)}, {literal(round_double(value - high), False)}}},")
    print("};")


def two_over_pi():
    """Bits of 2/pi after the binary point, enough for the largest double (Payne, Hanek 1983)."""
    words = 20
    mp.prec = 64 * words + 100
    value = int(mp.floor(2 / mp.pi * mpf(2) ** (64 * words)))
    mp.prec = 400
    print("// 2/pi: its first 1280 bits after the point, most significant word first")
    print(f"static const uint64_t table_two_over_pi[{words}] = {{")
    for i in range(words):
        print(f"    0x{(value >> (64 * (words - 1 - i))) & (2 ** 64 - 1):016x}u,")
    print("};")


def main():
    print("// Written by tools/math/generate.py, which says how each number was derived. Do not edit.")
    print("#ifndef CORE_MATH_TABLES_INTERNAL_H\n#define CORE_MATH_TABLES_INTERNAL_H\n\n#include <stdint.h>\n")
    print("// clang-format off")
    constants()
    polynomials()
    log_table()
    atan_table()
    two_over_pi()
    print("// clang-format on\n\n#endif")
    return 0


if __name__ == "__main__":
    sys.exit(main())
