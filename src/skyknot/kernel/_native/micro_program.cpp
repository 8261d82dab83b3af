#include "micro_program.hpp"

#include <algorithm>
#include <map>

#include "vector8.hpp"

namespace skyknot::inline SKYKNOT_ISA {

// Code: a run is [kind | terms << 4, length] followed by `length` instructions of that shape, each
// [result, start (when it has one), pairs of factors …], or [slot, buffer, offset low, offset high].
// Slots are offsets in doubles.
namespace {

constexpr std::uint32_t none = UINT32_MAX, longest_run = UINT16_MAX;

template <bool subtract, bool start, std::uint32_t count, class Code>
[[gnu::always_inline]] inline const Code* dots(const Code* at, std::uint32_t length, double* w,
                                               std::uint32_t terms) {
    const std::uint32_t n = count == 0 ? terms : count;
    for (std::uint32_t i = 0; i < length; ++i) {
        double* const result = w + *at++;
        Vector8 sum = start ? load8(w + *at++) : Vector8{};
        for (std::uint32_t t = 0; t < n; ++t, at += 2) {
            const Vector8 product_a = load8(w + at[0]), product_b = load8(w + at[1]);
            if constexpr (subtract) sum -= product_a * product_b;
            else sum += product_a * product_b;
        }
        store8(result, sum);
    }
    return at;
}

template <class Code>
[[gnu::always_inline]] inline std::ptrdiff_t offset_at(const Code* at) {
    return static_cast<std::ptrdiff_t>(std::uint32_t{at[0]} | std::uint32_t{at[1]} << 16);
}

template <bool subtract, bool start, class Code>
inline const Code* run_dots(const Code* at, std::uint32_t length, double* w, std::uint32_t terms) {
    switch (terms) {
        case 1: return dots<subtract, start, 1>(at, length, w, terms);
        case 2: return dots<subtract, start, 2>(at, length, w, terms);
        case 3: return dots<subtract, start, 3>(at, length, w, terms);
        case 4: return dots<subtract, start, 4>(at, length, w, terms);
        case 5: return dots<subtract, start, 5>(at, length, w, terms);
        case 6: return dots<subtract, start, 6>(at, length, w, terms);
        case 7: return dots<subtract, start, 7>(at, length, w, terms);
        case 8: return dots<subtract, start, 8>(at, length, w, terms);
        case 9: return dots<subtract, start, 9>(at, length, w, terms);
        case 10: return dots<subtract, start, 10>(at, length, w, terms);
        case 11: return dots<subtract, start, 11>(at, length, w, terms);
        case 12: return dots<subtract, start, 12>(at, length, w, terms);
        default: return dots<subtract, start, 0>(at, length, w, terms);
    }
}

}  // namespace

void MicroProgram::run(const double* const* sources, double* const* targets, const double* scalars,
                       std::ptrdiff_t first, double* w) const {
    for (const auto& [slot, value] : constants_) store8(w + slot, broadcast8(value));
    if (wide_.empty())
        run(narrow_.data(), narrow_.data() + narrow_.size(), sources, targets, scalars, first, w);
    else run(wide_.data(), wide_.data() + wide_.size(), sources, targets, scalars, first, w);
}

template <class Code>
void MicroProgram::run(const Code* at, const Code* end, const double* const* sources,
                       double* const* targets, const double* scalars, std::ptrdiff_t first,
                       double* w) const {
    while (at != end) {
        const std::uint32_t head = at[0], length = at[1], terms = head >> 4;
        at += 2;
        switch (static_cast<Builder::Kind>(head & 15u)) {
            case Builder::load:
                for (std::uint32_t i = 0; i < length; ++i, at += 4)
                    store8(w + at[0], load8(sources[at[1]] + offset_at(at + 2) + first));
                break;
            case Builder::scalar_load:
                for (std::uint32_t i = 0; i < length; ++i, at += 2)
                    store8(w + at[0], broadcast8(scalars[at[1]]));
                break;
            case Builder::dot_add: at = run_dots<false, false>(at, length, w, terms); break;
            case Builder::dot_add_start: at = run_dots<false, true>(at, length, w, terms); break;
            case Builder::dot_subtract: at = run_dots<true, false>(at, length, w, terms); break;
            case Builder::dot_subtract_start:
                at = run_dots<true, true>(at, length, w, terms);
                break;
            case Builder::invert:
                for (std::uint32_t i = 0; i < length; ++i, at += 2)
                    store8(w + at[0], 1.0 / load8(w + at[1]));
                break;
            case Builder::store:
                for (std::uint32_t i = 0; i < length; ++i, at += 4)
                    store8(targets[at[1]] + offset_at(at + 2) + first, load8(w + at[0]));
        }
    }
}

Value Builder::record(Step step) {
    step.result = values_++;
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
    return read(source, static_cast<std::uint32_t>(static_cast<std::ptrdiff_t>(row * stride_) + shift));
}

Value Builder::read(std::uint32_t source, std::uint32_t offset) {
    const std::uint64_t key = (std::uint64_t{source} << 32) | offset;
    if (const auto found = inputs_.find(key); found != inputs_.end()) return {found->second};
    const Value value = record({load, 0, -1, source, offset, {}});
    inputs_.emplace(key, value.id);
    return value;
}

Value Builder::scalar(std::uint32_t index) {
    const std::uint64_t key = (std::uint64_t{UINT32_MAX} << 32) | index;
    if (const auto found = inputs_.find(key); found != inputs_.end()) return {found->second};
    const Value value = record({scalar_load, 0, -1, index, 0, {}});
    inputs_.emplace(key, value.id);
    return value;
}

Value Builder::dot(const std::vector<Term>& terms, Value start, bool subtract) {
    const Kind plain = subtract ? dot_subtract : dot_add;
    const Kind started = subtract ? dot_subtract_start : dot_add_start;
    Step step{start.is_zero() ? plain : started, 0, start.id, 0, 0, {}};
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

void Builder::output(std::uint32_t target, std::size_t offset, Value value) {
    if (value.is_zero()) return;
    steps_.push_back({store, -1, value.id, target, static_cast<std::uint32_t>(offset), {}});
}

std::uint32_t Builder::place(Value value) {
    if (value.is_zero()) return 0;
    const auto next = static_cast<std::uint32_t>(placed_.size() + 1);
    const auto [found, fresh] = places_.emplace(value.id, next);
    if (fresh) placed_.push_back(value.id);
    return found->second;
}

// Steps that something needs, in runs of one shape: always the shape with most steps ready.
std::vector<std::size_t> Builder::scheduled() const {
    const auto values = static_cast<std::size_t>(values_);
    std::vector<std::ptrdiff_t> maker(values, -1);
    for (std::size_t i = 0; i < steps_.size(); ++i)
        if (steps_[i].kind != store) maker[static_cast<std::size_t>(steps_[i].result)] =
            static_cast<std::ptrdiff_t>(i);
    const auto operands = [&](std::size_t i, auto&& visit) {
        const auto see = [&](std::int32_t id) {
            if (id >= 0 && maker[static_cast<std::size_t>(id)] >= 0)
                visit(static_cast<std::size_t>(maker[static_cast<std::size_t>(id)]));
        };
        see(steps_[i].start);
        for (const auto& [a, b] : steps_[i].terms) see(a), see(b);
    };
    std::vector<char> needed(steps_.size(), 0);
    for (const std::int32_t id : placed_)
        if (const std::ptrdiff_t from = maker[static_cast<std::size_t>(id)]; from >= 0)
            needed[static_cast<std::size_t>(from)] = 1;
    for (std::size_t i = steps_.size(); i-- > 0;)
        if (steps_[i].kind == store || needed[i]) {
            needed[i] = 1;
            operands(i, [&](std::size_t maker_step) { needed[maker_step] = 1; });
        }
    std::vector<std::size_t> waiting(steps_.size(), 0);
    std::vector<std::vector<std::size_t>> users(steps_.size());
    std::map<std::uint32_t, std::vector<std::size_t>> ready;
    const auto shape = [&](std::size_t i) {
        return static_cast<std::uint32_t>(steps_[i].kind) |
               static_cast<std::uint32_t>(steps_[i].terms.size()) << 4;
    };
    for (std::size_t i = 0; i < steps_.size(); ++i) {
        if (!needed[i]) continue;
        operands(i, [&](std::size_t from) { ++waiting[i], users[from].push_back(i); });
        if (waiting[i] == 0) ready[shape(i)].push_back(i);
    }
    std::vector<std::size_t> order;
    while (!ready.empty()) {
        auto best = ready.begin();
        for (auto it = ready.begin(); it != ready.end(); ++it)
            if (it->second.size() > best->second.size()) best = it;
        const std::vector<std::size_t> run = std::move(best->second);
        ready.erase(best);
        for (const std::size_t i : run) {
            order.push_back(i);
            for (const std::size_t user : users[i])
                if (--waiting[user] == 0) ready[shape(user)].push_back(user);
        }
    }
    return order;
}

MicroProgram Builder::finish() {
    MicroProgram program;
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
    const auto touch = [&](std::int32_t id, std::size_t place) {
        if (id >= 0) last[static_cast<std::size_t>(id)] = place;
    };
    for (std::size_t place = 0; place < order.size(); ++place) {
        touch(steps_[order[place]].start, place);
        for (const auto& [a, b] : steps_[order[place]].terms) touch(a, place), touch(b, place);
    }
    std::vector<std::uint32_t> slot(static_cast<std::size_t>(values_), none), free_slots;
    program.slots_ = placed_.size() + 1;
    for (std::size_t i = 0; i < placed_.size(); ++i) {
        slot[static_cast<std::size_t>(placed_[i])] = static_cast<std::uint32_t>(lane_count * (i + 1));
        touch(placed_[i], order.size());
    }
    const auto take = [&](std::int32_t id) {
        std::uint32_t& mine = slot[static_cast<std::size_t>(id)];
        if (mine != none) return;
        if (free_slots.empty()) mine = static_cast<std::uint32_t>(lane_count * program.slots_++);
        else mine = free_slots.back(), free_slots.pop_back();
    };
    const auto of = [&](std::int32_t id) { return slot[static_cast<std::size_t>(id)]; };
    for (const auto& [id, value] : constants_) {
        touch(id, order.size());
        take(id);
        program.constants_.emplace_back(of(id), value);
    }
    std::vector<std::uint32_t> code;
    std::size_t run = 0;
    std::uint32_t shape = none;
    for (std::size_t place = 0; place < order.size(); ++place) {
        const Step& step = steps_[order[place]];
        const std::uint32_t head = static_cast<std::uint32_t>(step.kind) |
                                   static_cast<std::uint32_t>(step.terms.size()) << 4;
        if (head != shape || code[run] == longest_run) {
            shape = head;
            code.insert(code.end(), {head, 0});
            run = code.size() - 1;
        }
        ++code[run];
        if (step.kind != store) take(step.result);
        code.push_back(of(step.kind == store ? step.start : step.result));
        if (step.kind == load || step.kind == store)
            code.insert(code.end(), {step.buffer, step.offset & 0xffffu, step.offset >> 16});
        else if (step.kind == scalar_load) code.push_back(step.buffer);
        else if (step.start >= 0) code.push_back(of(step.start));
        for (const auto& [a, b] : step.terms) code.insert(code.end(), {of(a), of(b)});
        program.multiplications_ += step.terms.size();
        const auto release = [&](std::int32_t id) {
            if (id < 0 || last[static_cast<std::size_t>(id)] != place) return;
            std::uint32_t& s = slot[static_cast<std::size_t>(id)];
            if (s != none) free_slots.push_back(s);
            s = none;
        };
        release(step.start);
        for (const auto& [a, b] : step.terms) release(a), release(b);
    }
    return code;
}

}  // namespace skyknot::inline SKYKNOT_ISA
