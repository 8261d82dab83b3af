#include "micro_program.hpp"

#include <algorithm>
#include <map>

#include "block_rows.hpp"
#include "vector8.hpp"

namespace skyknot::inline SKYKNOT_ISA {

// Code: a run is [operation | terms << 6, length] followed by `length` instructions of that shape, each
// [result, start, pairs of factors …], [slot, buffer, offset low, offset high], or
// [target, offset low, offset high, eight slots (when it has them), pairs of factor and row …].
// Slots are offsets in doubles.
namespace {

constexpr std::uint32_t none = UINT32_MAX, longest_run = UINT16_MAX;

// Terms of a dot are filled up with zeros to the next of these, so that there are few shapes; dots of
// more terms than the last are of the shape 0.
constexpr std::array<std::uint32_t, 8> sizes = {1, 2, 3, 4, 6, 8, 12, 0};

std::uint32_t size_of(std::size_t terms) {
    return static_cast<std::uint32_t>(
        std::find_if(sizes.begin(), sizes.end() - 1, [=](std::uint32_t n) { return terms <= n; }) -
        sizes.begin());
}
std::uint32_t filled_up(std::size_t terms) {
    const std::uint32_t size = sizes[size_of(terms)];
    return size > 0 ? size : static_cast<std::uint32_t>(terms);
}

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

// Lane l of the eight vectors goes to block l, side by side.
SKYKNOT_INLINE void write_block(Vector8Block& eight, double* to, std::size_t stride, int filled) {
    eight.transpose();
    if (filled == lane_count) {
        for (std::size_t lane = 0; lane < lane_count; ++lane)
            store_wide(to + lane * stride, eight.rows[lane]);
        return;
    }
    for (std::size_t lane = 0; lane < static_cast<std::size_t>(filled); ++lane)
        store_wide(to + lane * stride, eight.rows[lane]);
}

// One native vector of lanes after the other: eight sums stay in registers, whatever their width.
template <bool start, class Code>
[[gnu::always_inline]] inline void sum_rows(const Code* from, const Code* at, std::uint32_t terms,
                                            const double* w, Vector8Block& eight) {
    using Native = Lanes<native_width>;
    for (int part = 0; part < lane_count; part += native_width) {
        Native sum[8];
        for (int j = 0; j < 8; ++j)
            sum[j] = start ? Native::load(w + from[j] + part) : Native{};
        const Code* pair = at;
        for (std::uint32_t t = 0; t < terms; ++t, pair += 2) {
            const Native factor = Native::load(w + pair[0] + part);
            const double* row = w + pair[1] + part;
            for (int j = 0; j < 8; ++j)
                sum[j] = fused(factor, Native::load(row + 8 * j), sum[j]);
        }
        for (int j = 0; j < 8; ++j)
            std::memcpy(reinterpret_cast<double*>(&eight.rows[j]) + part, &sum[j].vector,
                        sizeof sum[j].vector);
    }
}

template <bool start, class Code>
const Code* panels(const Code* at, std::uint32_t length, std::uint32_t terms, const Running& running) {
    for (std::uint32_t i = 0; i < length; ++i) {
        const Blocks& to = running.pass.blocks[at[0]];
        double* const place = to.at + offset_at(at + 1);
        const Code* const from = at + 3;
        at = from + (start ? 8 : 0);
        Vector8Block eight;
        sum_rows<start>(from, at, terms, running.pass.workspace, eight);
        at += 2 * terms;
        write_block(eight, place, to.stride, running.pass.filled);
    }
    return at;
}

template <int groups, class Code>
const Code* blocks(const Code* at, std::uint32_t length, std::uint32_t, const Running& running) {
    for (std::uint32_t i = 0; i < length; ++i, at += 11)
        for (int group = 0; group < groups; ++group) {
            const double* const slots = running.slots(static_cast<std::size_t>(group));
            Vector8Block eight;
            for (int j = 0; j < 8; ++j) eight.rows[j] = load_wide(slots + at[3 + j]);
            const Blocks& to = running.pass.blocks[at[0]];
            double* const place = to.at + static_cast<std::size_t>(lane_count * group) * to.stride;
            write_block(eight, place + offset_at(at + 1), to.stride,
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
        store_wide(slots + four.first, load_next(from, code[4]));
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

constexpr std::uint32_t operation_bits = 6;

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

Value Builder::record(Step step) {
    step.result = values_++;
    step.phase = phase_;
    steps_.push_back(std::move(step));
    return {values_ - 1};
}

Value Builder::constant(double value) {
    if (value == 0.0) return {};
    for (const auto& [id, known] : constants_)
        if (known == value) return {id};
    constants_.emplace_back(values_, value);
    if (value == 1.0) one_ = values_;
    return {values_++};
}

Value Builder::input(std::uint32_t source, std::size_t row, std::ptrdiff_t shift) {
    const auto offset = static_cast<std::ptrdiff_t>(row * stride_) + shift;
    return read(load, source, static_cast<std::uint32_t>(offset));
}

Value Builder::block_input(std::uint32_t source, std::size_t row, std::size_t rows, bool next) {
    return read(next ? load_further : load, source, static_cast<std::uint32_t>(row * lane_count),
                static_cast<std::uint32_t>(rows * lane_count));
}

Value Builder::read(Kind kind, std::uint32_t source, std::uint32_t offset, std::uint32_t further) {
    const std::uint64_t key = (std::uint64_t{source} << 32) | offset;
    const auto [found, fresh] = inputs_.emplace(std::pair{kind, key}, values_);
    if (!fresh) return {found->second};
    Step step{kind, 0, -1, source, offset, {}};
    step.further = further;
    return record(std::move(step));
}

Value Builder::reserve() {
    const Value value{values_++};
    place(value);
    return value;
}

Value Builder::scalar(std::uint32_t index) { return read(scalar_load, index, 0); }

Value Builder::dot(const std::vector<Term>& terms, Value start, bool subtract) {
    Step step{subtract ? dot_subtract : dot_add, 0, start.id, 0, 0, {}};
    for (const auto& [a, b] : terms)
        if (!a.is_zero() && !b.is_zero()) step.terms.emplace_back(a.id, b.id);
    if (step.terms.empty()) return start;
    if (!subtract && start.is_zero() && step.terms.size() == 1) {
        const auto [a, b] = step.terms.front();
        if (a == one_) return {b};
        if (b == one_) return {a};
    }
    std::vector<std::int32_t> key{static_cast<std::int32_t>(step.kind), start.id};
    for (const auto& [a, b] : step.terms) key.insert(key.end(), {a, b});
    const auto [found, fresh] = dots_.emplace(std::move(key), values_);
    return fresh ? record(std::move(step)) : Value{found->second};
}

Value Builder::reciprocal(Value a) {
    if (is_one(a)) return a;
    return record({invert, 0, a.id, 0, 0, {}});
}

void Builder::write(Step step) {
    step.result = -1;
    step.phase = phase_;
    steps_.push_back(std::move(step));
}

void Builder::output(std::uint32_t target, std::size_t offset, Value value) {
    if (value.is_zero()) return;
    write({store, -1, value.id, target, static_cast<std::uint32_t>(offset), {}});
}

std::uint32_t Builder::place(Value value) {
    if (value.is_zero()) return 0;
    const auto [found, fresh] = homes_.emplace(value.id, lane_count * next_home_);
    if (fresh) ++next_home_;
    return found->second;
}

Row8 Builder::row8(const Eight& values) {
    Eight kept{};
    for (std::size_t j = 0; j < 8; ++j) {
        if (values[j].is_zero()) continue;
        kept[j] = values[j];
        if (homes_.contains(kept[j].id))  // already elsewhere: a copy
            kept[j] = record({dot_add, 0, -1, 0, 0, {{one().id, kept[j].id}}});
        homes_.emplace(kept[j].id, lane_count * (next_home_ + static_cast<std::uint32_t>(j)));
    }
    rows8_.push_back(kept);
    rows8_places_.push_back(lane_count * next_home_);
    next_home_ += 8;
    return {static_cast<std::uint32_t>(rows8_.size() - 1)};
}

void Builder::block(std::uint32_t target, std::size_t offset, const Eight& values) {
    const auto is_zero = [](Value value) { return value.is_zero(); };
    if (std::all_of(values.begin(), values.end(), is_zero)) return;
    write({block_store, -1, -1, target, static_cast<std::uint32_t>(offset), {}, values});
}

void Builder::panel(std::uint32_t target, std::size_t offset, const Eight& start,
                    const std::vector<std::pair<Value, Row8>>& terms) {
    const auto is_zero = [](Value value) { return value.is_zero(); };
    const bool starts = !std::all_of(start.begin(), start.end(), is_zero);
    Step step{starts ? panel_start_store : panel_store, -1, -1, target,
              static_cast<std::uint32_t>(offset), {}, start};
    for (const auto& [factor, row] : terms) {
        const Eight& values = rows8_[row.number];
        if (factor.is_zero() || std::all_of(values.begin(), values.end(), is_zero)) continue;
        step.terms.emplace_back(factor.id, static_cast<std::int32_t>(row.number));
    }
    if (step.terms.empty()) block(target, offset, start);
    else write(std::move(step));
}

template <class Visit>
void Builder::visit_operands(const Step& step, Visit visit) const {
    const auto see = [&](Value value) {
        if (!value.is_zero()) visit(value.id);
    };
    see({step.start});
    for (const Value value : step.eight) see(value);
    for (const auto& [a, b] : step.terms) {
        if (!step.is_stored()) see({a});
        if (!step.is_panel()) see({b});
        else
            for (const Value value : rows8_[static_cast<std::size_t>(b)]) see(value);
    }
}

// Operation and number of terms, as a run's head tells them.
std::uint32_t Builder::shape(const Step& step) {
    constexpr std::uint32_t size_count = sizes.size(), dot_kinds = stored_subtract + 1;
    const std::size_t terms = step.terms.size();
    if (step.kind < dot_kinds)
        return (step.kind * size_count + size_of(terms)) | filled_up(terms) << operation_bits;
    return (dot_kinds * size_count + step.kind - dot_kinds) |
           static_cast<std::uint32_t>(terms) << operation_bits;
}

// Dots whose every term has a factor in the stored block take it from there.
void Builder::read_stored_in_place() {
    if (stored_source_ == none) return;
    std::vector<std::ptrdiff_t> offset(static_cast<std::size_t>(values_), -1);
    for (const Step& step : steps_)
        if (step.kind == load_stored)
            offset[static_cast<std::size_t>(step.result)] = step.offset;
    if (one_ >= 0) offset[static_cast<std::size_t>(one_)] = 0;
    const auto of = [&](std::int32_t id) { return offset[static_cast<std::size_t>(id)]; };
    for (Step& step : steps_) {
        if (step.kind != dot_add && step.kind != dot_subtract) continue;
        const bool all = std::all_of(step.terms.begin(), step.terms.end(), [&](const auto& term) {
            return of(term.first) >= 0 || of(term.second) >= 0;
        });
        if (!all) continue;
        step.kind = step.kind == dot_add ? stored_add : stored_subtract;
        for (auto& [a, b] : step.terms) {
            if (of(a) < 0) std::swap(a, b);
            a = static_cast<std::int32_t>(of(a));
        }
    }
}

// Steps that something needs, phase after phase, in runs of one shape: always the shape with most
// steps ready.
std::vector<std::size_t> Builder::scheduled() const {
    const auto values = static_cast<std::size_t>(values_);
    std::vector<std::ptrdiff_t> maker(values, -1);
    for (std::size_t i = 0; i < steps_.size(); ++i)
        if (!steps_[i].writes()) maker[static_cast<std::size_t>(steps_[i].result)] =
            static_cast<std::ptrdiff_t>(i);
    const auto operands = [&](std::size_t i, auto&& visit) {
        visit_operands(steps_[i], [&](std::int32_t id) {
            const std::ptrdiff_t from = maker[static_cast<std::size_t>(id)];
            if (from >= 0) visit(static_cast<std::size_t>(from));
        });
    };
    std::vector<char> needed(steps_.size(), 0);
    for (const auto& [id, slot] : homes_)
        if (const std::ptrdiff_t from = maker[static_cast<std::size_t>(id)]; from >= 0)
            needed[static_cast<std::size_t>(from)] = 1;
    for (std::size_t i = steps_.size(); i-- > 0;)
        if (steps_[i].writes() || needed[i]) {
            needed[i] = 1;
            operands(i, [&](std::size_t maker_step) { needed[maker_step] = 1; });
        }
    std::vector<std::size_t> waiting(steps_.size(), 0);
    std::vector<std::vector<std::size_t>> users(steps_.size());
    std::map<std::uint32_t, std::map<std::uint32_t, std::vector<std::size_t>>> ready;
    const auto be_ready = [&](std::size_t i) { ready[steps_[i].phase][shape(steps_[i])].push_back(i); };
    for (std::size_t i = 0; i < steps_.size(); ++i) {
        if (!needed[i]) continue;
        operands(i, [&](std::size_t from) { ++waiting[i], users[from].push_back(i); });
        if (waiting[i] == 0) be_ready(i);
    }
    std::vector<std::size_t> order;
    while (!ready.empty()) {
        auto& shapes = ready.begin()->second;
        auto best = shapes.begin();
        for (auto it = shapes.begin(); it != shapes.end(); ++it)
            if (it->second.size() > best->second.size()) best = it;
        const std::vector<std::size_t> run = std::move(best->second);
        shapes.erase(best);
        if (shapes.empty()) ready.erase(ready.begin());
        for (const std::size_t i : run) {
            order.push_back(i);
            for (const std::size_t user : users[i])
                if (--waiting[user] == 0) be_ready(user);
        }
    }
    return order;
}

MicroProgram Builder::finish() {
    MicroProgram program;
    read_stored_in_place();
    program.stored_source_ = stored_source_;
    const std::vector<std::uint32_t> code = encode(scheduled(), program);
    if (std::all_of(code.begin(), code.end(), [](std::uint32_t c) { return c <= UINT16_MAX; }))
        for (const std::uint32_t c : code) program.narrow_.push_back(static_cast<std::uint16_t>(c));
    else program.wide_ = code;
    return program;
}

// Gives every value a slot, reusing those of values no longer needed, and writes the code.
std::vector<std::uint32_t> Builder::encode(const std::vector<std::size_t>& order,
                                           MicroProgram& program) {
    std::vector<std::size_t> last(static_cast<std::size_t>(values_), 0);
    for (std::size_t place = 0; place < order.size(); ++place)
        visit_operands(steps_[order[place]],
                       [&](std::int32_t id) { last[static_cast<std::size_t>(id)] = place; });
    std::vector<std::uint32_t> slot(static_cast<std::size_t>(values_), none), free_slots;
    program.slots_ = next_home_;
    const auto keep = [&](std::int32_t id) { last[static_cast<std::size_t>(id)] = order.size(); };
    for (const auto& [id, home] : homes_) slot[static_cast<std::size_t>(id)] = home, keep(id);
    const auto take = [&](std::int32_t id) {
        std::uint32_t& mine = slot[static_cast<std::size_t>(id)];
        if (mine != none) return;
        if (free_slots.empty()) mine = static_cast<std::uint32_t>(lane_count * program.slots_++);
        else mine = free_slots.back(), free_slots.pop_back();
    };
    const auto of = [&](std::int32_t id) { return id < 0 ? 0 : slot[static_cast<std::size_t>(id)]; };
    for (const auto& [id, value] : constants_) {
        keep(id);
        take(id);
        program.constants_.emplace_back(of(id), value);
    }
    std::vector<std::uint32_t> code;
    std::size_t run = 0;
    std::uint32_t now = none;
    for (std::size_t place = 0; place < order.size(); ++place) {
        const Step& step = steps_[order[place]];
        if (shape(step) != now || code[run] == longest_run) {
            now = shape(step);
            code.insert(code.end(), {now, 0});
            run = code.size() - 1;
        }
        ++code[run];
        if (!step.writes()) take(step.result);
        write_code(step, of, code);
        program.multiplications_ += step.terms.size() * (step.is_panel() ? 8 : 1);
        visit_operands(step, [&](std::int32_t id) {
            if (last[static_cast<std::size_t>(id)] != place) return;
            std::uint32_t& s = slot[static_cast<std::size_t>(id)];
            if (s != none) free_slots.push_back(s);
            s = none;
        });
    }
    return code;
}

template <class SlotOf>
void Builder::write_code(const Step& step, SlotOf of, std::vector<std::uint32_t>& code) const {
    const auto to_place = [&] {
        code.insert(code.end(), {step.buffer, step.offset & 0xffffu, step.offset >> 16});
    };
    if (step.kind >= block_store) {
        to_place();
        if (step.kind != panel_store)
            for (const Value value : step.eight) code.push_back(of(value.id));
        for (const auto& [factor, row] : step.terms)
            code.insert(code.end(), {of(factor), rows8_places_[static_cast<std::size_t>(row)]});
        return;
    }
    code.push_back(of(step.kind == store ? step.start : step.result));
    switch (step.kind) {
        case store:
        case load:
        case load_stored: to_place(); break;
        case load_further: to_place(), code.push_back(step.further); break;
        case scalar_load: code.push_back(step.buffer); break;
        default: code.push_back(of(step.start));
    }
    for (const auto& [a, b] : step.terms)
        code.insert(code.end(), {step.is_stored() ? static_cast<std::uint32_t>(a) : of(a), of(b)});
    for (std::size_t terms = step.terms.size(); terms < shape(step) >> operation_bits; ++terms)
        code.insert(code.end(), {0, 0});
}

}  // namespace skyknot::inline SKYKNOT_ISA
