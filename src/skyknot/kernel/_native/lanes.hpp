// L points side by side: one arithmetic for every instruction set.
//
// Lanes<L> is a small array of native vectors (GCC vector extensions), L a multiple of the native
// width: 8 doubles with AVX-512, 4 with AVX, 2 elsewhere. Memory holds L consecutive doubles;
// 64-byte alignment is faster but not required.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace skyknot::inline SKYKNOT_ISA {

#if defined(__AVX512F__)
inline constexpr int native_width = 8;
#elif defined(__AVX__)
inline constexpr int native_width = 4;
#else
inline constexpr int native_width = 2;
#endif

using NativeVector [[gnu::vector_size(native_width * 8)]] = double;
using NativeBits [[gnu::vector_size(native_width * 8)]] = std::int64_t;

// Everything here must vanish into its caller; left alone, GCC gives up in a large one.
#define SKYKNOT_INLINE [[gnu::always_inline]] inline
#define SKYKNOT_LAMBDA __attribute__((always_inline))

// Two halves, down to one native vector: never an indexed array, which GCC would keep in memory.
// As bits, a comparison gives all ones or all zeros.
template <int L, class Vector, class Element>
struct Parts {
    static_assert(L % (2 * native_width) == 0);
    static constexpr bool is_native = false;
    using Half = Parts<L / 2, Vector, Element>;
    Half low, high;

    SKYKNOT_INLINE static Parts load(const Element* from) {
        return {Half::load(from), Half::load(from + L / 2)};
    }
    SKYKNOT_INLINE void store(Element* to) const {
        low.store(to);
        high.store(to + L / 2);
    }
    SKYKNOT_INLINE static Parts all(Element value) { return {Half::all(value), Half::all(value)}; }
};

template <class Vector, class Element>
struct Parts<native_width, Vector, Element> {
    static constexpr bool is_native = true;
    Vector vector;

    SKYKNOT_INLINE static Parts load(const Element* from) {
        Parts result;
        std::memcpy(&result.vector, from, sizeof(Vector));
        return result;
    }
    SKYKNOT_INLINE void store(Element* to) const { std::memcpy(to, &vector, sizeof(Vector)); }
    // A difference, because 0 + (−0) would lose the sign.
    SKYKNOT_INLINE static Parts all(Element value) { return {value - Vector{}}; }
};

template <int L>
using Lanes = Parts<L, NativeVector, double>;
template <int L>
using Bits = Parts<L, NativeBits, std::int64_t>;

// Applies f to corresponding native vectors and gathers what it returns.
template <class Result, class F, class... Arguments>
SKYKNOT_INLINE Result each(F f, const Arguments&... arguments) {
    if constexpr (Result::is_native)
        return {f(arguments.vector...)};
    else
        return {each<typename Result::Half>(f, arguments.low...),
                each<typename Result::Half>(f, arguments.high...)};
}

#define SKYKNOT_ARITHMETIC(symbol)                                                                 \
    template <int L, class V, class E>                                                             \
    SKYKNOT_INLINE Parts<L, V, E> operator symbol(const Parts<L, V, E>& a,                         \
                                                  const Parts<L, V, E>& b) {                       \
        return each<Parts<L, V, E>>([](V x, V y) SKYKNOT_LAMBDA { return x symbol y; }, a, b);     \
    }                                                                                              \
    template <int L, class V, class E>                                                             \
    SKYKNOT_INLINE Parts<L, V, E> operator symbol(const Parts<L, V, E>& a, E b) {                  \
        return a symbol Parts<L, V, E>::all(b);                                                    \
    }                                                                                              \
    template <int L, class V, class E>                                                             \
    SKYKNOT_INLINE Parts<L, V, E> operator symbol(E a, const Parts<L, V, E>& b) {                  \
        return Parts<L, V, E>::all(a) symbol b;                                                    \
    }
SKYKNOT_ARITHMETIC(+)
SKYKNOT_ARITHMETIC(-)
SKYKNOT_ARITHMETIC(*)
SKYKNOT_ARITHMETIC(/)
SKYKNOT_ARITHMETIC(&)
SKYKNOT_ARITHMETIC(|)
SKYKNOT_ARITHMETIC(^)
#undef SKYKNOT_ARITHMETIC

#define SKYKNOT_COMPARISON(symbol)                                                                 \
    template <int L>                                                                               \
    SKYKNOT_INLINE Bits<L> operator symbol(const Lanes<L>& a, const Lanes<L>& b) {                 \
        const auto compare = [](NativeVector x, NativeVector y)                                    \
                                 SKYKNOT_LAMBDA { return NativeBits(x symbol y); };                \
        return each<Bits<L>>(compare, a, b);                                                       \
    }                                                                                              \
    template <int L>                                                                               \
    SKYKNOT_INLINE Bits<L> operator symbol(const Lanes<L>& a, double b) {                          \
        return a symbol Lanes<L>::all(b);                                                          \
    }
