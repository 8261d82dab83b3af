// The closed list of operations a tape can hold.
#pragma once

#include <cstdint>
#include <string_view>

namespace skyknot::inline SKYKNOT_ISA {

// X(name, operands). Names are CasADi's, without OP_; `not`, `and`, `or` carry an underscore.
// First what is computed in vectors, then what goes to the C library lane by lane.
#define SKYKNOT_VECTOR_OPERATIONS(X)                                                            \
    X(add, 2) X(sub, 2) X(mul, 2) X(div, 2) X(neg, 1) X(sq, 1) X(twice, 1) X(inv, 1) X(sqrt, 1) \
    X(fabs, 1) X(floor, 1) X(ceil, 1) X(fmin, 2) X(fmax, 2) X(sign, 1) X(copysign, 2)           \
    X(lt, 2) X(le, 2) X(eq, 2) X(ne, 2) X(not_, 1) X(and_, 2) X(or_, 2) X(if_else_zero, 2)      \
    X(sin, 1) X(cos, 1) X(tan, 1) X(exp, 1) X(log, 1) X(tanh, 1)
#define SKYKNOT_LIBRARY_OPERATIONS(X)                                                             \
    X(pow, 2) X(asin, 1) X(acos, 1) X(atan, 1) X(atan2, 2) X(sinh, 1) X(cosh, 1) X(asinh, 1)      \
    X(acosh, 1) X(atanh, 1) X(fmod, 2) X(remainder, 2) X(hypot, 2) X(erf, 1) X(erfinv, 1)         \
    X(log1p, 1) X(expm1, 1)
// What the assembler makes of pairs: a b + c, a b − c, c − a b (each product rounded before the
// sum), and sine with cosine of one angle.
#define SKYKNOT_JOINED_OPERATIONS(X) X(mul_add, 3) X(mul_sub, 3) X(sub_mul, 3) X(sin_cos, 1)
// What the assembler consumes: it leaves no instruction behind.
#define SKYKNOT_BOOKKEEPING(X) X(assign, 1) X(constant, 0) X(input, 0) X(output, 1)

#define SKYKNOT_ALL_OPERATIONS(X) \
    SKYKNOT_VECTOR_OPERATIONS(X)  \
    SKYKNOT_LIBRARY_OPERATIONS(X) \
    SKYKNOT_JOINED_OPERATIONS(X)  \
    SKYKNOT_BOOKKEEPING(X)

enum class Operation : std::uint32_t {
#define SKYKNOT_ENUMERATE(name, operands) name,
    SKYKNOT_ALL_OPERATIONS(SKYKNOT_ENUMERATE)
#undef SKYKNOT_ENUMERATE
};

struct OperationFacts {
    std::string_view name;
    int operands;
};

inline constexpr OperationFacts operation_facts[] = {
#define SKYKNOT_FACTS(name, operands) {#name, operands},
    SKYKNOT_ALL_OPERATIONS(SKYKNOT_FACTS)
#undef SKYKNOT_FACTS
};

inline constexpr std::uint32_t operation_count = sizeof(operation_facts) / sizeof(OperationFacts);

inline int operand_count(Operation operation) {
    return operation_facts[static_cast<std::uint32_t>(operation)].operands;
}

}  // namespace skyknot::inline SKYKNOT_ISA
