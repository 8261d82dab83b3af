// Running micro programs.
#include <cstring>
#include <stdexcept>
#include <utility>

#include "block_rows.hpp"
#include "micro_code.hpp"
#include "micro_program.hpp"
#include "vector8.hpp"

namespace skyknot::inline SKYKNOT_ISA {
namespace {

struct Four {
    std::size_t first, second, third, fourth;
    std::ptrdiff_t offset() const { return static_cast<std::ptrdiff_t>(third | fourth << 16); }
};

// Four numbers of the code, narrow ones by one load: loads are what dots are short of.
template <class Code>
SKYKNOT_INLINE Four four_at(const Code* at) {
    if constexpr (sizeof(Code) != 2) return {at[0], at[1], at[2], at[3]};
    std::uint64_t all;
    std::memcpy(&all, at, sizeof all);
    return {all & 0xffff, all >> 16 & 0xffff, all >> 32 & 0xffff, all >> 48};
}

template <bool subtract>
SKYKNOT_INLINE void add_term(Vector8& sum, const double* a, const double* b) {
    if constexpr (subtract) sum -= load8(a) * load8(b);
    else sum += load8(a) * load8(b);
}

// A pass under way. Groups of eight segments stand a stride apart in the workspace.
struct Running {
    const Pass& pass;
    std::size_t stride;
    const double* stored;  // what is read in place

