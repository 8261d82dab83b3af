// What the processor at hand can run: asked by a module that itself needs nothing.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <vector>

namespace {

// Levels of the x86-64 psABI, least first; elsewhere the one baseline build.
std::vector<std::string> supported_levels() {
#if defined(__x86_64__)
    __builtin_cpu_init();
    const bool v2 = __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("ssse3") &&
                    __builtin_cpu_supports("popcnt");
    const bool v3 = v2 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                    __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                    __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                    __builtin_cpu_supports("avx512vl");
    std::vector<std::string> levels;
    if (v2) levels.emplace_back("v2");
    if (v3) levels.emplace_back("v3");
    if (v4) levels.emplace_back("v4");
    return levels;
#else
    return {"base"};
#endif
}

}  // namespace

NB_MODULE(_cpu, module) {
    module.def("supported_levels", &supported_levels,
               "Return the builds of the kernel this processor can run, least first.");
}
