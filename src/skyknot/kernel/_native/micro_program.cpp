#include "micro_program.hpp"

#include <algorithm>

#include "vector8.hpp"

namespace skyknot::inline SKYKNOT_ISA {

// Code of one instruction: kind | terms << 3, then result, then what the kind needs. Slots are
// written as offsets in doubles.
namespace {
constexpr std::uint32_t none = UINT32_MAX;
}

void MicroProgram::run(const double* const* sources, double* const* targets, const double* scalars,
                       std::ptrdiff_t first, double* w) const {
    for (const auto& [slot, value] : constants_) store8(w + slot, broadcast8(value));
    const std::uint32_t* at = code_.data();
    const std::uint32_t* const end = at + code_.size();
    while (at != end) {
        const std::uint32_t head = *at++;
        const std::uint32_t kind = head & 7u, count = head >> 3;
        switch (kind) {
            case 0: {  // load: result, buffer, offset
                store8(w + at[0], load8(sources[at[1]] + at[2] + first));
                at += 3;
                break;
            }
            case 1: {  // scalar load: result, index
                store8(w + at[0], broadcast8(scalars[at[1]]));
                at += 2;
                break;
            }
            case 2: {  // result = start + Σ a b
                Vector8 sum = at[1] == none ? Vector8{} : load8(w + at[1]);
                const std::uint32_t* term = at + 2;
                for (std::uint32_t i = 0; i < count; ++i, term += 2)
                    sum += load8(w + term[0]) * load8(w + term[1]);
                store8(w + at[0], sum);
                at = term;
                break;
            }
            case 3: {  // result = start − Σ a b
                Vector8 sum = at[1] == none ? Vector8{} : load8(w + at[1]);
                const std::uint32_t* term = at + 2;
                for (std::uint32_t i = 0; i < count; ++i, term += 2)
                    sum -= load8(w + term[0]) * load8(w + term[1]);
                store8(w + at[0], sum);
                at = term;
                break;
            }
            case 4: {  // result = 1 / a
                store8(w + at[0], 1.0 / load8(w + at[1]));
                at += 2;
                break;
            }
            default: {  // store: value, buffer, offset
                store8(targets[at[1]] + at[2] + first, load8(w + at[0]));
                at += 3;
            }
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
    const auto offset =
        static_cast<std::uint32_t>(static_cast<std::ptrdiff_t>(row * stride_) + shift);
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
    Step step{subtract ? dot_subtract : dot_add, 0, start.id, 0, 0, {}};
    for (const auto& [a, b] : terms)
        if (!a.is_zero() && !b.is_zero()) step.terms.emplace_back(a.id, b.id);
    if (step.terms.empty()) return start;
    if (!subtract && start.is_zero() && step.terms.size() == 1) {
        const auto [a, b] = step.terms.front();
        if (a == one_) return {b};
        if (b == one_) return {a};
    }
    return record(std::move(step));
}

Value Builder::reciprocal(Value a) {
    if (is_one(a)) return a;
    return record({invert, 0, a.id, 0, 0, {}});
}

void Builder::output(std::uint32_t target, std::size_t offset, Value value) {
    if (value.is_zero()) return;
    steps_.push_back({store, -1, value.id, target, static_cast<std::uint32_t>(offset), {}});
}

MicroProgram Builder::finish() {
    std::vector<std::size_t> last(static_cast<std::size_t>(values_), 0);
    const auto touch = [&](std::int32_t id, std::size_t i) {
        if (id >= 0) last[static_cast<std::size_t>(id)] = i;
    };
    for (std::size_t i = 0; i < steps_.size(); ++i) {
        touch(steps_[i].start, i);
        for (const auto& [a, b] : steps_[i].terms) touch(a, i), touch(b, i);
    }
    MicroProgram program;
    std::vector<std::uint32_t> slot(static_cast<std::size_t>(values_), none), free_slots;
    const auto take = [&] {
        if (free_slots.empty()) return static_cast<std::uint32_t>(lane_count * program.slots_++);
        const std::uint32_t reused = free_slots.back();
        free_slots.pop_back();
        return reused;
    };
    const auto of = [&](std::int32_t id) { return id < 0 ? none : slot[static_cast<std::size_t>(id)]; };
    for (const auto& [id, value] : constants_) {
        last[static_cast<std::size_t>(id)] = steps_.size();
        slot[static_cast<std::size_t>(id)] = take();
        program.constants_.emplace_back(of(id), value);
    }
    std::vector<std::uint32_t>& code = program.code_;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
        const Step& step = steps_[i];
        const auto result = static_cast<std::size_t>(std::max(step.result, 0));
        const bool dead = step.kind != store && last[result] == 0;
        if (dead) continue;
        if (step.kind != store) slot[result] = take();
        code.push_back(step.kind | static_cast<std::uint32_t>(step.terms.size()) << 3);
        if (step.kind == load) code.insert(code.end(), {of(step.result), step.buffer, step.offset});
        if (step.kind == scalar_load) code.insert(code.end(), {of(step.result), step.buffer});
        if (step.kind == invert) code.insert(code.end(), {of(step.result), of(step.start)});
        if (step.kind == store) code.insert(code.end(), {of(step.start), step.buffer, step.offset});
        if (step.kind == dot_add || step.kind == dot_subtract) {
            code.insert(code.end(), {of(step.result), of(step.start)});
            for (const auto& [a, b] : step.terms) code.insert(code.end(), {of(a), of(b)});
            program.multiplications_ += step.terms.size();
        }
        const auto release = [&](std::int32_t id) {
            if (id < 0 || last[static_cast<std::size_t>(id)] != i) return;
            std::uint32_t& s = slot[static_cast<std::size_t>(id)];
            if (s != none) free_slots.push_back(s);
            s = none;
        };
        release(step.start);
        for (const auto& [a, b] : step.terms) release(a), release(b);
    }
    return program;
}

}  // namespace skyknot::inline SKYKNOT_ISA
