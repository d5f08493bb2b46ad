"""Wide integers: exact numbers of many bits, on which formulas run unchanged.

Binary fractions are integers in a common unit, and so are their sums and products. In compiled code
`wide` returns an integer of two or more limbs of 64 bits. A product has the bits of both factors
together, and never overflows; a sum has the bits of its terms, and needs spare ones. Without
compilation, wide integers are Python's integers.
"""

from __future__ import annotations

import itertools
import math
import operator
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, overload, register_model

# The format of floating-point numbers: the number of bits of the mantissa, the mask of the bits of
# the mantissa that are stored, and the exponent of the last bit of the smallest numbers.
MANTISSA, FRACTION, LOWEST = 53, (1 << 52) - 1, -1074
LIMB, PAIR, BIT = ir.IntType(64), ir.IntType(128), ir.IntType(1)


class Wide(types.Type):
    """The type of integers with some number of bits, in compiled code."""

    def __init__(self, bits: int) -> None:
        """Name the type by its bits."""
        self.bits = bits
        super().__init__(f"Wide({bits})")


@register_model(Wide)
class WideModel(models.PrimitiveModel):
    """The data model: integers of LLVM."""

    def __init__(self, manager: Any, kind: Wide) -> None:
        """Use the integer type of LLVM with the same number of bits."""
        super().__init__(manager, kind, ir.IntType(kind.bits))


# --- conversions ----------------------------------------------------------------------------------


def wide(value, unit, limbs) -> Any:
    """Return value / 2^unit, an integer with as many limbs as the tuple `limbs` has entries.

    Its type depends on the length of the tuple only.
    """
    mantissa, exponent = math.frexp(value)
    return int(math.ldexp(mantissa, MANTISSA)) << max(exponent - MANTISSA - unit, 0)


def rounded(x) -> Any:
    """Return the floating-point number that is nearest to a wide integer."""
    return float(x)