SKYKNOT_COMPARISON(<)
SKYKNOT_COMPARISON(<=)
SKYKNOT_COMPARISON(>)
SKYKNOT_COMPARISON(>=)
SKYKNOT_COMPARISON(==)
SKYKNOT_COMPARISON(!=)
#undef SKYKNOT_COMPARISON

template <int L, class V, class E>
SKYKNOT_INLINE Parts<L, V, E> operator-(const Parts<L, V, E>& a) {
    return each<Parts<L, V, E>>([](V x) SKYKNOT_LAMBDA { return -x; }, a);
}

// Shifts of the 64-bit patterns; the right shift fills with zeros.
template <int count, int L>
SKYKNOT_INLINE Bits<L> shift_left(const Bits<L>& a) {
    return each<Bits<L>>([](NativeBits x) SKYKNOT_LAMBDA { return x << count; }, a);
}
template <int count, int L>
SKYKNOT_INLINE Bits<L> shift_right(const Bits<L>& a) {
    using Unsigned [[gnu::vector_size(native_width * 8)]] = std::uint64_t;
    return each<Bits<L>>(
        [](NativeBits x) SKYKNOT_LAMBDA { return NativeBits(Unsigned(x) >> count); }, a);
}

template <int L>
SKYKNOT_INLINE Bits<L> bits_of(const Lanes<L>& a) {
    return each<Bits<L>>([](NativeVector x) SKYKNOT_LAMBDA { return NativeBits(x); }, a);
}
template <int L>
SKYKNOT_INLINE Lanes<L> from_bits(const Bits<L>& a) {
    return each<Lanes<L>>([](NativeBits x) SKYKNOT_LAMBDA { return NativeVector(x); }, a);
}

template <int L>
SKYKNOT_INLINE Lanes<L> select(const Bits<L>& where, const Lanes<L>& then,
                               const Lanes<L>& otherwise) {
    return each<Lanes<L>>(
        [](NativeBits m, NativeVector x, NativeVector y) SKYKNOT_LAMBDA { return m ? x : y; },
        where, then, otherwise);
}

template <int L>
SKYKNOT_INLINE bool any(const Bits<L>& where) {
    if constexpr (!Bits<L>::is_native) {
        return any(where.low | where.high);
    } else {
#if defined(__AVX512F__)
        return _mm512_test_epi64_mask(__m512i(where.vector), __m512i(where.vector)) != 0;
#elif defined(__AVX__)
        return !_mm256_testz_si256(__m256i(where.vector), __m256i(where.vector));
#else
        return (where.vector[0] | where.vector[1]) != 0;
#endif
    }
}

inline constexpr std::int64_t sign_bit = INT64_MIN;

template <int L>
SKYKNOT_INLINE Lanes<L> absolute(const Lanes<L>& a) {
    return from_bits(bits_of(a) & ~sign_bit);
}

// The magnitude of a with the sign of b.
template <int L>
SKYKNOT_INLINE Lanes<L> copy_sign(const Lanes<L>& a, const Lanes<L>& b) {
    return from_bits((bits_of(a) & ~sign_bit) | (bits_of(b) & sign_bit));
}

template <int L>
SKYKNOT_INLINE Lanes<L> square_root(const Lanes<L>& a) {
    return each<Lanes<L>>(
        [](NativeVector x) SKYKNOT_LAMBDA {
#if defined(__AVX512F__)
            return NativeVector(_mm512_maskz_sqrt_pd(0xff, __m512d(x)));
#elif defined(__AVX__)
            return NativeVector(_mm256_sqrt_pd(__m256d(x)));
#else
            for (int i = 0; i < native_width; ++i) x[i] = std::sqrt(x[i]);
            return x;
#endif
        },
        a);
}

template <int L>
SKYKNOT_INLINE Lanes<L> round_down(const Lanes<L>& a) {
    return each<Lanes<L>>(
        [](NativeVector x) SKYKNOT_LAMBDA {
#if defined(__AVX512F__)
            return NativeVector(
                _mm512_maskz_roundscale_pd(0xff, __m512d(x), _MM_FROUND_TO_NEG_INF));
#elif defined(__AVX__)
            return NativeVector(_mm256_floor_pd(__m256d(x)));
#elif defined(__SSE4_1__)
            return NativeVector(_mm_floor_pd(__m128d(x)));
#else
            for (int i = 0; i < native_width; ++i) x[i] = std::floor(x[i]);
            return x;
#endif
        },
        a);
}

// a b + c, rounded once where the processor can, twice elsewhere.
template <int L>
SKYKNOT_INLINE Lanes<L> fused(const Lanes<L>& a, const Lanes<L>& b, const Lanes<L>& c) {
    return each<Lanes<L>>(
        [](NativeVector x, NativeVector y, NativeVector z) SKYKNOT_LAMBDA {
#if defined(__AVX512F__)
            return NativeVector(_mm512_fmadd_pd(__m512d(x), __m512d(y), __m512d(z)));
#elif defined(__FMA__)
            return NativeVector(_mm256_fmadd_pd(__m256d(x), __m256d(y), __m256d(z)));
#else
            return x * y + z;
#endif
        },
        a, b, c);
}

}  // namespace skyknot::inline SKYKNOT_ISA
