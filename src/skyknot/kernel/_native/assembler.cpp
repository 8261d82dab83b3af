#include "assembler.hpp"

#include <algorithm>
#include <bit>
#include <map>
#include <stdexcept>
#include <utility>

namespace skyknot::inline SKYKNOT_ISA {
namespace {

constexpr std::uint32_t nothing = UINT32_MAX;

// One value of the expression graph, known by its position in the list; operands come before it.
struct Value {
    Operation operation;
    std::uint32_t operand[3] = {nothing, nothing, nothing};
    double constant = 0.0;
    std::uint32_t uses = 0;
    std::uint32_t sine = nothing, cosine = nothing;  // of sin_cos: the values that it computes
    bool paired = false;                             // computed by an earlier sin_cos
};

struct Graph {
    std::vector<Value> values;  // the inputs first
    std::vector<std::uint32_t> outputs;
};

// Names what stands in work registers while the list is read.
class Trace {
public:
    Trace(std::uint32_t inputs, std::uint32_t outputs) : graph_{{}, {}} {
        graph_.values.assign(inputs, Value{Operation::input});
        graph_.outputs.assign(outputs, nothing);
        inputs_ = inputs;
    }

    void read(const Recorded& line) {
        switch (line.operation) {
            case Operation::input: write(line.result, checked(line.a, inputs_)); break;
            case Operation::constant: write(line.result, constant(line.constant)); break;
            case Operation::assign: write(line.result, at(line.a)); break;
            case Operation::output:
                graph_.outputs[checked(line.result, count(graph_.outputs))] = at(line.a);
                break;
            default: write(line.result, computed(line)); break;
        }
    }

    Graph finish() {
        for (std::uint32_t output : graph_.outputs)
            if (output == nothing) throw std::invalid_argument("an output is never written");
        return std::move(graph_);
    }

private:
    template <class T>
    static std::uint32_t count(const std::vector<T>& list) {
        return static_cast<std::uint32_t>(list.size());
    }
    static std::uint32_t checked(std::uint32_t number, std::uint32_t limit) {
        if (number >= limit) throw std::invalid_argument("a number is out of range");
        return number;
    }
    std::uint32_t at(std::uint32_t work) const {
        const auto found = work_.find(work);
        if (found == work_.end()) throw std::invalid_argument("a register is read before written");
        return found->second;
    }
    void write(std::uint32_t work, std::uint32_t value) { work_[work] = value; }

    std::uint32_t add(const Value& value) {
        graph_.values.push_back(value);
        return count(graph_.values) - 1;
    }
    std::uint32_t constant(double value) {
        const auto [place, is_new] = constants_.try_emplace(std::bit_cast<std::uint64_t>(value), 0);
        if (is_new) place->second = add({.operation = Operation::constant, .constant = value});
        return place->second;
    }
    std::uint32_t computed(const Recorded& line) {
        Value value{line.operation};
        const int operands = operand_count(line.operation);
        if (operands > 0) value.operand[0] = at(line.a);
        if (operands > 1) value.operand[1] = at(line.b);
        return add(value);
    }

    Graph graph_;
    std::uint32_t inputs_;
    std::map<std::uint32_t, std::uint32_t> work_;
    std::map<std::uint64_t, std::uint32_t> constants_;
};

void count_uses(Graph& graph) {
    for (std::uint32_t output : graph.outputs) ++graph.values[output].uses;
    for (auto value = graph.values.rbegin(); value != graph.values.rend(); ++value)
        if (value->uses > 0)
            for (std::uint32_t operand : value->operand)
                if (operand != nothing) ++graph.values[operand].uses;
}

bool is_lone_product(const Value& value) {
    return value.uses == 1 &&
           (value.operation == Operation::mul || value.operation == Operation::sq);
}

// Makes `sum` swallow the product that is its operand number `side`.
void swallow(Graph& graph, Value& sum, int side, Operation joined) {
    Value& product = graph.values[sum.operand[side]];
    const std::uint32_t other = sum.operand[1 - side];
    const std::uint32_t second = product.operation == Operation::sq ? 0 : 1;
    sum = {.operation = joined,
           .operand = {product.operand[0], product.operand[second], other},
           .uses = sum.uses};
    product.uses = 0;
}

void join_products_with_sums(Graph& graph) {
    for (Value& value : graph.values) {
        const bool sum = value.operation == Operation::add;
        if (value.uses == 0 || !(sum || value.operation == Operation::sub)) continue;
        if (is_lone_product(graph.values[value.operand[0]]))
            swallow(graph, value, 0, sum ? Operation::mul_add : Operation::mul_sub);
        else if (is_lone_product(graph.values[value.operand[1]]))
            swallow(graph, value, 1, sum ? Operation::mul_add : Operation::sub_mul);
    }
}

// The earlier of sin a and cos a computes both.
void pair_sines_with_cosines(Graph& graph) {
    std::map<std::uint32_t, std::uint32_t> sine_of;
    const auto wanted = [&](std::uint32_t i, Operation operation) {
        return graph.values[i].uses > 0 && graph.values[i].operation == operation;
    };
    for (std::uint32_t i = 0; i < graph.values.size(); ++i)
        if (wanted(i, Operation::sin)) sine_of[graph.values[i].operand[0]] = i;
    for (std::uint32_t i = 0; i < graph.values.size(); ++i) {
        if (!wanted(i, Operation::cos)) continue;
        const auto found = sine_of.find(graph.values[i].operand[0]);
        if (found == sine_of.end()) continue;
        const std::uint32_t sine = found->second;
        Value& earlier = graph.values[std::min(sine, i)];
        graph.values[std::max(sine, i)].paired = true;
        earlier.operation = Operation::sin_cos;
        earlier.sine = sine;
        earlier.cosine = i;
        sine_of.erase(found);
    }
}

bool needs_instruction(const Value& value) {
    return value.uses > 0 && !value.paired && value.operation != Operation::input &&
           value.operation != Operation::constant;
}

// Orders the values that need an instruction in long runs of one operation.
class Scheduler {
public:
    explicit Scheduler(const Graph& graph)
        : graph_(graph), users_(graph.values.size()), missing_(graph.values.size(), 0) {
        for (std::uint32_t i = 0; i < graph.values.size(); ++i) {
            if (!needs_instruction(graph.values[i])) continue;
            for (std::uint32_t operand : graph.values[i].operand)
                if (operand != nothing && is_computed(operand)) {
                    users_[operand].push_back(i);
                    ++missing_[i];
                }
            if (missing_[i] == 0) ready(i);
        }
    }