@intrinsic
def shifted(_: Any, mantissa: Any, shift: Any, limbs: Any) -> Any:
    """Return mantissa × 2^shift as a wide integer."""

    def emit(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        kind = ir.IntType(signature.return_type.bits)
        within = builder.zext(builder.and_(values[1], LIMB(63)), PAIR)
        moved = builder.sext(builder.shl(builder.sext(values[0], PAIR), within), kind)
        value = moved
        for k in range(1, kind.width // LIMB.width):
            beyond = builder.icmp_signed(">=", values[1], LIMB(64 * k))
            value = builder.select(beyond, builder.shl(moved, kind(64 * k)), value)
        return value

    return Wide(LIMB.width * limbs.count)(types.int64, types.int64, limbs), emit


@intrinsic
def leading(_: Any, x: Any) -> Any:
    """Return the first 63 bits of a number, with its sign, and the exponent of the last of them.

    The last bit is set if any bit beyond it is set, so that the result rounds like the number
    itself.
    """

    def emit(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        (x,) = values
        negative = builder.icmp_signed("<", x, x.type(0))
        pieces = limbs(builder, builder.select(negative, builder.neg(x), x))
        # The first limb that is not zero, and the next one.
        window, exponent, rest, below = PAIR(0), LIMB(0), PAIR(0), PAIR(0)
        for k, (low, high) in enumerate(itertools.pairwise(pieces)):
            some = builder.icmp_unsigned("!=", high, PAIR(0)) if k else BIT(1)
            pair = builder.or_(builder.shl(high, PAIR(64)), low)
            window = builder.select(some, pair, window)
            exponent = builder.select(some, LIMB(64 * k), exponent)
            rest = builder.select(some, below, rest)
            below = builder.or_(below, low)
        shift = builder.ctlz(window, BIT(0))
        window = builder.shl(window, builder.and_(shift, PAIR(127)))
        rest = builder.or_(rest, builder.shl(window, PAIR(63)))
        top = builder.trunc(builder.lshr(window, PAIR(65)), LIMB)
        top = builder.or_(top, builder.zext(builder.icmp_unsigned("!=", rest, PAIR(0)), LIMB))
        exponent = builder.add(exponent, builder.sub(LIMB(65), builder.trunc(shift, LIMB)))
        top = builder.select(negative, builder.neg(top), top)
        return context.make_tuple(builder, signature.return_type, (top, exponent))

    return types.UniTuple(types.int64, 2)(x), emit


@overload(wide)
def _wide(value, unit, limbs):
    def compiled(value, unit, limbs):
        code = np.float64(value).view(np.int64)
        power = code >> 52 & 2047
        mantissa = code & FRACTION | (FRACTION + 1 if power > 0 else 0)
        shift = max(max(power - 1, 0) + LOWEST - unit, 0)
        return shifted(-mantissa if code < 0 else mantissa, shift, limbs)  # pyright: ignore[reportCallIssue]

    return compiled


@overload(rounded)
def _rounded(x):
    def compiled(x):
        bits, exponent = leading(x)  # pyright: ignore[reportCallIssue]
        return math.ldexp(float(bits), exponent)

    return compiled


# --- operators in compiled code -------------------------------------------------------------------


def operation(symbol: Any, *kinds: Any) -> Callable[[Any], Any]:
    """Register the result type of an operator on types; the decorated function emits its code."""

    def register(emit: Any) -> Any:
        class Template(AbstractTemplate):
            metadata: ClassVar = {"target": "cpu"}

            def generic(self, args: Any, kws: Any) -> Any:
                if len(args) == len(kinds) and all(map(isinstance, args, kinds)):
                    bits = [x.bits for x in args if isinstance(x, Wide)]
                    total = sum(bits) if symbol is operator.mul else max(bits)
                    return signature(Wide(total), *args)
                return None

        infer_global(symbol)(Template)  # pyright: ignore[reportOptionalCall]
        lower_builtin(symbol, *kinds)(lambda _, builder, signature, values: emit(builder, *values))
        return emit

    return register


operation(operator.add, Wide, Wide)(ir.IRBuilder.add)
operation(operator.sub, Wide, Wide)(ir.IRBuilder.sub)
operation(operator.neg, Wide)(ir.IRBuilder.neg)


@operation(operator.mul, types.Integer, Wide)
def weighted(builder: Any, weight: Any, x: Any) -> Any:
    """Emit the product of a wide integer and a small weight, which must fit into the spare bits."""
    return builder.mul(builder.sext(weight, x.type), x)


@operation(operator.mul, Wide, Wide)
def product(builder: Any, x: Any, y: Any) -> Any:
    """Emit a call of the function that multiplies two numbers of these types."""
    name = f"wide_product_{x.type.width}_{y.type.width}"
    function = builder.module.globals.get(name)
    if function is None:
        kind = ir.IntType(x.type.width + y.type.width)
        function = ir.Function(builder.module, ir.FunctionType(kind, (x.type, y.type)), name)
        function.linkage = "internal"
        inside = ir.IRBuilder(function.append_basic_block())
        inside.ret(long_product(inside, *function.args))
    return builder.call(function, (x, y))


def long_product(builder: Any, x: Any, y: Any) -> Any:
    """Emit the product of two numbers limb by limb.

    The numbers are first read as unsigned; the surplus of negative numbers is then subtracted.
    """
    kind = ir.IntType(x.type.width + y.type.width)
    a, b = limbs(builder, x), limbs(builder, y)
    total = [PAIR(0)] * (len(a) + len(b))
    for i, left in enumerate(a):
        carry = PAIR(0)
        for j, right in enumerate(b):
            added = builder.add(builder.mul(left, right), builder.add(total[i + j], carry))
            total[i + j] = builder.zext(builder.trunc(added, LIMB), PAIR)
            carry = builder.lshr(added, PAIR(64))
        total[i + len(b)] = carry
    value = kind(0)
    for k, limb in enumerate(total):
        value = builder.or_(value, builder.shl(builder.zext(limb, kind), kind(64 * k)))
    for z, other in (x, y), (y, x):
        # Read as unsigned, a negative number is too large by a power of two.
        surplus = builder.shl(builder.zext(other, kind), kind(z.type.width))
        negative = builder.icmp_signed("<", z, z.type(0))
        value = builder.sub(value, builder.select(negative, surplus, kind(0)))
    return value


def limbs(builder: Any, x: Any) -> list[Any]:
    """Emit the limbs (64 bits) of a number, each as an integer of 128 bits."""
    places = range(0, x.type.width, LIMB.width)
    pieces = (builder.trunc(builder.lshr(x, x.type(place)), LIMB) for place in places)
    return [builder.zext(piece, PAIR) for piece in pieces]
