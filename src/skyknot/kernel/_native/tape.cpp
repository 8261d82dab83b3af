#include "tape.hpp"

#include <algorithm>

#include "exponential.hpp"
#include "library.hpp"
#include "trigonometric.hpp"

namespace skyknot::inline SKYKNOT_ISA {
namespace {

// A comparison as CasADi's number: 1 where true, 0 where false.
template <int L>
SKYKNOT_INLINE Lanes<L> truth(const Bits<L>& where) {
    return select(where, Lanes<L>::all(1.0), Lanes<L>::all(0.0));
}

// As in C: of a number and a NaN, the number.
template <int L>
SKYKNOT_INLINE Lanes<L> least(const Lanes<L>& a, const Lanes<L>& b) {
    return select((a <= b) | (b != b), a, b);
}
template <int L>
SKYKNOT_INLINE Lanes<L> greatest(const Lanes<L>& a, const Lanes<L>& b) {
    return select((a >= b) | (b != b), a, b);
}

template <int L>
SKYKNOT_INLINE Lanes<L> sign_of(const Lanes<L>& a) {
    return select((a == 0.0) | (a != a), a, copy_sign(Lanes<L>::all(1.0), a));
}

}  // namespace

template <int L>
void Tape::prepare(double* workspace) const {
    double* slot = workspace + inputs() * L;
    for (double constant : program_.constants) {
        Lanes<L>::all(constant).store(slot);
        slot += L;
    }
}

#define SKYKNOT_CASE(name, value)                                    \
    case Operation::name:                                            \
        for (; step != end; ++step) (value).store(at(step->result)); \
        break;

template <int L>
void Tape::run(double* w) const {
    const auto at = [w](std::uint32_t slot) SKYKNOT_LAMBDA { return w + std::size_t{slot} * L; };
    const Lanes<L> zero = Lanes<L>::all(0.0);
    const Instruction* step = program_.instructions.data();
    const auto a = [&]() SKYKNOT_LAMBDA { return Lanes<L>::load(at(step->a)); };
    const auto b = [&]() SKYKNOT_LAMBDA { return Lanes<L>::load(at(step->b)); };
    const auto c = [&]() SKYKNOT_LAMBDA { return Lanes<L>::load(at(step->c)); };
    for (const Run& run : program_.runs) {
        const Instruction* const end = step + run.length;
        switch (run.operation) {
            SKYKNOT_CASE(add, a() + b())
            SKYKNOT_CASE(sub, a() - b())
            SKYKNOT_CASE(mul, a() * b())
            SKYKNOT_CASE(div, a() / b())
            SKYKNOT_CASE(mul_add, a() * b() + c())
            SKYKNOT_CASE(mul_sub, a() * b() - c())
            SKYKNOT_CASE(sub_mul, c() - a() * b())
            SKYKNOT_CASE(neg, -a())
            SKYKNOT_CASE(sq, a() * a())
            SKYKNOT_CASE(twice, a() + a())
            SKYKNOT_CASE(inv, 1.0 / a())
            SKYKNOT_CASE(sqrt, square_root(a()))
            SKYKNOT_CASE(fabs, absolute(a()))
            SKYKNOT_CASE(floor, round_down(a()))
            SKYKNOT_CASE(ceil, -round_down(-a()))
            SKYKNOT_CASE(fmin, least(a(), b()))
            SKYKNOT_CASE(fmax, greatest(a(), b()))
            SKYKNOT_CASE(sign, sign_of(a()))
            SKYKNOT_CASE(copysign, copy_sign(a(), b()))
            SKYKNOT_CASE(lt, truth(a() < b()))
            SKYKNOT_CASE(le, truth(a() <= b()))
            SKYKNOT_CASE(eq, truth(a() == b()))
            SKYKNOT_CASE(ne, truth(a() != b()))
            SKYKNOT_CASE(not_, truth(a() == zero))
            SKYKNOT_CASE(and_, truth((a() != zero) & (b() != zero)))
            SKYKNOT_CASE(or_, truth((a() != zero) | (b() != zero)))
            SKYKNOT_CASE(if_else_zero, select(a() != zero, b(), zero))
            SKYKNOT_CASE(sin, sine(a()))
            SKYKNOT_CASE(cos, cosine(a()))
            SKYKNOT_CASE(tan, tangent(a()))
            SKYKNOT_CASE(exp, exponential(a()))
            SKYKNOT_CASE(log, logarithm(a()))
            SKYKNOT_CASE(tanh, hyperbolic_tangent(a()))
            case Operation::sin_cos:
                for (; step != end; ++step) {
                    const SineCosine<L> pair = sine_cosine(a());
                    pair.sine.store(at(step->result));
                    pair.cosine.store(at(step->c));
                }
                break;
            default:
                for (; step != end; ++step)
                    library_lanes<L>(run.operation, at(step->a), at(step->b), at(step->result));
        }
    }
}
#undef SKYKNOT_CASE

template <int L>
void Tape::evaluate(const double* inputs, double* outputs, double* workspace) const {
    std::copy_n(inputs, this->inputs() * L, workspace);
    run<L>(workspace);
    for (std::uint32_t slot : program_.output_slots) {
        Lanes<L>::load(workspace + std::size_t{slot} * L).store(outputs);
        outputs += L;
    }
}

template void Tape::prepare<8>(double*) const;
template void Tape::prepare<16>(double*) const;
template void Tape::run<8>(double*) const;
template void Tape::run<16>(double*) const;
template void Tape::evaluate<8>(const double*, double*, double*) const;
template void Tape::evaluate<16>(const double*, double*, double*) const;

}  // namespace skyknot::inline SKYKNOT_ISA