    double* slots(std::size_t group) const { return pass.workspace + group * stride; }
    std::ptrdiff_t first(std::size_t group) const {
        return pass.first + static_cast<std::ptrdiff_t>(lane_count * group);
    }
};

// The second factors stand in the workspace, the first ones there or in the kept block.
template <bool subtract, bool stored, std::uint32_t count, int groups, class Code>
const Code* dots(const Code* at, std::uint32_t length, std::uint32_t terms, const Running& running) {
    const std::uint32_t n = count == 0 ? terms : count;
    double* const w = running.pass.workspace;
    const double* const a = stored ? running.stored : w;
    const std::size_t ws = running.stride, as = stored ? running.pass.stored_stride : ws;
    for (std::uint32_t i = 0; i < length; ++i) {
        const Four head = four_at(at);
        Vector8 sum[groups];
        const auto add = [&](std::size_t first, std::size_t second) SKYKNOT_LAMBDA {
            for (std::size_t g = 0; g < groups; ++g)
                add_term<subtract>(sum[g], a + g * as + first, w + g * ws + second);
        };
        for (std::size_t g = 0; g < groups; ++g) sum[g] = load8(w + g * ws + head.second);
        add(head.third, head.fourth);
        at += 4;
        std::uint32_t t = 1;
        for (; t + 2 <= n; t += 2, at += 4) {
            const Four pairs = four_at(at);
            add(pairs.first, pairs.second), add(pairs.third, pairs.fourth);
        }
        if (t < n) add(at[0], at[1]), at += 2;
        for (std::size_t g = 0; g < groups; ++g) store8(w + g * ws + head.first, sum[g]);
    }
    return at;
}

template <class Code>
[[gnu::always_inline]] inline std::ptrdiff_t offset_at(const Code* at) {
    return static_cast<std::ptrdiff_t>(std::uint32_t{at[0]} | std::uint32_t{at[1]} << 16);
}

// Lane l of the eight vectors at from(0) … from(7) goes to block l, side by side.
template <class From>
SKYKNOT_INLINE void write_block(From from, double* to, std::size_t stride, int filled) {
    if (filled == lane_count)
        turn_block(from, [=](int lane) { return to + static_cast<std::size_t>(lane) * stride; });
    else
        turn_block(from, [=](int lane) {
            return lane < filled ? to + static_cast<std::size_t>(lane) * stride : nullptr;
        });
}

// Eight sums over a native vector of lanes, from lane `part` on: they stay in registers, whatever the
// width.
template <bool start, class Code>
SKYKNOT_INLINE void sum_rows(const Code* from, const Code* pair, std::uint32_t terms, const double* w,
                             NativeVector (&sums)[8]) {
    using Native = Lanes<native_width>;
    Native sum[8];
    for (int j = 0; j < 8; ++j) sum[j] = start ? Native::load(w + from[j]) : Native{};
    for (std::uint32_t t = 0; t < terms; ++t, pair += 2) {
        const Native factor = Native::load(w + pair[0]);
        const double* row = w + pair[1];
        for (int j = 0; j < 8; ++j) sum[j] = fused(factor, Native::load(row + 8 * j), sum[j]);
    }
    for (int j = 0; j < 8; ++j) sums[j] = sum[j].vector;
}

template <bool start, class Code>
const Code* panels(const Code* at, std::uint32_t length, std::uint32_t terms, const Running& running) {
    constexpr int w = native_width;
    const int filled = running.pass.filled;
    for (std::uint32_t i = 0; i < length; ++i) {
        const Blocks& to = running.pass.blocks[at[0]];
        double* const place = to.at + offset_at(at + 1);
        const Code* const from = at + 3;
        at = from + (start ? 8 : 0);
        for (int part = 0; part < lane_count; part += w) {
            NativeVector sums[8];
            sum_rows<start>(from, at, terms, running.pass.workspace + part, sums);
            for (int j = 0; j < 8; j += w) {
                NativeVector square[w];
                for (int k = 0; k < w; ++k) square[k] = sums[j + k];
                turn_square(square);
                for (int k = 0; k < w; ++k)
                    if (part + k < filled)
                        Lanes<w>{square[k]}.store(place + static_cast<std::size_t>(part + k) * to.stride + j);
            }
        }
        at += 2 * terms;
    }
    return at;
}

template <int groups, class Code>
const Code* blocks(const Code* at, std::uint32_t length, std::uint32_t, const Running& running) {
    for (std::uint32_t i = 0; i < length; ++i, at += 11)
        for (int group = 0; group < groups; ++group) {
            const double* const slots = running.slots(static_cast<std::size_t>(group));
            const auto row = [&](int j) SKYKNOT_LAMBDA { return slots + at[3 + j]; };
            const Blocks& to = running.pass.blocks[at[0]];
            double* const place = to.at + static_cast<std::size_t>(lane_count * group) * to.stride;
            write_block(row, place + offset_at(at + 1), to.stride,
                        std::min(lane_count, running.pass.filled - lane_count * group));
        }
    return at;
}

// Calls f(slots, first column, instruction) for every instruction of a run and every group.
template <int groups, int size, class Code, class F>
SKYKNOT_INLINE const Code* each(const Code* at, std::uint32_t length, const Running& running, F f) {
    for (std::uint32_t i = 0; i < length; ++i, at += size)
        for (std::size_t group = 0; group < groups; ++group)
            f(running.slots(group), running.first(group), at);
    return at;
}

template <int groups, class Code>
const Code* loads(const Code* at, std::uint32_t length, std::uint32_t, const Running& running) {
    const auto load = [&](double* slots, std::ptrdiff_t first, const Code* code) SKYKNOT_LAMBDA {
        const Four four = four_at(code);
        store8(slots + four.first, load8(running.pass.sources[four.second] + four.offset() + first));
    };
    return each<groups, 4>(at, length, running, load);
}

template <int groups, class Code>
const Code* loads_stored(const Code* at, std::uint32_t length, std::uint32_t, const Running& running) {
    for (std::uint32_t i = 0; i < length; ++i, at += 4)
        for (std::size_t group = 0; group < groups; ++group) {
            const Four four = four_at(at);
            const double* const block = running.stored + group * running.pass.stored_stride;
            store8(running.slots(group) + four.first, load8(block + four.offset()));
        }
    return at;
}

template <int groups, class Code>
const Code* loads_further(const Code* at, std::uint32_t length, std::uint32_t, const Running& running) {
    const auto load = [&](double* slots, std::ptrdiff_t first, const Code* code) SKYKNOT_LAMBDA {
        const Four four = four_at(code);
        const double* const from = running.pass.sources[four.second] + four.offset() + first;
        store8(slots + four.first, load_next(from, code[4]));
    };
    return each<groups, 5>(at, length, running, load);
}

template <int groups, class Code>
const Code* scalars(const Code* at, std::uint32_t length, std::uint32_t, const Running& running) {
    const auto load = [&](double* slots, std::ptrdiff_t, const Code* code) SKYKNOT_LAMBDA {
        store8(slots + code[0], broadcast8(running.pass.scalars[code[1]]));
    };
    return each<groups, 2>(at, length, running, load);
}

template <int groups, class Code>
const Code* inversions(const Code* at, std::uint32_t length, std::uint32_t, const Running& running) {
    const auto invert = [](double* slots, std::ptrdiff_t, const Code* code) SKYKNOT_LAMBDA {
        store8(slots + code[0], 1.0 / load8(slots + code[1]));
    };
    return each<groups, 2>(at, length, running, invert);
}

template <int groups, class Code>
const Code* stores(const Code* at, std::uint32_t length, std::uint32_t, const Running& running) {
    const auto store = [&](double* slots, std::ptrdiff_t first, const Code* code) SKYKNOT_LAMBDA {
        const Four four = four_at(code);
        store8(running.pass.targets[four.second] + four.offset() + first, load8(slots + four.first));
    };
    return each<groups, 4>(at, length, running, store);
}

// What runs of one shape do: they take the code behind the run's head and return where it ends.
template <class Code>
using Handler = const Code* (*)(const Code* at, std::uint32_t length, std::uint32_t terms,
                                const Running& running);

template <bool subtract, bool stored, int groups, class Code, std::size_t... i>
constexpr std::array<Handler<Code>, sizeof...(i)> dots_of_sizes(std::index_sequence<i...>) {
    return {&dots<subtract, stored, sizes[i], groups, Code>...};
}

// One jump a run: dots of every kind and size first, then the other kinds in their order.
template <int groups, class Code>
constexpr auto handlers_of() {
    constexpr std::make_index_sequence<sizes.size()> all;
    const std::array dots = {dots_of_sizes<false, false, groups, Code>(all),
                             dots_of_sizes<true, false, groups, Code>(all),
                             dots_of_sizes<false, true, groups, Code>(all),
                             dots_of_sizes<true, true, groups, Code>(all)};
    const std::array<Handler<Code>, 9> others = {
        &loads<groups, Code>,   &loads_stored<groups, Code>, &loads_further<groups, Code>,
        &scalars<groups, Code>, &inversions<groups, Code>,   &stores<groups, Code>,
        &blocks<groups, Code>,  &panels<false, Code>,        &panels<true, Code>};
    std::array<Handler<Code>, dots.size() * sizes.size() + others.size()> table{};
    std::size_t next = 0;
    for (const auto& kind : dots)
        for (const Handler<Code> handler : kind) table[next++] = handler;
    for (const Handler<Code> handler : others) table[next++] = handler;
    return table;
}

template <int groups, class Code>
void run_code(const std::vector<Code>& code, const Running& running) {
    static constexpr auto handlers = handlers_of<groups, Code>();
    static_assert(handlers.size() <= 1u << operation_bits);
    const Code* at = code.data();
    while (at != code.data() + code.size()) {
        const std::uint32_t head = at[0];
        at = handlers[head & ((1u << operation_bits) - 1)](at + 2, at[1], head >> operation_bits, running);
    }
}

}  // namespace

void MicroProgram::run(const Pass& pass) const {
    const std::size_t stride = lane_count * slots_;
    const bool pair = pass.filled > lane_count;
    if (pair && alone_) throw std::logic_error("this micro program runs for eight segments at a time");
    for (const auto& [slot, value] : constants_)
        for (std::size_t group = 0; group <= (pair ? 1 : 0); ++group)
            store8(pass.workspace + group * stride + slot, broadcast8(value));
    const double* const stored =
        stored_source_ == none ? nullptr : pass.sources[stored_source_] + pass.first;
    const Running running{pass, stride, stored};
    const auto choose = [&](const auto& code) {
        if (pair) run_code<2>(code, running);
        else run_code<1>(code, running);
    };
    if (wide_.empty()) choose(narrow_);
    else choose(wide_);
}

}  // namespace skyknot::inline SKYKNOT_ISA
