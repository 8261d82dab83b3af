// Python bindings of one build of the kernel.

#include <nanobind/nanobind.h>

#include "lanes.hpp"
#include "frozen_metric_binding.hpp"
#include "interior_point_binding.hpp"
#include "micro_program_binding.hpp"
#include "newton_binding.hpp"
#include "tape_binding.hpp"

NB_MODULE(SKYKNOT_MODULE, module) {
    // At the interpreter's end whatever a script still holds is lost anyway; no word about it.
    nanobind::set_leak_warnings(false);
    module.attr("vector_width") = skyknot::native_width;
    skyknot::bind_tape(module);
    skyknot::bind_interior_point(module);
    skyknot::bind_newton(module);
    skyknot::bind_frozen_metric(module);
    skyknot::bind_micro_program(module);
}
