// The filter of Wächter & Biegler (2006): pairs (θ, φ) that later iterates must not be worse than.
#pragma once

#include <cstddef>
#include <vector>

namespace skyknot::inline SKYKNOT_ISA {

class Filter {
public:
    Filter() { entries_.reserve(512); }

    void reset(double largest_theta) {
        entries_.clear();
        largest_theta_ = largest_theta;
    }
    bool accepts(double theta, double phi) const {
        if (!(theta < largest_theta_)) return false;
        for (const Entry& e : entries_)
            if (theta >= e.theta && phi >= e.phi) return false;
        return true;
    }
    // Adds the pair with its margins and drops what it dominates.
    void add(double theta, double phi) {
        const Entry fresh{(1.0 - 1e-5) * theta, phi - 1e-8 * theta};
        std::size_t kept = 0;
        for (const Entry& e : entries_)
            if (!(e.theta >= fresh.theta && e.phi >= fresh.phi)) entries_[kept++] = e;
        entries_.resize(kept);
        if (entries_.size() == entries_.capacity()) entries_.erase(entries_.begin());
        entries_.push_back(fresh);
    }

private:
    struct Entry {
        double theta, phi;
    };
    std::vector<Entry> entries_;
    double largest_theta_ = 0.0;
};

}  // namespace skyknot::inline SKYKNOT_ISA