    std::vector<std::uint32_t> order() {
        std::vector<std::uint32_t> order;
        for (auto* list = longest(); !list->empty(); list = longest())
            while (!list->empty()) {
                const std::uint32_t next = list->back();
                list->pop_back();
                order.push_back(next);
                finish(next);
            }
        return order;
    }

private:
    bool is_computed(std::uint32_t i) const {
        return graph_.values[i].paired || needs_instruction(graph_.values[i]);
    }
    std::vector<std::uint32_t>* longest() {
        return &*std::max_element(
            std::begin(ready_), std::end(ready_),
            [](const auto& a, const auto& b) { return a.size() < b.size(); });
    }
    void ready(std::uint32_t i) {
        ready_[static_cast<std::uint32_t>(graph_.values[i].operation)].push_back(i);
    }
    void finish(std::uint32_t i) {
        const Value& value = graph_.values[i];
        if (value.operation != Operation::sin_cos) return release_users(i);
        release_users(value.sine);
        release_users(value.cosine);
    }
    void release_users(std::uint32_t i) {
        for (std::uint32_t user : users_[i])
            if (--missing_[user] == 0) ready(user);
    }

    const Graph& graph_;
    std::vector<std::vector<std::uint32_t>> users_;
    std::vector<std::uint32_t> missing_;
    std::vector<std::uint32_t> ready_[operation_count];
};

// Gives every value its slot, in the order of the instructions, and takes slots back after the
// last use.
class Emitter {
public:
    Emitter(const Graph& graph, std::vector<std::uint32_t> order)
        : graph_(graph),
          order_(std::move(order)),
          slot_(graph.values.size(), nothing),
          last_use_(graph.values.size(), 0) {
        for (std::uint32_t place = 0; place < order_.size(); ++place)
            for (std::uint32_t operand : graph.values[order_[place]].operand)
                if (operand != nothing) last_use_[operand] = place;
        for (std::uint32_t output : graph.outputs) last_use_[output] = nothing;
    }

    Program emit(std::uint32_t inputs) {
        program_.inputs = inputs;
        for (std::uint32_t i = 0; i < inputs; ++i) keep(i);
        for (std::uint32_t i = inputs; i < graph_.values.size(); ++i)
            if (graph_.values[i].operation == Operation::constant && graph_.values[i].uses > 0) {
                program_.constants.push_back(graph_.values[i].constant);
                keep(i);
            }
        for (std::uint32_t place = 0; place < order_.size(); ++place) emit_value(place);
        for (std::uint32_t output : graph_.outputs) program_.output_slots.push_back(slot_[output]);
        return std::move(program_);
    }

private:
    // Inputs and constants outlive the run, so that it can be repeated.
    void keep(std::uint32_t i) {
        slot_[i] = program_.slots++;
        last_use_[i] = nothing;
    }
    std::uint32_t slot_for(std::uint32_t i) {
        if (free_.empty()) return slot_[i] = program_.slots++;
        slot_[i] = free_.back();
        free_.pop_back();
        return slot_[i];
    }

    void emit_value(std::uint32_t place) {
        const Value& value = graph_.values[order_[place]];
        std::uint32_t operand[3] = {0, 0, 0};
        for (int k = 0; k < 3; ++k)
            if (value.operand[k] != nothing) operand[k] = slot_[value.operand[k]];
        // An instruction reads all lanes of its operands before it writes, so they are free now.
        for (std::uint32_t used : value.operand)
            if (used != nothing && last_use_[used] == place) {
                free_.push_back(slot_[used]);
                last_use_[used] = nothing;
            }
        const bool pair = value.operation == Operation::sin_cos;
        const std::uint32_t result = slot_for(pair ? value.sine : order_[place]);
        if (pair) operand[2] = slot_for(value.cosine);
        program_.instructions.push_back({result, operand[0], operand[1], operand[2]});
        if (program_.runs.empty() || program_.runs.back().operation != value.operation)
            program_.runs.push_back({value.operation, 0});
        ++program_.runs.back().length;
    }

    const Graph& graph_;
    std::vector<std::uint32_t> order_, slot_, last_use_, free_;
    Program program_;
};

}  // namespace

Program assemble(const std::vector<Recorded>& recorded, std::uint32_t inputs,
                 std::uint32_t outputs) {
    Trace trace(inputs, outputs);
    for (const Recorded& line : recorded) trace.read(line);
    Graph graph = trace.finish();
    count_uses(graph);
    join_products_with_sums(graph);
    pair_sines_with_cosines(graph);
    return Emitter(graph, Scheduler(graph).order()).emit(inputs);
}

}  // namespace skyknot::inline SKYKNOT_ISA
