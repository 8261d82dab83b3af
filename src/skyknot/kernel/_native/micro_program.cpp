#include "micro_program.hpp"

#include <algorithm>

#include "micro_code.hpp"

namespace skyknot::inline SKYKNOT_ISA {

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
    alone_ = true;
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
    if (step.terms.empty()) return block(target, offset, start);
    alone_ = true;
    write(std::move(step));
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
    program.alone_ = alone_;
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
